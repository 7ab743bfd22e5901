"""However an attempt to open a port by Bluetooth LE ends, at any stage, the device is free for
others, and the next attempt works like the first."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from random import Random
from time import sleep
from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("bleak", reason="no bleak: pip install tiniscript[radio]")

from bleak.exc import BleakDeviceNotFoundError, BleakError

from tests.support.interrupted import interrupted_bell
from tiniscript.link import errors
from tiniscript.link.errors import PortError
from tiniscript.link.transports import bluetooth, event_loop

UART = bluetooth.UART_SERVICES[0]


class Device:
    """A device as the radio sees it, with its connections."""

    def __init__(self) -> None:
        self.failing_stage = ""
        self.failure: BaseException | None = None
        self.missing_uuid = ""
        self.clients: list[Client] = []
        self.notify_count = 0

    async def reach(self, stage: str) -> None:
        await asyncio.sleep(0)
        if self.failing_stage == stage:
            if self.failure is None:
                await asyncio.Event().wait()  # it never ends
            else:
                raise self.failure


class Client:
    """A BleakClient. Being connected it keeps others off until it is disconnected."""

    is_connecting = False

    def __init__(self, device: Device, *_: object, **__: object) -> None:
        self.device = device

    async def connect(self) -> None:
        assert not self.device.clients, "somebody else has the device"
        assert not Client.is_connecting, "BlueZ makes one connection at a time"
        Client.is_connecting = True
        try:
            await self.device.reach("before it is connected")
            self.device.clients.append(self)
            await self.device.reach("connected")
        finally:
            Client.is_connecting = False

    async def disconnect(self) -> None:
        await asyncio.sleep(0)
        if self in self.device.clients:
            self.device.clients.remove(self)

    @property
    def is_connected(self) -> bool:
        return self in self.device.clients

    @property
    def services(self) -> list[Any]:
        missing_uuid = self.device.missing_uuid

        def characteristic(uuid: str) -> Any:
            is_writes = uuid == UART.write_uuid
            if missing_uuid == ("writes" if is_writes else "notifies"):
                return None
            properties = (
                ["read"] if missing_uuid == "write" else ["write-without-response", "notify"]
            )
            return SimpleNamespace(uuid=uuid, properties=properties)

        uuid = "of something else" if missing_uuid == "service" else UART.service_uuid
        return [SimpleNamespace(uuid=uuid, get_characteristic=characteristic)]

    async def start_notify(self, *_: object) -> None:
        await self.device.reach("notify")
        self.device.notify_count += 1


FAILURES: dict[str, tuple[BaseException | None, str]] = {
    "an error of bleak": (BleakError("no"), ""),
    "a device that is gone": (BleakDeviceNotFoundError("x", "no"), errors.UNREACHABLE),
    "an error of the system": (OSError("no"), ""),
    "a bug of bleak": (ValueError("no"), ""),
    "no end": (None, errors.SLOW),
}
STAGES = ("before it is connected", "connected", "notify")


@pytest.fixture
def loop(monkeypatch: pytest.MonkeyPatch) -> Iterator[event_loop.EventLoop]:
    monkeypatch.setattr(bluetooth, "BleakClient", Client)
    bluetooth._connect_lock.cache_clear()  # the lock is of one loop
    loop = event_loop.EventLoop()
    yield loop
    loop.close()
    bluetooth._connect_lock.cache_clear()


def connected_port(loop: event_loop.EventLoop, device: Any) -> bluetooth.BluetoothPort:
    port = bluetooth.BluetoothPort(loop, 9600)
    port.connect(device)
    return port


def check_next_client_works(loop: event_loop.EventLoop, device: Device) -> None:
    """The next one gets the device, and leaves it."""
    device.failing_stage = device.missing_uuid = ""
    notified_before = device.notify_count
    for _ in range(2):
        port = connected_port(loop, device)
        assert len(device.clients) == 1
        port.close()
        assert device.clients == []
        port.close()  # no effect
    assert device.notify_count == notified_before + 2


@pytest.mark.parametrize("failure", FAILURES)
@pytest.mark.parametrize("stage", STAGES)
def test_a_failed_open_releases_the_device(
    loop: event_loop.EventLoop, monkeypatch: pytest.MonkeyPatch, stage: str, failure: str
) -> None:
    device = Device()
    for _ in range(2):
        device.failing_stage = stage
        device.failure, reason = FAILURES[failure]
        with monkeypatch.context() as patch, pytest.raises(PortError) as exception_info:
            if device.failure is None:
                patch.setattr(bluetooth, "QUEUE_S", 0.1)
            connected_port(loop, device)
        assert exception_info.value.reason == reason or not reason
        assert device.clients == []
        check_next_client_works(loop, device)


@pytest.mark.parametrize("missing_uuid", ["service", "writes", "notifies", "write"])
def test_a_device_that_is_not_a_robot_is_released(
    loop: event_loop.EventLoop, missing_uuid: str
) -> None:
    device = Device()
    device.missing_uuid = missing_uuid
    with pytest.raises(PortError) as exception_info:
        connected_port(loop, device)
    assert exception_info.value.reason == errors.NO_ROBOT
    assert device.clients == []
    check_next_client_works(loop, device)


@pytest.mark.parametrize("stage", STAGES)
def test_ctrl_c_releases_the_device(
    loop: event_loop.EventLoop, stage: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It may come during any check of a waiting caller."""
    device = Device()
    device.failing_stage = stage

    bell = interrupted_bell(lambda: sleep(event_loop.POLL_INTERVAL_S))
    with monkeypatch.context() as patch:
        patch.setattr(event_loop, "Bell", bell)
        with pytest.raises(KeyboardInterrupt):
            connect_with_interrupt(loop, device, patch)
    assert device.clients == []
    check_next_client_works(loop, device)


