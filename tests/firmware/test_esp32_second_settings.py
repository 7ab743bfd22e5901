"""An ESP32 behaves on a network or a broker like a fresh one, whatever happened before: a
rejection, incomplete or damaged settings, or a connection cut anywhere.

`python -m tests.firmware.test_esp32_second_settings 200` tries more settings and places.
"""

from __future__ import annotations

import random
import socket
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import lru_cache, partial
from struct import pack
from typing import Any

import pytest

from tests.machines.esp32 import EXTERNAL, PANIC, POWER_ON, Esp32Robot, Kept
from tests.support.campaign import each_seed, make_options
from tests.support.compared_answers import first_difference
from tests.support.esp32_radio import Network, port_of, radios, set_network_in_reach, talk
from tests.support.esp32_wifi import (
    HOTSPOT,
    SCHOOL,
    WIFI_KEY,
    join_network,
    make_owned_robot,
    remote,
    school_in_reach,
    state,
    wifi_reply_of,
)
from tests.support.owners import Keys
from tests.support.robot_on_esp32 import Ends, upload_text, wait_for_outcome
from tiniscript.link import wifi
from tiniscript.link.authority import RobotKey
from tiniscript.link.connection import PendingRequest
from tiniscript.link.messages import AUTHORITY_MS
from tiniscript.link.session import Session

BROKER_KEY = b"broker"
# The same network: its password was mistyped, as is usual.
SECOND_NETWORK = SCHOOL._replace(password=b"another long password")
WRONG_PASSWORD_NETWORK = SCHOOL._replace(password=b"that of somebody else")
BROKER = wifi.BrokerSettings(bytes((127, 0, 0, 1)), 1883, "aula", b"pia", b"p" * 40, b"b.local")
OTHER_BROKER = wifi.BrokerSettings(bytes((10, 0, 0, 9)), 8883, "patio",
                                   b"robots-of-ana", b"q" * 63, b"a-longer.name",
                                   wifi.Tls(bytes(range(200)), 20261121))  # fmt: skip
LEASE_MS, SEARCH_MS = 40_000, 4000
JOIN_RETRY_MS = 15_000  # kJoinAgainMs
RETRY_MS = 4000  # between two tries at a broker, at most


# -- networks -----------------------------------------------------------------------------------


def refuse_robot(robot: Esp32Robot, network: wifi.Network, reason: int = 15) -> None:
    robot.radio("x", bytes([reason]))
    accept_robot(robot, WRONG_PASSWORD_NETWORK if network == SECOND_NETWORK else SECOND_NETWORK)


def remove_network(robot: Esp32Robot, network: wifi.Network) -> None:
    set_network_in_reach(robot, "", "")


def accept_robot(robot: Esp32Robot, network: wifi.Network, lease_ms: int = 0) -> None:
    robot.radio("l", pack("<I", lease_ms))
    robot.radio("f", pack("<I", 0))
    set_network_in_reach(robot, network.name.decode(), network.password.decode())


def search_long(robot: Esp32Robot, network: wifi.Network) -> None:
    """Search until the long interval between attempts is reached."""
    accept_robot(robot, network)
    robot.radio("f", pack("<I", SEARCH_MS))


def accept_robot_late(robot: Esp32Robot, network: wifi.Network) -> None:
    """Its address comes much later."""
    accept_robot(robot, network, LEASE_MS)


CONNECTION_ENDS: dict[str, Callable[[Esp32Robot, wifi.Network], None]] = {
    "out of reach": remove_network,
    "joined": accept_robot,
    "joined late": accept_robot_late,
    "searched for long": search_long,
    "refused": refuse_robot,
}


# -- whatever was set before ---------------------------------------------------------------------

NETWORKS = (SCHOOL, SECOND_NETWORK, HOTSPOT)
RESETS = (POWER_ON, EXTERNAL, PANIC)
LOOK_MS, FIRST_LOOK_MS = 730, 300  # no look is near the time of a try or of a lease


@lru_cache(maxsize=1)
def memory_with_owner() -> tuple[Kept, RobotKey]:
    """Return the memory of a robot that has an owner and no network, and the owner's key."""
    keys = Keys()
    robot, _ = make_owned_robot(keys)
    return robot.read_kept(), keys.stored_keys[0]


