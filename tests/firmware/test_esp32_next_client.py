"""The behaviour of one client never affects the next client of its slot."""

from __future__ import annotations

import random
import re
from collections.abc import Callable

import pytest

from tests.machines.esp32 import Esp32Robot
from tests.support.esp32_radio import (
    MIN_MTU,
    Client,
    End,
    LowEnergy,
    Network,
    RawClient,
    SerialPort,
    limit_accepted_bytes,
    radios,
    session,
    talk,
)
from tests.support.esp32_wifi import far_owner, make_owned_robot, remote, remote_with_wrong_key
from tests.support.images import image_of
from tests.support.owners import Keys
from tests.support.robot_on_esp32 import (
    AWAY_PROGRAM,
    TRANSPORTS,
    Ends,
    Make,
    upload_text,
    wait_for_outcome,
)
from tests.support.robot_on_host import actions_of
from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import AUTHORITY_MS, BY_NAME, STOP_BYTES
from tiniscript.link.session import Session
from tiniscript.link.typed_stop import is_typed_stop, stops_at_once

drawn = pytest.mark.sampled(of="places of clients", keep=1)


def show_wrong_keys(robot: Esp32Robot, end: End, keys: Keys) -> None:
    thief = remote_with_wrong_key(robot, keys, 1)
    for _ in range(10):
        assert wait_for_outcome(robot, [(end, thief)], thief.start()) != "OK"


def begin_upload(robot: Esp32Robot, end: End, keys: Keys) -> None:
    stranger = session(3, robot)
    stranger.upload(image_of("SB|" + ";".join("F(1, 80)" for _ in range(800))))
    talk(robot, [(end, stranger)], 300)


def claim_as_stranger(robot: Esp32Robot, end: End, keys: Keys) -> None:
    stranger = remote(robot, Keys(50), 4)
    stranger.claim(0)
    talk(robot, [(end, stranger)], 300)


def sender_of(data: bytes) -> Callable[[Esp32Robot, End, Keys], None]:
    def send(robot: Esp32Robot, end: End, keys: Keys) -> None:
        talk(robot, [(end, RawClient(data))], 30)

    return send


DISTURBANCES = {
    "wrong keys": show_wrong_keys,
    "an upload": begin_upload,
    "a claim": claim_as_stranger,
    "half a frame": sender_of(b"\0\0\5\7\7"),
    "noise": sender_of(b"\0\0" + random.Random(5).randbytes(3000)),
    "half a line": sender_of(b"SI|F(60, 80"),
    "half a block": sender_of(b"SI|LOOP(2)\n"),
    "stops": sender_of(b"\0\0" + bytes(STOP_BYTES) * 9),
}


def owner_time_ms(robot: Esp32Robot, make: Make, keys: Keys) -> int:
    """Return the owner's time from a new connection until a program runs."""
    owner = remote(robot, keys, 8)
    began_ms = robot.now_ms
    clients: Ends = [(make(robot), owner)]
    assert upload_text(robot, clients, owner, AWAY_PROGRAM) == "OK"
    return robot.now_ms - began_ms


@pytest.mark.sampled("make", "disturbance", keep=3)
@pytest.mark.parametrize("make", TRANSPORTS)
@pytest.mark.parametrize("disturbance", DISTURBANCES)
def test_errors_of_one_client_do_not_affect_the_next(make: Make, disturbance: str) -> None:
    def connected_place() -> tuple[Esp32Robot, Keys]:
        keys = Keys()
        robot, end, _ = far_owner(keys)
        end.leave()
        talk(robot, [], AUTHORITY_MS + 100)
        return robot, keys

    robot, keys = connected_place()
    talk(robot, [(end := make(robot), RawClient())], 300)
    end.leave()
    talk(robot, [], 5)
    usual_ms = owner_time_ms(robot, make, keys)

    robot, keys = connected_place()
    for _ in range(3):
        end = make(robot)
        DISTURBANCES[disturbance](robot, end, keys)
        end.leave()
        talk(robot, [], 5)
    assert owner_time_ms(robot, make, keys) <= usual_ms + 30  # a stop is released first


@pytest.mark.sampled("make")
@pytest.mark.parametrize("make", TRANSPORTS)
def test_a_stop_that_waits_for_earlier_bytes_leaves_with_its_client(make: Make) -> None:
    """It is behind so many bytes that the robot has not taken it when its client leaves."""
    for byte_count in range(200, 801, 100):
        robot, owner_end, _ = far_owner(keys := Keys())
        owner_end.leave()
        talk(robot, [], AUTHORITY_MS + 100)
        end = make(robot)
        talk(robot, [(end, RawClient(b"x" * byte_count + b"\nS\n"))], 1)
        end.leave()
        talk(robot, [], 5)
        owner_time_ms(robot, make, keys)  # it drives


