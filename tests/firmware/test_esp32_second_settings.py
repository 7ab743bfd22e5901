"""An ESP32 behaves on a network or a broker like a fresh one, whatever happened before: a
rejection, incomplete or damaged settings, or a connection cut anywhere.
"""

from __future__ import annotations

import random
import socket
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import partial
from struct import pack
from typing import Any

import pytest

from tests.machines.esp32 import Esp32Robot, Kept
from tests.support.esp32_radio import in_reach, radios, talk
from tests.support.esp32_wifi import (
    HOTSPOT,
    SCHOOL,
    WIFI_KEY,
    join_network,
    make_owned_robot,
    remote,
    school_in_reach,
    state,
)
from tests.support.owners import Keys
from tests.support.robot_on_esp32 import Ends, upload_text, wait_for_outcome
from tiniscript.link import wifi
from tiniscript.link.connection import PendingRequest
from tiniscript.link.messages import AUTHORITY_MS
from tiniscript.link.session import Session

BROKER_KEY = b"broker"
# The same network: its password was mistyped, as is usual.
SECOND = SCHOOL._replace(password=b"another long password")
OTHERS = SCHOOL._replace(password=b"that of somebody else")
BROKER = wifi.BrokerSettings(bytes((127, 0, 0, 1)), 1883, "aula", b"pia", b"p" * 40, b"b.local")
OTHER = wifi.BrokerSettings(bytes((10, 0, 0, 9)), 8883, "patio", b"robots-of-ana", b"q" * 63,
                            b"a-longer.name", wifi.Tls(bytes(range(200)), 20261121))  # fmt: skip
LEASE_MS, SEARCH_MS = 40_000, 4000
TRY_MS = 15_000  # kJoinAgainMs
AGAIN_MS = 4000  # between two tries at a broker, at most


# -- networks -----------------------------------------------------------------------------------


def sent_away(reason: int, robot: Esp32Robot, network: wifi.Network) -> None:
    robot.radio("x", bytes([reason]))
    let_in(robot, OTHERS if network == SECOND else SECOND)


def out_of_reach(robot: Esp32Robot, network: wifi.Network) -> None:
    in_reach(robot, "", "")


def let_in(robot: Esp32Robot, network: wifi.Network, lease_ms: int = 0) -> None:
    robot.radio("l", pack("<I", lease_ms))
    robot.radio("f", pack("<I", 0))
    in_reach(robot, network.name.decode(), network.password.decode())


def searched_long(robot: Esp32Robot, network: wifi.Network) -> None:
    """Search until the long interval between attempts is reached."""
    let_in(robot, network)
    robot.radio("f", pack("<I", SEARCH_MS))


def let_in_late(robot: Esp32Robot, network: wifi.Network) -> None:
    """Its address comes much later."""
    let_in(robot, network, LEASE_MS)


ENDS: dict[str, Callable[[Esp32Robot, wifi.Network], None]] = {
    "out of reach": out_of_reach,
    "joined": let_in,
    "joined late": let_in_late,
    "searched for long": searched_long,
    **{f"refused for {reason}": partial(sent_away, reason) for reason in (15, 202, 203, 204)},
}


def states(robot: Esp32Robot, owner: Session, network: wifi.Network) -> tuple[set[str], Any]:
    """Join a network; return all reported states, and the final settings."""
    ends: Ends = [(None, owner)]
    assert wait_for_outcome(robot, ends, owner.join(network)) == "OK"
    talk(robot, ends, 2)
    states_seen = {state(robot, owner)[1] for _ in range(20)}
    asked = radios(robot)
    return states_seen, (state(robot, owner), asked.network, asked.password, asked.is_access_point)


@pytest.mark.sampled("second")
@pytest.mark.parametrize("second", [*ENDS][:5])
@pytest.mark.parametrize("first", ENDS)
def test_a_second_network_is_joined_as_a_first_one(first: str, second: str) -> None:
    robot, owner = make_owned_robot(Keys())
    ENDS[second](robot, SECOND)
    _, fresh = states(robot, owner, SECOND)
    robot, owner = make_owned_robot(Keys())
    ENDS[first](robot, SCHOOL)
    states(robot, owner, SCHOOL)
    ENDS[second](robot, SECOND)
    states_seen, state = states(robot, owner, SECOND)
    assert state == fresh
    assert ("REFUSED" in states_seen) == second.startswith("refused"), states_seen


@pytest.mark.sampled("reason")
@pytest.mark.parametrize("reason", [15, 202, 203, 204])
def test_who_is_let_in_at_last_was_not_refused(reason: int) -> None:
    """With a weak signal, the robot may have joined and be waiting for its address."""
    robot, owner = make_owned_robot(Keys())
    sent_away(reason, robot, SCHOOL)
    states_seen, _ = states(robot, owner, SCHOOL)
    assert "REFUSED" in states_seen
    let_in_late(robot, SCHOOL)
    robot.wait(TRY_MS + 1000)
    assert state(robot, owner) == ("STATION", "SEARCHING")
    robot.wait(LEASE_MS)
    assert state(robot, owner) == ("STATION", "READY")