class Life:
    """A robot with an owner on its cable, in a place with or without a network."""

    def __init__(self) -> None:
        self.nonce = 10
        self.place = "out of reach", SCHOOL
        self.guests: list[Network] = []
        self.boot(memory_with_owner()[0], POWER_ON)

    def boot(self, kept_memory: Kept, reset: int) -> None:
        self.robot = Esp32Robot(kept_memory=kept_memory, reset=reset)
        self.move_to(*self.place)
        self.robot.wait(400)
        self.nonce += 1
        keys = Keys()
        keys.stored_keys = [memory_with_owner()[1]]
        self.owner = remote(self.robot, keys, self.nonce)

    def restart(self, reset: int) -> None:
        kept_memory = self.robot.read_kept()
        self.robot.close()
        self.boot(kept_memory, reset)

    def move_to(self, end: str, network: wifi.Network) -> None:
        self.place = end, network
        accept_robot(self.robot, network)
        CONNECTION_ENDS[end](self.robot, network)

    def use(self, network: wifi.Network | None) -> None:
        owner = self.owner
        request = owner.join(network) if network else owner.forget_wifi()
        assert wait_for_outcome(self.robot, [(None, owner)], request) == "OK"

    def step(self, rng: random.Random) -> None:
        """Something changes: the settings, the place, the memory, the power; or a client comes."""
        kind, network = rng.randrange(10), rng.choice(NETWORKS)
        if kind < 4:
            self.move_to(rng.choice([*CONNECTION_ENDS]), network)
            self.use(network)
        elif kind == 4:
            self.use(rng.choice((network, None)))
        elif kind == 5:
            self.move_to(rng.choice([*CONNECTION_ENDS]), network)
        elif kind == 6:
            self.robot.radio("H", bytes([rng.randrange(2)]))
        elif kind == 7:
            self.robot.radio("X")
        elif kind == 8:
            self.restart(rng.choice(RESETS))
        elif port_of(self.robot):
            self.guests.append(Network(self.robot))
            self.guests[-1].send(rng.choice((b"", b"X", b"PING|check_connection\n")))
        self.robot.wait(rng.choice((2, 50, 1000, JOIN_RETRY_MS, 25_000)))

    def observe(self, count: int) -> list[object]:
        """Return all that can be seen of the radio, again and again, from new settings on."""
        began_ms = self.robot.now_ms
        talk(self.robot, [], 2)
        joins = radios(self.robot).joins
        observations: list[object] = []
        for number in range(count):
            self.robot.wait(began_ms + FIRST_LOOK_MS + number * LOOK_MS - self.robot.now_ms)
            radio_state = radios(self.robot)
            wifi_reply = wifi_reply_of(self.robot, [(None, self.owner)], self.owner)
            reported = (
                wifi.MODES[wifi_reply.mode],
                wifi.STATES[wifi_reply.state],
                wifi_reply.network,
                wifi.address(wifi_reply),
            )
            radio_state = radio_state._replace(joins=radio_state.joins - joins)
            observations.append((reported, radio_state, bool(port_of(self.robot))))
        return observations

    def restart_until_it_rests(self) -> int:
        for count in range(4):
            if state(self.robot, self.owner)[1] == "RESTS":
                return count
            self.restart(PANIC)
        return 4