@pytest.mark.sampled("make")
@pytest.mark.parametrize("make", TRANSPORTS[:2])
@pytest.mark.parametrize("typed_bytes", [b"OK+CONN", b"\0si|", b"SI|LOOP(2)", b"FOO(1)\n"])
def test_typed_text_is_never_shown_to_other_clients(make: Make, typed_bytes: bytes) -> None:
    robot, _ = make_owned_robot(Keys())
    talk(robot, [], AUTHORITY_MS)
    talk(robot, [(end := make(robot), RawClient(typed_bytes))], 2)
    end.leave()
    talk(robot, [], 1)
    talk(robot, [(make(robot), listener := RawClient(b"\0"))], 4000)
    assert listener.received == b""


STOPS = (bytes(4), b"S\n", b"stop\r", b"\0S\n", b"\0stop\0", b"\x03\n", b"SSS", b"stop stop",
         b"para\n", b"ST\x1b[AOP\n", b"\0\0\0\0\0")  # fmt: skip


def stops_alone(data: bytes) -> bool:
    lines = re.split(rb"[\r\n\0]", data)
    is_ended = any(is_typed_stop(line) or line == b"\x03" for line in lines[:-1])
    return is_ended or bytes(4) in data or any(map(stops_at_once, lines))


CUT_STOPS = [
    (data[:cut], data[cut:])
    for data in STOPS
    for cut in range(1, len(data))
    if not stops_alone(data[:cut]) and not stops_alone(data[cut:])
]


@pytest.mark.sampled("make")
@pytest.mark.parametrize("make", TRANSPORTS)
@pytest.mark.parametrize("pause_ms", [0, 300])
def test_bytes_of_two_clients_do_not_form_a_stop(make: Make, pause_ms: int) -> None:
    robot, end, owner = far_owner(Keys())
    clients: Ends = [(end, owner)]
    assert upload_text(robot, clients, owner, AWAY_PROGRAM) == "OK"
    for parts in CUT_STOPS:
        for part in parts:
            talk(robot, [*clients, (other_end := make(robot), RawClient(part))], 20)
            other_end.leave()
            talk(robot, clients, 5 + pause_ms)
        assert actions_of(robot)[-1] == "MOTORS 80 80", parts
    talk(robot, [*clients, (make(robot), RawClient(b"\0" + b"".join(CUT_STOPS[-1]) + b"\0"))], 100)
    assert actions_of(robot)[-1] == "MOTORS 0 0", "of one it is a stop"


# -- data sent to them ----------------------------------------------------------------------------

STATUS, PING_SEQ = BY_NAME["STATUS"].number, 77


@pytest.mark.sampled("max_bytes")
@pytest.mark.parametrize("max_bytes", [0, 1, 7, 30, 1000])
@pytest.mark.parametrize("requests", [1, 5, 60])
def test_the_next_client_gets_no_remainder_of_a_partial_message(
    max_bytes: int, requests: int
) -> None:
    """The network accepts a few bytes at a time, and the client before may leave at any moment."""
    robot, end, _ = far_owner(Keys())
    end.leave()
    frames = b"".join(encode_frame(Frame(STATUS, seq, 0)) for seq in range(requests))
    rests = 0
    for moment_ms in (1, 2, 3, 5, 9, 100):
        limit_accepted_bytes(robot, max_bytes)
        first = RawClient(b"\0" + frames)
        talk(robot, [(end := Network(robot), first)], moment_ms)
        end.leave()
        talk(robot, [], 3)
        limit_accepted_bytes(robot, 1000)
        next_client = RawClient(b"\0" + encode_frame(Frame(BY_NAME["PING"].number, PING_SEQ, 0)))
        talk(robot, [(end := Network(robot), next_client)], 60)
        end.leave()
        talk(robot, [], 3)
        answers = [decode_frame(data) for data in next_client.received.split(b"\0") if data]
        assert [answer and answer.seq for answer in answers] == [PING_SEQ], moment_ms
        rests += len(first.received) < len(next_client.received)
    assert rests or max_bytes == 1000