def connect_with_interrupt(
    loop: event_loop.EventLoop, device: Device, patch: pytest.MonkeyPatch
) -> None:
    """Press Ctrl-C once during a connection; the clean-up afterwards is not interrupted."""
    run = loop.run
    run_count = 0

    def count_runs(coroutine: Any, timeout_s: float) -> Any:
        nonlocal run_count
        run_count += 1
        if run_count == 2:
            patch.undo()
        return run(coroutine, timeout_s)

    port = bluetooth.BluetoothPort(loop, 9600)
    patch.setattr(loop, "run", count_runs)
    port.connect(device)  # type: ignore[arg-type]


def test_a_device_that_does_not_answer_delays_others_no_longer_than_it_may(
    loop: event_loop.EventLoop, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They wait for each other, and each is connected or given up."""
    monkeypatch.setattr(bluetooth, "CONNECT_S", 0.3)  # more than a busy computer needs
    for stage in STAGES[:2]:
        devices = [Device() for _ in range(3)]
        devices[0].failing_stage = stage
        with ThreadPoolExecutor(len(devices)) as pool:
            opened = [pool.submit(connected_port, loop, device) for device in devices]
        for device, future in zip(devices, opened, strict=True):
            failure = future.exception()
            if device.failing_stage:
                assert isinstance(failure, PortError) and failure.reason == errors.SLOW
                assert device.clients == []
            else:
                assert failure is None
                future.result().close()
            check_next_client_works(loop, device)


class Radio:
    """A client's writes: each is taken, or fails, with the connection or without it."""

    def __init__(self) -> None:
        self.failure: Exception | None = None
        self.is_connected = True
        self.written_bytes = b""

    async def write_gatt_char(self, _: object, data: bytes, response: bool) -> None:
        if self.failure is not None:
            raise self.failure
        self.written_bytes += data


@pytest.mark.parametrize("seed", range(10))
def test_a_failed_write_loses_its_bytes_or_the_connection(
    loop: event_loop.EventLoop, monkeypatch: pytest.MonkeyPatch, seed: int
) -> None:
    """What is lost is sent again by the session; a lost connection is an error from then on."""
    rng, radio, run = Random(seed), Radio(), loop.run
    properties = rng.choice((["write"], ["write-without-response"]))
    characteristic: Any = SimpleNamespace(
        properties=properties, max_write_without_response_size=rng.choice((10, 20, 100))
    )
    port, limits_s = bluetooth.BluetoothPort(loop, 9600), list[float]()
    port._client, port._write_characteristic = radio, characteristic  # type: ignore[assignment]

    def run_and_note(work: Any, timeout_s: float) -> object:
        limits_s.append(timeout_s)
        return run(work, 100)

    monkeypatch.setattr(loop, "run", run_and_note)
    for _ in range(10):
        data = rng.randbytes(rng.choice((1, 20, 65, 1000)))
        radio.failure = rng.choice((None, None, BleakError("no"), OSError("no"), EOFError()))
        radio.is_connected = radio.failure is None or rng.random() < 0.8
        radio.written_bytes = b""
        if radio.is_connected:
            port.write(data)
            assert radio.written_bytes == (data if radio.failure is None else b"")
            assert port.read(1) == b""
        else:
            with pytest.raises(OSError):
                port.write(data)
        # A module's UART sends a byte in ten bits.
        assert limits_s[-1] > len(data) * 10 / 9600
        if not radio.is_connected:
            break
    if not radio.is_connected:
        radio.failure, radio.is_connected = None, True
        for use in (lambda: port.write(b"x"), lambda: port.read(1), lambda: port.write(b"x")):
            with pytest.raises(OSError):
                use()
        assert radio.written_bytes == b""