def check_radio(seed: int) -> str:
    rng = random.Random(seed)
    # each one after each
    previous_end, end = [*CONNECTION_ENDS][seed // 5 % 5], [*CONNECTION_ENDS][seed % 5]
    used_life = Life()
    for _ in range(rng.choice((1, 2, 5))):
        used_life.step(rng)
    used_life.robot.radio("H", b"\0")
    used_life.move_to(previous_end, SCHOOL)
    used_life.use(rng.choice((SCHOOL, SCHOOL, HOTSPOT)))
    used_life.robot.wait(rng.choice((50, 1000, JOIN_RETRY_MS)))
    last_network = rng.choice((SECOND_NETWORK, SECOND_NETWORK, SECOND_NETWORK, HOTSPOT, None))
    count = rng.choice((3, 3, 25, 60))  # up to 2 s, 18 s and 44 s
    observations_of_both = []
    for life in (used_life, Life()):
        life.move_to(end, last_network or SCHOOL)
        life.use(last_network)
        observations_of_both.append([*life.observe(count), life.restart_until_it_rests()])
    assert observations_of_both[0] == observations_of_both[1], first_difference(
        *observations_of_both
    )
    return end if last_network and not last_network.is_access_point else "else"


@pytest.mark.sampled("part")
@pytest.mark.parametrize("part", range(10))
def test_a_radio_with_any_history_behaves_like_a_fresh_one(part: int) -> None:
    """It joins, is announced, listens, tries again, and is told, at the same times."""
    for seed in range(part * 5, part * 5 + 5):
        check_radio(seed)


@pytest.mark.sampled("reason")
@pytest.mark.parametrize("reason", [15, 202, 203, 204])
def test_a_network_that_accepts_in_the_end_is_not_reported_as_refusing(reason: int) -> None:
    """With a weak signal, the robot may have joined and be waiting for its address."""
    robot, owner = make_owned_robot(Keys())
    refuse_robot(robot, SCHOOL, reason)
    assert wait_for_outcome(robot, [(None, owner)], owner.join(SCHOOL)) == "OK"
    talk(robot, [], 2)
    assert state(robot, owner) == ("STATION", "REFUSED")
    accept_robot_late(robot, SCHOOL)
    robot.wait(JOIN_RETRY_MS + 1000)
    assert state(robot, owner) == ("STATION", "SEARCHING")
    robot.wait(LEASE_MS)
    assert state(robot, owner) == ("STATION", "READY")


# -- data in parts ------------------------------------------------------------------------------


REQUEST_MAKERS: dict[str, Callable[[Session], PendingRequest[Any]]] = {
    "a network": lambda owner: owner.join(SCHOOL),
    "a hotspot": lambda owner: owner.join(HOTSPOT),
    "a broker": lambda owner: owner.use_broker(BROKER),
    "a broker with TLS": lambda owner: owner.use_broker(OTHER_BROKER),
    "no broker": lambda owner: owner.use_broker(None),
    "no network": lambda owner: owner.forget_wifi(),
}


def stored_settings(robot: Esp32Robot) -> tuple[bytes | None, bytes | None]:
    entries = robot.read_kept().entries
    return entries.get(WIFI_KEY), entries.get(BROKER_KEY)


def saving_time_ms(robot: Esp32Robot, owner: Session, request_name: str) -> int:
    """Save a setting; return the time that takes."""
    began_ms = robot.now_ms
    assert wait_for_outcome(robot, [(None, owner)], REQUEST_MAKERS[request_name](owner)) == "OK"
    return robot.now_ms - began_ms


@pytest.mark.sampled("seed")
@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("last_setting", REQUEST_MAKERS)
def test_partial_settings_do_not_mix_with_complete_ones(last_setting: str, seed: int) -> None:
    """The sender may disconnect at any moment before the last part."""
    rng = random.Random(seed)
    robot, owner = make_owned_robot(Keys())
    usual_ms = saving_time_ms(robot, owner, last_setting)
    fresh = stored_settings(robot)
    keys = Keys()
    robot, _ = make_owned_robot(keys)
    for nonce in range(rng.randint(1, 3)):
        talk(robot, [], AUTHORITY_MS + 100)
        first = remote(robot, keys, 20 + nonce)
        assert wait_for_outcome(robot, [(None, first)], first.wifi()) == "OK"
        request = REQUEST_MAKERS[
            rng.choice([last_setting, "a network", "a broker", "a broker with TLS"])
        ](first)
        talk(robot, [(None, first)], rng.randint(1, usual_ms))
        if request.outcome is not None or stored_settings(robot) != (None, None):
            return  # the data arrived complete
    talk(robot, [], AUTHORITY_MS + 100)
    owner = remote(robot, keys, 50)
    assert wait_for_outcome(robot, [(None, owner)], REQUEST_MAKERS[last_setting](owner)) == "OK"
    assert stored_settings(robot) == fresh


# -- damaged data -------------------------------------------------------------------------------


def damage_entry(entry: bytes) -> Iterator[bytes]:
    """Yield damaged versions of an entry: of another version, cut, and without terminators."""
    yield from (entry[:1], entry[: len(entry) // 2], entry[:-1], entry + b"\0", entry * 2)
    yield b"~" * 8 + entry[8:]  # no mode, and no class
    yield b"x" * len(entry)
    yield entry[:7] + b"y" * (len(entry) - 7)


@pytest.mark.parametrize("key", [WIFI_KEY, BROKER_KEY])
def test_damaged_settings_are_ignored(key: bytes) -> None:
    """No part of them is reported, and new settings are stored as for the first time."""
    keys = Keys()
    robot, owner = join_network(keys)
    clients: Ends = [(None, owner)]
    assert wait_for_outcome(robot, clients, owner.use_broker(BROKER)) == "OK"
    kept_memory, stored = robot.read_kept(), stored_settings(robot)
    for entry in damage_entry(kept_memory.entries[key]):
        restarted_robot = Esp32Robot(kept_memory=Kept(b"", {**kept_memory.entries, key: entry}, 0))
        school_in_reach(restarted_robot)
        restarted_robot.wait(400)
        owner = remote(restarted_robot, keys, 30)
        clients = [(None, owner)]
        pending_request = owner.wifi() if key == WIFI_KEY else owner.broker()
        assert (
            wait_for_outcome(restarted_robot, clients, pending_request) == "OK"
            and pending_request.outcome
        )
        values = pending_request.outcome.values
        settings = wifi.MODES[values.mode], wifi.STATES[values.state], values.network
        assert settings == ("OFF", "OFF", b""), entry
        assert (radios(restarted_robot).joins == 0) == (key == WIFI_KEY)
        assert wait_for_outcome(restarted_robot, clients, owner.join(SCHOOL)) == "OK"
        assert wait_for_outcome(restarted_robot, clients, owner.use_broker(BROKER)) == "OK"
        assert stored_settings(restarted_robot) == stored


@pytest.mark.parametrize("action", ["joins", "forgets", "uses a broker", "uses none"])
def test_no_setting_is_written_while_the_robot_drives(action: str) -> None:
    """Writing stops the chip for a while: it waits until the robot has stopped."""
    robot, owner = join_network(Keys())
    clients: Ends = [(None, owner)]
    if action == "uses none":
        assert wait_for_outcome(robot, clients, owner.use_broker(BROKER)) == "OK"
    assert upload_text(robot, clients, owner, "SI|F(2, 80);W(60)") == "OK"
    kept_settings_before = stored_settings(robot)
    ways: dict[str, Callable[[], PendingRequest[Any]]] = {
        "joins": partial(owner.join, HOTSPOT),
        "forgets": owner.forget_wifi,
        "uses a broker": partial(owner.use_broker, BROKER),
        "uses none": partial(owner.use_broker, None),
    }
    request = ways[action]()
    talk(robot, clients, 1500)
    assert request.outcome is None and stored_settings(robot) == kept_settings_before
    assert (
        wait_for_outcome(robot, clients, request) == "OK"
        and stored_settings(robot) != kept_settings_before
    )


# -- a broker's connection ----------------------------------------------------------------------


CONNECT_ANSWER, SUBSCRIBE_ANSWER, PING_ANSWER = b"\x20\2\0\0", b"\x90\4\0\1\0\0", b"\xd0\0"
STOP_PUBLICATION = b"\x30" + bytes(
    (2 + len(b"tiniscript/aula/stop") + 5, 0, len(b"tiniscript/aula/stop"))
)
STOP_PUBLICATION += b"tiniscript/aula/stop" + b"hello"
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
        answers = {
            CONNECT: CONNECT_ANSWER,
            SUBSCRIBE: SUBSCRIBE_ANSWER + STOP_PUBLICATION * 3,
            PING: PING_ANSWER,
        }
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


ALL_ANSWER_BYTES = len(CONNECT_ANSWER + SUBSCRIBE_ANSWER + STOP_PUBLICATION * 3 + PING_ANSWER * 2)


@pytest.mark.parametrize("rest", [b"", b"\xff" * 9, b"\x30\xff\xff\xff\xff\xff"])
@pytest.mark.sampled("part", "rest")
@pytest.mark.parametrize("part", range(6))
def test_a_connection_cut_anywhere_is_restored(
    cut_broker: CutBroker, part: int, rest: bytes
) -> None:
    """The cut is in each byte of each packet; the next connection begins like the first."""
    robot, owner = join_network(Keys())
    settings = wifi.BrokerSettings(bytes((127, 0, 0, 1)), cut_broker.port, "aula")
    assert wait_for_outcome(robot, [(None, owner)], owner.use_broker(settings)) == "OK"
    assert comes_back(robot, owner, cut_broker, RETRY_MS)
    for count, cut_after in enumerate(range(1 + part, ALL_ANSWER_BYTES + 1, 6), 1):
        cut_broker.part()
        cut_broker.cut_after, cut_broker.rest = cut_after, rest
        limit_ms = 3 * RETRY_MS + 6000
        assert comes_back(robot, owner, cut_broker, limit_ms), cut_after
        assert cut_broker.cuts == count


if __name__ == "__main__":
    each_seed(check_radio, make_options(200, 10_000))