def test_the_next_client_gets_no_packet_beyond_its_own_mtu() -> None:
    """The agreement of the client before does not matter: a client without one gets 20 bytes."""
    robot, _ = make_owned_robot(Keys())
    for mtu in (MIN_MTU, 247, MIN_MTU, 100, 60, 247, MIN_MTU):
        end, client = LowEnergy(robot, mtu), session(mtu, robot)
        assert wait_for_outcome(robot, [(end, client)], client.status()) == "OK"
        assert wait_for_outcome(robot, [(end, client)], client.hello()) == "OK"
        assert 0 < max(end.lengths) <= mtu - 3
        end.leave()
        talk(robot, [], 5)


class Late(LowEnergy):
    """A Bluetooth client that has not subscribed yet."""

    def subscribe(self, has_subscribed: bool = False) -> None:
        if has_subscribed:
            super().subscribe()


def test_the_next_client_gets_only_its_own_answers_after_subscribing() -> None:
    robot, _ = make_owned_robot(Keys())
    talk(robot, [(end := LowEnergy(robot), RawClient(b"\0"))], 20)
    for number in range(3):
        end.leave()
        talk(robot, [], 5)
        end, client = Late(robot), RawClient()
        for seq in (number, PING_SEQ):
            end.send(b"\0" + encode_frame(Frame(BY_NAME["PING"].number, seq, 0)))
            talk(robot, [(end, client)], 30)
        assert client.received == b"", "nobody would hear it"
        if number == 1:  # the one before has left without
            end.subscribe(True)
            talk(robot, [(end, client)], 100)
            answers = [decode_frame(data) for data in client.received.split(b"\0") if data]
            assert [answer and answer.seq for answer in answers] == [number, PING_SEQ]


# -- silent clients -----------------------------------------------------------------------------


PLACE_MS = 10_000  # kPlaceMs of radio.h


@drawn
def test_a_silent_phone_keeps_nobody_off_bluetooth() -> None:
    """It keeps its place for ten seconds at most once somebody else comes."""
    robot, _ = make_owned_robot(keys := Keys())
    talk(robot, [], AUTHORITY_MS)
    phone, first = LowEnergy(robot), remote(robot, keys, 2)
    assert upload_text(robot, [(phone, first)], first, "SI|F(0.1, 30)") == "OK"
    talk(robot, [(phone, RawClient())], PLACE_MS - 50)
    early = LowEnergy(robot)
    assert early.has_ended and not phone.has_ended, "never before"
    assert wait_for_outcome(robot, [(phone, first)], first.ping()) == "OK"
    talk(robot, [(phone, RawClient())], 3 * PLACE_MS)
    assert not phone.has_ended, "while nobody else comes"
    owner = remote(robot, keys, 3)
    clients: Ends = [(end := LowEnergy(robot), owner)]
    assert phone.has_ended and not end.has_ended
    assert upload_text(robot, clients, owner) == "OK"
    phone.send(bytes(STOP_BYTES))
    talk(robot, clients, 3 * PLACE_MS)
    assert actions_of(robot)[-1] == "MOTORS 80 80", (
        "its session lives, and nothing of the phone does"
    )
    owner.stop(robot.now_ms)
    talk(robot, clients, 20)
    assert actions_of(robot)[-1] == "MOTORS 0 0"


@drawn
def test_a_client_that_connects_too_early_affects_nobody() -> None:
    robot, _ = make_owned_robot(keys := Keys())
    talk(robot, [], AUTHORITY_MS)
    owner = remote(robot, keys, 2)
    clients: Ends = [(end := LowEnergy(robot, 247), owner)]
    assert upload_text(robot, clients, owner) == "OK"
    for _ in range(300):
        early_end = LowEnergy(robot, 100)
        assert early_end.has_ended and early_end.take() == b""
        early_end.send(b"S\n" + bytes(STOP_BYTES))
        talk(robot, clients, 100)
    assert not end.has_ended and actions_of(robot)[-1] == "MOTORS 80 80"
    end.leave()
    talk(robot, [], 5)
    next_client = remote(robot, keys, 3)
    assert upload_text(robot, [(LowEnergy(robot), next_client)], next_client) == "OK", (
        "and the robot is still found"
    )


@drawn
def test_a_disconnect_during_another_connect_is_attributed_correctly() -> None:
    robot, _ = make_owned_robot(keys := Keys())
    talk(robot, [], AUTHORITY_MS)
    for _ in range(5):
        phone, first = LowEnergy(robot), remote(robot, keys, 2)
        assert wait_for_outcome(robot, [(phone, first)], first.ping()) == "OK"
        talk(robot, [(phone, RawClient())], PLACE_MS)
        end, owner = LowEnergy(robot), remote(robot, keys, 3)
        phone.leave()  # again, and the number of its connection is free
        refused_low_energy = LowEnergy(robot)
        refused_low_energy.leave()
        assert upload_text(robot, [(end, owner)], owner) == "OK"
        talk(robot, [(end, owner)], 1500)
        assert actions_of(robot)[-1] == "MOTORS 80 80"
        end.leave()
        talk(robot, [], 5)
        assert actions_of(robot)[-1] == "MOTORS 0 0"