# -- data in parts ------------------------------------------------------------------------------


ASKED: dict[str, Callable[[Session], PendingRequest[Any]]] = {
    "a network": lambda owner: owner.join(SCHOOL),
    "a hotspot": lambda owner: owner.join(HOTSPOT),
    "a broker": lambda owner: owner.use_broker(BROKER),
    "a broker with TLS": lambda owner: owner.use_broker(OTHER),
    "no broker": lambda owner: owner.use_broker(None),
    "no network": lambda owner: owner.forget_wifi(),
}


def kept_settings(robot: Esp32Robot) -> tuple[bytes | None, bytes | None]:
    entries = robot.read_kept().entries
    return entries.get(WIFI_KEY), entries.get(BROKER_KEY)


def took_ms(robot: Esp32Robot, owner: Session, what: str) -> int:
    """Save a setting; return the time that takes."""
    began_ms = robot.now_ms
    assert wait_for_outcome(robot, [(None, owner)], ASKED[what](owner)) == "OK"
    return robot.now_ms - began_ms


@pytest.mark.sampled("seed")
@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("last", ASKED)
def test_of_what_came_in_part_nothing_is_in_what_comes_whole(last: str, seed: int) -> None:
    """The sender may disconnect at any moment before the last part."""
    rng = random.Random(seed)
    robot, owner = make_owned_robot(Keys())
    usual_ms = took_ms(robot, owner, last)
    fresh = kept_settings(robot)
    keys = Keys()
    robot, _ = make_owned_robot(keys)
    for nonce in range(rng.randint(1, 3)):
        talk(robot, [], AUTHORITY_MS + 100)
        first = remote(robot, keys, 20 + nonce)
        assert wait_for_outcome(robot, [(None, first)], first.wifi()) == "OK"
        request = ASKED[rng.choice([last, "a network", "a broker", "a broker with TLS"])](first)
        talk(robot, [(None, first)], rng.randint(1, usual_ms))
        if request.outcome is not None or kept_settings(robot) != (None, None):
            return  # the data arrived complete
    talk(robot, [], AUTHORITY_MS + 100)
    owner = remote(robot, keys, 50)
    assert wait_for_outcome(robot, [(None, owner)], ASKED[last](owner)) == "OK"
    assert kept_settings(robot) == fresh


# -- damaged data -------------------------------------------------------------------------------


