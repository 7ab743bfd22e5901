"""The robots that announce themselves, in a network that a test plays: whatever is announced and
withdrawn in whatever order, a list has those that are there, it ends in time, and the network is
left as it was found.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any, NamedTuple

import pytest

pytest.importorskip("zeroconf", reason="no zeroconf: pip install tiniscript[radio]")

from zeroconf import Error, IPVersion

from tiniscript.link import errors
from tiniscript.link.errors import PortError
from tiniscript.link.transports import network, serial
from tiniscript.link.transports.network import (
    ADDRESSES_S,
    LIST_S,
    MAX_NAME_BYTES,
    ROBOT_MS,
    SEARCH_S,
    SERVICE,
    AnnouncedRobot,
)

NAMES = ("a", "b", "Ñ tini", "a.b", "x" * MAX_NAME_BYTES)
OUTSIDE = ("8.8.8.8", "0.0.0.0")
INSIDE = ("10.0.0.7", "192.168.1.2", "169.254.0.9", "127.0.0.1")


class Answer(NamedTuple):
    """What a network answers to the question for a name, after `late_ms`; without `addresses`, no
    more than the name is ever heard."""

    addresses: tuple[str, ...]
    port: int | None
    late_ms: int

    @property
    def robot_port(self) -> str | None:
        """The first address of a local network, as a port."""
        inside = [address for address in self.addresses if address in INSIDE]
        return f"socket://{inside[0]}:{self.port}" if inside and self.port else None


class Network:
    """Stands for zeroconf and its clock."""

    def __init__(self) -> None:
        self.now_ms = 0
        self.events: list[tuple[str, str]] = []  # while the list is made
        self.answers: dict[str, Answer] = {}
        self.refused_names: set[str] = set()
        self.open_count = self.browser_count = 0
        self.listener: Any = None

    def open(self, ip_version: IPVersion) -> Network:
        assert ip_version == IPVersion.V4Only and self.open_count == 0
        self.open_count += 1
        return self

    def __enter__(self) -> Network:
        return self

    def __exit__(self, *_: object) -> None:
        assert self.browser_count == 0, "nobody listens any more"
        self.open_count -= 1

    def browse(self, network: Network, service: str, listener: object) -> SimpleNamespace:
        assert network.open_count == 1 and service == SERVICE
        self.browser_count += 1
        self.listener = listener
        return SimpleNamespace(cancel=self.end_browsing)

    def end_browsing(self) -> None:
        self.browser_count -= 1

    def advance_time(self, seconds: float) -> None:
        self.now_ms += int(seconds * 1000)
        for kind, name in self.events:
            getattr(self.listener, f"{kind}_service")(self, SERVICE, f"{name}.{SERVICE}")

    def get_service_info(self, service: str, name: str, limit_ms: int, **_: object) -> Any:
        assert self.open_count == 1 and service == SERVICE and limit_ms > 0
        if name in self.refused_names:
            raise Error
        answer = self.answers.get(name.removesuffix(f".{SERVICE}"))
        if answer is None or not answer.addresses or answer.late_ms > limit_ms:
            self.now_ms += limit_ms
            return None
        self.now_ms += answer.late_ms
        return SimpleNamespace(port=answer.port, parsed_addresses=lambda *_: [*answer.addresses])


@pytest.fixture
def played(monkeypatch: pytest.MonkeyPatch) -> Network:
    played_network = Network()
    monkeypatch.setattr(network, "Zeroconf", played_network.open)
    monkeypatch.setattr(network, "ServiceBrowser", played_network.browse)
    monkeypatch.setattr(network, "sleep", played_network.advance_time)
    monkeypatch.setattr(network, "monotonic", lambda: played_network.now_ms / 1000)
    return played_network


def random_answer(rng: random.Random) -> Answer:
    addresses = tuple(rng.choice(OUTSIDE + INSIDE) for _ in range(rng.choice((0, 1, 1, 1, 2))))
    # No sum of them is a limit, whose fractions of a millisecond count.
    late_ms = rng.choice((0, 1, ROBOT_MS * 45 // 100, ROBOT_MS * 9 // 10, ROBOT_MS * 11 // 10))
    return Answer(addresses, rng.choice((7007, 1, None, 0)), late_ms)


def check_network_is_left(played: Network) -> None:
    assert (played.open_count, played.browser_count) == (0, 0)


@pytest.mark.parametrize("seed", range(30))
def test_a_list_has_the_robots_that_are_there(played: Network, seed: int) -> None:
    rng = random.Random(seed)
    for _ in range(5):  # each list is like the first
        played.answers = {name: random_answer(rng) for name in NAMES}
        played.events = [
            (rng.choice(("add", "add", "update", "remove")), rng.choice(NAMES)) for _ in range(12)
        ]
        announced_names = set[str]()
        for kind, name in played.events:
            if kind != "update":
                (announced_names.add if kind == "add" else announced_names.discard)(name)
        played.refused_names = {f"{rng.choice(NAMES)}.{SERVICE}"}
        left_ms, expected = int(ADDRESSES_S * 1000), list[AnnouncedRobot]()
        for name in sorted(announced_names):
            answer, limit_ms = played.answers[name], max(1, min(left_ms, ROBOT_MS))
            if f"{name}.{SERVICE}" in played.refused_names:
                continue
            is_heard = answer.addresses and answer.late_ms <= limit_ms
            left_ms -= answer.late_ms if is_heard else limit_ms
            if is_heard and answer.robot_port:
                expected.append(AnnouncedRobot(name, answer.robot_port))
        began_ms = played.now_ms
        assert network.list_robots() == expected
        assert played.now_ms - began_ms <= (LIST_S + ADDRESSES_S) * 1000 + len(NAMES)
        check_network_is_left(played)


def test_a_flood_of_names_is_limited(played: Network, monkeypatch: pytest.MonkeyPatch) -> None:
    """A name that left has made room."""
    monkeypatch.setattr(network, "MAX_ROBOTS", 3)
    names = [f"n{number}" for number in range(6)]
    played.answers = dict.fromkeys(names, Answer(INSIDE[:1], 1, 0))
    played.events = [*(("add", name) for name in names), ("remove", "n1"), ("add", "n5")]
    assert [robot.name for robot in network.list_robots()] == ["n0", "n2", "n5"]


@pytest.mark.parametrize("seed", range(30))
def test_a_name_leads_to_its_address_or_says_why_not(
    played: Network, monkeypatch: pytest.MonkeyPatch, seed: int
) -> None:
    rng = random.Random(seed)
    opened: list[str] = []
    monkeypatch.setattr(serial, "open_port", lambda port, *_: opened.append(port))
    for _ in range(10):
        name, answer = rng.choice(("a", "ñ tini", "x" * MAX_NAME_BYTES)), random_answer(rng)
        played.answers = {name: answer}
        ask: Callable[[str], object] = rng.choice(
            (network.resolve, lambda port: network.open_port(port, 9600, 1))
        )
        port = f"tcp://{rng.choice((name, name.upper()))}{rng.choice(('', '.local'))}"
        began_ms, opened[:] = played.now_ms, []
        if answer.robot_port:
            resolved = ask(port)
            assert [resolved, *opened] in ([answer.robot_port], [None, answer.robot_port])
        else:
            with pytest.raises(PortError) as exception_info:
                ask(port)
            reason = errors.STRANGE if answer.addresses else errors.NOT_ANNOUNCED
            assert exception_info.value.reason == reason and not opened
        assert played.now_ms - began_ms <= SEARCH_S * 1000
        check_network_is_left(played)
    for name in ("", ".local", "x" * (MAX_NAME_BYTES + 1), "ñ" * MAX_NAME_BYTES):
        began_ms = played.now_ms
        with pytest.raises(PortError):
            network.resolve(f"tcp://{name}")
        assert played.now_ms == began_ms, "nobody is asked for what is no name"