CLIENT_PLACES = 2  # kClients of tcp_clients.cpp
FIRST_BYTES = (
    b"",
    b"X",
    b"SI|F(60, 80",
    b"\0\5\7\7",
    b"\0" + bytes(STOP_BYTES),
    b"GET / HTTP/1.1\r\n",
)


@pytest.mark.sampled("seed")
@pytest.mark.parametrize("seed", range(10))
def test_surplus_network_clients_are_disconnected(seed: int) -> None:
    """And whoever has one is told what it asked, whoever had it before."""
    rng = random.Random(seed)
    robot, end, _ = far_owner(keys := Keys())
    end.leave()
    talk(robot, [], AUTHORITY_MS)
    sockets = radios(robot).sockets  # that listens
    guests: list[tuple[Network, Client]] = []
    owners: list[tuple[Network, Session]] = []
    for number in range(15):
        end = Network(robot)
        if rng.random() < 0.6:
            guests.append((end, RawClient(rng.choice(FIRST_BYTES))))
        else:
            owners.append((end, remote(robot, keys if rng.random() < 0.7 else None, 20 + number)))
            guests.append(owners[-1])
        talk(robot, guests, rng.choice((5, 30, 300, 1200)))
        for end, client in owners:
            request = client.clear()  # with a key, whoever has one
            for _ in range(3000):
                if request.outcome is None and not end.has_ended:
                    talk(robot, guests, 1)
            assert end.has_ended or request.outcome
        for end, _ in guests:
            end.take()
        if rng.random() < 0.2:
            guests[-1][0].leave()
            guests[-1][0].has_ended = True
            talk(robot, [], 5)
        guests = [guest for guest in guests if not guest[0].has_ended]
        owners = [owner for owner in owners if not owner[0].has_ended]
        assert len(guests) == radios(robot).sockets - sockets <= CLIENT_PLACES


@drawn
def test_owners_on_the_network_keep_their_places_while_they_speak() -> None:
    """However long they have been there, and whoever else comes."""
    robot, end, owner = far_owner(keys := Keys())
    clients: list[tuple[Network, Session]] = [(end, owner)]
    clients += [(Network(robot), remote(robot, keys, 1 + k)) for k in range(1, CLIENT_PLACES)]
    for _ in range(5):
        for _, client in clients:
            assert wait_for_outcome(robot, [*clients], client.clear())
        talk(robot, [*clients], PLACE_MS // 2)
        newcomer = Network(robot)
        talk(robot, [*clients, (newcomer, RawClient(bytes(STOP_BYTES)))], 100)
        assert newcomer.has_ended and not any(end.has_ended for end, _ in clients)


def has_client(robot: Esp32Robot) -> bool:
    return robot.radio("E") == b"\1"


@drawn
def test_a_silent_phone_keeps_nobody_off_the_serial_port() -> None:
    """The core rejects each further one: the next try of a rejected one gets the place."""
    robot, _ = make_owned_robot(keys := Keys())
    talk(robot, [], AUTHORITY_MS)
    phone, first = SerialPort(robot), remote(robot, keys, 2)
    assert upload_text(robot, [(phone, first)], first) == "OK"
    for _ in range(5):
        talk(robot, [(phone, first)], 5000)
        SerialPort(robot)
        assert has_client(robot), "who speaks stays"
    assert actions_of(robot)[-1] == "MOTORS 80 80"
    first.stop(robot.now_ms)
    talk(robot, [(phone, first)], 20)
    talk(robot, [(phone, RawClient())], PLACE_MS - 1000)
    SerialPort(robot)
    assert has_client(robot), "never before"
    talk(robot, [(phone, RawClient())], 3 * PLACE_MS)
    assert has_client(robot), "while nobody else comes"
    owner = remote(robot, keys, 3)
    SerialPort(robot)
    talk(robot, [], 5)
    assert not has_client(robot)
    clients: Ends = [(SerialPort(robot), owner)]
    assert upload_text(robot, clients, owner) == "OK"
    talk(robot, clients, 2 * PLACE_MS)
    assert actions_of(robot)[-1] == "MOTORS 80 80"
