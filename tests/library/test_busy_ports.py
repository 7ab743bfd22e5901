"""The wait for a busy port, from the moment its address is known, on a fake clock. A connection
that fails leaves no device open."""

from __future__ import annotations

import os
import random
import socket
import sys
from collections.abc import Callable
from pathlib import Path
from threading import Thread
from time import sleep
from typing import Any, ClassVar

import pytest

from tests.support.waiting import HANG_LIMIT_S
from tiniscript import robots
from tiniscript.base.version import __version__
from tiniscript.library import opening
from tiniscript.library.client import Client
from tiniscript.library.errors import RobotError
from tiniscript.library.opening import BUSY_TIMEOUT_S, RETRY_INTERVAL_S
from tiniscript.link.errors import PortError
from tiniscript.link.sharing import registry
from tiniscript.link.sharing.registry import Registration
from tiniscript.link.transports import READ_S

SEARCH_S = 0.5 * BUSY_TIMEOUT_S, BUSY_TIMEOUT_S + 1, 10 * BUSY_TIMEOUT_S


class Place:
    """A port that takes a while to find, and that another program holds until a given time."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, search_s: float, busy_s: float) -> None:
        self.now_s = 50.0
        self.search_s, self.busy_s = search_s, busy_s
        self.free_s = self.now_s + busy_s
        self.reason = "port_busy"
        self.tries = 0
        monkeypatch.setattr("tiniscript.library.opening.monotonic", lambda: self.now_s)
        monkeypatch.setattr("tiniscript.library.opening.sleep", self.advance_s)
        monkeypatch.setattr(opening, "_resolve_address", self.resolve)
        monkeypatch.setattr(opening, "_join_shared", lambda *_: None)
        monkeypatch.setattr(opening, "_claim", lambda *_: None)
        monkeypatch.setattr(opening, "_open_connection", self.open_port)

    def advance_s(self, seconds: float) -> None:
        self.now_s += seconds

    def resolve(self, port: str, language: str) -> str:
        self.advance_s(self.search_s)
        self.free_s = self.now_s + self.busy_s
        return "ble://aa:bb:cc:dd:ee:01"

    def open_port(self, address: str, *_: object) -> Any:
        self.tries += 1
        if self.now_s < self.free_s:
            raise RobotError(self.reason, "en", {"port": address, "why": ""})
        return self


PORTS = ("ble://Tini 1", "/dev/ttyUSB0")


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("port", PORTS)
def test_a_port_that_is_free_soon_is_opened(
    monkeypatch: pytest.MonkeyPatch, port: str, seed: int
) -> None:
    """Its owner may be leaving: however long the search for it took."""
    rng = random.Random(seed)
    place = Place(
        monkeypatch, rng.choice(SEARCH_S), rng.uniform(0, BUSY_TIMEOUT_S - RETRY_INTERVAL_S)
    )
    connection: object = opening.connection_to(port, "upload", 9600, 1)
    assert connection is place
    assert place.now_s <= place.free_s + RETRY_INTERVAL_S


@pytest.mark.parametrize("search_s", SEARCH_S)
@pytest.mark.parametrize("port", PORTS)
def test_a_port_that_stays_busy_is_reported(
    monkeypatch: pytest.MonkeyPatch, port: str, search_s: float
) -> None:
    place = Place(monkeypatch, search_s, 100 * BUSY_TIMEOUT_S)
    began_s = place.now_s + (search_s if port == PORTS[0] else 0)
    with pytest.raises(RobotError) as busy:
        opening.connection_to(port, "upload", 9600, 1)
    assert busy.value.reason == "port_busy"
    assert BUSY_TIMEOUT_S < place.now_s - began_s < BUSY_TIMEOUT_S + 2 * RETRY_INTERVAL_S
    place.reason, place.tries = "port_gone", 0
    with pytest.raises(RobotError) as error_info:
        opening.connection_to(port, "upload", 9600, 1)
    assert (error_info.value.reason, place.tries) == ("port_gone", 1), "nothing else is waited for"


class Device:
    """The device opened at a port, until it is closed."""

    opened: ClassVar[list[Device]] = []
    is_gone = False
    in_waiting = 0

    def __init__(self, *_: object) -> None:
        self.is_open = True
        Device.opened.append(self)

    def read(self, size: int) -> bytes:
        sleep(READ_S)
        return b""

    def write(self, data: bytes) -> None:
        pass

    def close(self) -> None:
        self.is_open = False
        if self.is_gone:
            raise OSError("gone")


class Line:
    """A connection that owns a device and a lock."""

    holder_verb = ""

    def __init__(self, device: Device, session: object, lock: Any, address: str) -> None:
        self.device, self.lock, self.address = device, lock, address

    def close(self) -> None:
        self.device.close()
        self.lock.close()


# The steps of a connection that may fail, each by its place.
STEPS = (
    "tiniscript.link.ports.open_port",
    "tiniscript.library.opening.directory.belongs_to_another",
    "tiniscript.link.keys.KeyFile",
    "tiniscript.link.session.Session",
    "tiniscript.library.client.Client._share",
)
ADDRESS = "socket://127.0.0.1:9"


def failing_call(why: BaseException | bool) -> Callable[..., object]:
    def fail_or_return(*_: object, **__: object) -> object:
        if isinstance(why, BaseException):
            raise why
        return why

    return fail_or_return


@pytest.mark.parametrize("step", STEPS)
def test_a_connection_that_fails_at_any_step_leaves_nothing_open(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, step: str
) -> None:
    """The next try of the same program gets the port: no device, lock or file is held."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.setattr(Device, "opened", [])
    monkeypatch.setattr("tiniscript.link.ports.open_port", Device)
    monkeypatch.setattr("tiniscript.link.port_connection.PortConnection", Line)
    profile = robots.load("tinibot")

    def open_client() -> Client:
        return Client(ADDRESS, "upload", profile, is_shared=True)

    whys: list[BaseException | bool] = [PortError("missing", "gone"), KeyboardInterrupt()]
    if step.endswith("belongs_to_another"):
        whys.append(True)
    if step.endswith("_shared"):
        whys.append(RuntimeError("a bug"))
    count_before = len(list(Path("/proc/self/fd").iterdir())) if sys.platform == "linux" else 0
    for why in whys:
        with monkeypatch.context() as patched:
            patched.setattr(step, failing_call(why))
            with pytest.raises(BaseException):  # noqa: B017 - whichever it is
                open_client()
        assert not any(device.is_open for device in Device.opened), why
        lock = registry.lock_port(ADDRESS)
        assert lock is not None, f"{why!r} leaves its lock"
        lock.close()
        if sys.platform == "linux":
            assert len(list(Path("/proc/self/fd").iterdir())) == count_before, why
    monkeypatch.setattr(Client, "_share", lambda *_: None)
    line = open_client().connection
    assert Device.opened[-1].is_open
    line.close()