def damage_entry(entry: bytes) -> Iterator[bytes]:
    """Yield damaged versions of an entry: of another version, cut, and without terminators."""
    yield from (entry[:1], entry[: len(entry) // 2], entry[:-1], entry + b"\0", entry * 2)
    yield b"~" * 8 + entry[8:]  # no mode, and no class
    yield b"x" * len(entry)
    yield entry[:7] + b"y" * (len(entry) - 7)


@pytest.mark.parametrize("key", [WIFI_KEY, BROKER_KEY])
def test_damaged_settings_are_none(key: bytes) -> None:
    """No part of them is reported, and new settings are stored as for the first time."""
    keys = Keys()
    robot, owner = join_network(keys)
    ends: Ends = [(None, owner)]
    assert wait_for_outcome(robot, ends, owner.use_broker(BROKER)) == "OK"
    kept_memory, whole = robot.read_kept(), kept_settings(robot)
    for entry in damage_entry(kept_memory.entries[key]):
        restarted_robot = Esp32Robot(kept_memory=Kept(b"", {**kept_memory.entries, key: entry}, 0))
        school_in_reach(restarted_robot)
        restarted_robot.wait(400)
        owner = remote(restarted_robot, keys, 30)
        ends = [(None, owner)]
        pending_request = owner.wifi() if key == WIFI_KEY else owner.broker()
        assert (
            wait_for_outcome(restarted_robot, ends, pending_request) == "OK"
            and pending_request.outcome
        )
        values = pending_request.outcome.values
        settings = wifi.MODES[values.mode], wifi.STATES[values.state], values.network
        assert settings == ("OFF", "OFF", b""), entry
        assert (radios(restarted_robot).joins == 0) == (key == WIFI_KEY)
        assert wait_for_outcome(restarted_robot, ends, owner.join(SCHOOL)) == "OK"
        assert wait_for_outcome(restarted_robot, ends, owner.use_broker(BROKER)) == "OK"
        assert kept_settings(restarted_robot) == whole


@pytest.mark.parametrize("what", ["joins", "forgets", "uses a broker", "uses none"])
def test_no_setting_is_written_while_the_robot_drives(what: str) -> None:
    """Writing stops the chip for a while: it waits until the robot has stopped."""
    robot, owner = join_network(Keys())
    ends: Ends = [(None, owner)]
    if what == "uses none":
        assert wait_for_outcome(robot, ends, owner.use_broker(BROKER)) == "OK"
    assert upload_text(robot, ends, owner, "SI|F(2, 80);W(60)") == "OK"
    kept_settings_before = kept_settings(robot)
    ways: dict[str, Callable[[], PendingRequest[Any]]] = {
        "joins": partial(owner.join, HOTSPOT),
        "forgets": owner.forget_wifi,
        "uses a broker": partial(owner.use_broker, BROKER),
        "uses none": partial(owner.use_broker, None),
    }
    request = ways[what]()
    talk(robot, ends, 1500)
    assert request.outcome is None and kept_settings(robot) == kept_settings_before
    assert (
        wait_for_outcome(robot, ends, request) == "OK"
        and kept_settings(robot) != kept_settings_before
    )


# -- a broker's connection ----------------------------------------------------------------------


ACCEPTED, SUBSCRIBED, PINGED = b"\x20\2\0\0", b"\x90\4\0\1\0\0", b"\xd0\0"
MESSAGE = b"\x30" + bytes((2 + len(b"tiniscript/aula/stop") + 5, 0, len(b"tiniscript/aula/stop")))
MESSAGE += b"tiniscript/aula/stop" + b"hello"
CONNECT, SUBSCRIBE, PING = 1, 8, 12


class CutBroker:
    """A broker that breaks its connections off after so many bytes; then it says `rest` first."""

    def __init__(self) -> None:
        self.listening = socket.create_server(("127.0.0.1", 0))
        self.listening.setblocking(False)
        self.port = self.listening.getsockname()[1]
        self.client: socket.socket | None = None
        self.sent_count = self.cuts = 0
        self.heard = b""
        self.cut_after: int | None = None
        self.rest = b""

    def close(self) -> None:
        self.part()
        self.listening.close()

    def step(self) -> None:
        with suppress(BlockingIOError):
            client, _ = self.listening.accept()
            client.setblocking(False)
            client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self.part()
            self.client, self.heard, self.sent_count = client, b"", 0
        if self.client is None:
            return
        try:
            data = self.client.recv(4096)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        if not data:
            self.part()
            return
        self.heard += data
        while len(self.heard) >= 2 and len(self.heard) >= 2 + self._length():
            kind = self.heard[0] >> 4
            self.heard = self.heard[2 + self._length() :]
            self._answer(kind)

    def _length(self) -> int:
        assert self.heard[1] < 128
        return self.heard[1]

    def _answer(self, kind: int) -> None:
        answers = {CONNECT: ACCEPTED, SUBSCRIBE: SUBSCRIBED + MESSAGE * 3, PING: PINGED}
        data = answers.get(kind, b"")
        if self.client is None or not data:
            return
        if self.cut_after is not None and self.sent_count + len(data) >= self.cut_after:
            with suppress(OSError):
                self.client.send(data[: self.cut_after - self.sent_count] + self.rest)
            self.cuts += 1
            self.cut_after = None
            if not self.rest:
                self.part()
            return
        with suppress(OSError):
            self.client.send(data)
        self.sent_count += len(data)

    def part(self) -> None:
        if self.client is not None:
            self.client.close()
        self.client = None


@pytest.fixture
def cut_broker() -> Iterator[CutBroker]:
    broker = CutBroker()
    yield broker
    broker.close()


def broker_state(robot: Esp32Robot, owner: Session) -> str:
    request = owner.broker()
    assert wait_for_outcome(robot, [(None, owner)], request) == "OK" and request.outcome
    return wifi.STATES[request.outcome.values.state]


def comes_back(robot: Esp32Robot, owner: Session, broker: CutBroker, limit_ms: int) -> bool:
    """Return whether the robot returns to its broker in time, after all cuts."""
    for _ in range(limit_ms // 20):
        robot.wait(20)
        broker.step()
        is_there = broker.cut_after is None and broker.client is not None
        if is_there and broker_state(robot, owner) == "READY":
            return True
    return False


LONGEST = len(ACCEPTED + SUBSCRIBED + MESSAGE * 3 + PINGED * 2)


@pytest.mark.parametrize("rest", [b"", b"\xff" * 9, b"\x30\xff\xff\xff\xff\xff"])
@pytest.mark.sampled("part", "rest")
@pytest.mark.parametrize("part", range(6))
def test_a_connection_that_is_cut_anywhere_is_made_again(
    cut_broker: CutBroker, part: int, rest: bytes
) -> None:
    """The cut is in each byte of each packet; the next connection begins like the first."""
    robot, owner = join_network(Keys())
    settings = wifi.BrokerSettings(bytes((127, 0, 0, 1)), cut_broker.port, "aula")
    assert wait_for_outcome(robot, [(None, owner)], owner.use_broker(settings)) == "OK"
    assert comes_back(robot, owner, cut_broker, AGAIN_MS)
    for count, cut_after in enumerate(range(1 + part, LONGEST + 1, 6), 1):
        cut_broker.part()
        cut_broker.cut_after, cut_broker.rest = cut_after, rest
        limit_ms = 3 * AGAIN_MS + 6000
        assert comes_back(robot, owner, cut_broker, limit_ms), cut_after
        assert cut_broker.cuts == count