@pytest.mark.parametrize("is_gone", [False, True])
def test_a_connection_that_was_closed_leaves_nothing_open(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, is_gone: bool
) -> None:
    """This holds even if its port is gone; whoever keeps the object may connect again, any number
    of times."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.setattr(Device, "opened", [])
    monkeypatch.setattr("tiniscript.link.ports.open_port", Device)
    monkeypatch.setattr(Device, "is_gone", is_gone)
    clients = []
    for _ in range(3):
        clients.append(Client(ADDRESS, "upload", robots.load("tinibot")))
        assert registry.find_registration(ADDRESS) is not None
        clients[-1].close()
        assert not any(device.is_open for device in Device.opened)
        assert registry.find_registration(ADDRESS) is None


def greeting(version: str, answer: str) -> bytes:
    return (f'{{"tsc": "{version}", "answer": "{answer}"}}\n').encode()


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (greeting("9.9", "right"), "holder_other"),
        (greeting(__version__, "wrong"), ""),
        (b"HTTP/1.1 400\r\n\r\n", ""),
        (b"", ""),
        (greeting(__version__, "right"), "holder_baud"),
    ],
)
def test_attempts_to_reach_an_unshared_port_leave_nothing_open(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, data: bytes, reason: str
) -> None:
    """A client that waits for a busy port tries twenty times a second."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    with socket.create_server(("127.0.0.1", 0)) as server:
        number = server.getsockname()[1]
        registry.write(Registration(
            ADDRESS, number, "0" * 32, "right", "live", 9600, os.getpid(),
        ))  # fmt: skip

        def serve() -> None:
            peer = server.accept()[0]
            with peer:
                peer.recv(1000)
                peer.sendall(data)
                peer.shutdown(socket.SHUT_WR)
                peer.settimeout(HANG_LIMIT_S)
                last_received.append(peer.recv(1000))

        last_received: list[bytes] = []
        thread = Thread(target=serve, daemon=True)
        thread.start()
        try:
            connection: object = opening._join_shared(ADDRESS, "upload", 115_200, "en")
            assert connection is None and not reason
        except RobotError as failure:
            assert failure.reason == reason
        thread.join(HANG_LIMIT_S)
        assert last_received == [b""], "it is connected still"
