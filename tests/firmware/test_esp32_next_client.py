"""What one client did, or did not do, costs the next client of its place nothing."""

from __future__ import annotations

import random
from collections.abc import Callable

import pytest

from tests.firmware.test_esp32_transports import AWAY, Ends, Make, ended, uploaded
from tests.firmware.test_esp32_wifi import far_owner, owned, remote
from tests.firmware.test_host_firmware import happened
from tests.machines.esp32 import Esp32Robot
from tests.support.esp32_radio import Bytes, End, LowEnergy, Network, SerialPort, session, talk
from tests.support.images import image_of
from tests.support.owners import Keys
from tiniscript.link.messages import AUTHORITY_MS, STOP_BYTES
from tiniscript.link.session import Session

PLACES: list[Make] = [LowEnergy, SerialPort, Network]


def with_wrong_key(robot: Esp32Robot, keys: Keys, nonce: int) -> Session:
    wrong = Keys()
    wrong.found = [robot_key._replace(key=bytes([nonce + 99] * 16)) for robot_key in keys.found]
    return remote(robot, wrong, nonce)


def shows_wrong_keys(robot: Esp32Robot, end: End, keys: Keys) -> None:
    thief = with_wrong_key(robot, keys, 1)
    for _ in range(10):
        assert ended(robot, [(end, thief)], thief.start()) != "OK"


def begins_an_upload(robot: Esp32Robot, end: End, keys: Keys) -> None:
    stranger = session(3, robot)
    stranger.upload(image_of("SB|" + ";".join("F(1, 80)" for _ in range(800))))
    talk(robot, [(end, stranger)], 300)


def claims(robot: Esp32Robot, end: End, keys: Keys) -> None:
    stranger = remote(robot, Keys(50), 4)
    stranger.claim(0)
    talk(robot, [(end, stranger)], 300)


def says(data: bytes) -> Callable[[Esp32Robot, End, Keys], None]:
    def it(robot: Esp32Robot, end: End, keys: Keys) -> None:
        talk(robot, [(end, Bytes(data))], 30)

    return it


WRONGS = {
    "wrong keys": shows_wrong_keys,
    "an upload": begins_an_upload,
    "a claim": claims,
    "half a frame": says(b"\0\0\5\7\7"),
    "noise": says(b"\0\0" + random.Random(5).randbytes(3000)),
    "half a line": says(b"SI|F(60, 80"),
    "half a block": says(b"SI|LOOP(2)\n"),
    "stops": says(b"\0\0" + bytes(STOP_BYTES) * 9),
}


def owners_time(robot: Esp32Robot, make: Make, keys: Keys) -> int:
    """Return how long the owner takes from a new connection until a program runs."""
    owner = remote(robot, keys, 8)
    began_ms = robot.now_ms
    ends: Ends = [(make(robot), owner)]
    assert uploaded(robot, ends, owner, AWAY) == "OK"
    return robot.now_ms - began_ms


@pytest.mark.parametrize("make", PLACES)
@pytest.mark.parametrize("wrong", WRONGS)
def test_what_one_did_wrong_costs_the_next_one_nothing(make: Make, wrong: str) -> None:
    def place() -> tuple[Esp32Robot, Keys]:
        keys = Keys()
        robot, end, _ = far_owner(keys)
        end.leave()
        talk(robot, [], AUTHORITY_MS + 100)
        return robot, keys

    robot, keys = place()
    talk(robot, [(end := make(robot), Bytes())], 300)
    end.leave()
    talk(robot, [], 5)
    usual_ms = owners_time(robot, make, keys)

    robot, keys = place()
    for _ in range(3):
        end = make(robot)
        WRONGS[wrong](robot, end, keys)
        end.leave()
        talk(robot, [], 5)
    assert owners_time(robot, make, keys) <= usual_ms + 30  # a stop is released first


@pytest.mark.parametrize("make", PLACES[:2])
@pytest.mark.parametrize("typed", [b"OK+CONN", b"\0si|", b"SI|LOOP(2)", b"FOO(1)\n"])
def test_nobody_is_told_what_another_one_has_typed(make: Make, typed: bytes) -> None:
    robot, _ = owned(Keys())
    talk(robot, [], AUTHORITY_MS)
    talk(robot, [(end := make(robot), Bytes(typed))], 2)
    end.leave()
    talk(robot, [], 1)
    talk(robot, [(make(robot), other := Bytes(b"\0"))], 4000)
    assert other.heard == b""


@pytest.mark.parametrize("make", PLACES[:2])
def test_zeros_of_two_clients_are_no_stop(make: Make) -> None:
    robot, owner = owned(Keys())
    assert uploaded(robot, [(None, owner)], owner, AWAY) == "OK"
    talk(robot, [(None, owner), (end := make(robot), Bytes(b"\0\0\0"))], 2)
    end.leave()
    talk(robot, [(None, owner)], 2)
    talk(robot, [(None, owner), (make(robot), Bytes(b"\0"))], 100)
    assert happened(robot)[-1] == "MOTORS 80 80"


# -- who is silent ------------------------------------------------------------------------------


PLACE_MS = 10_000  # kPlaceMs of radio.h


def test_a_silent_phone_keeps_nobody_off_bluetooth() -> None:
    """Not for longer than ten seconds, and where nobody comes, not at all."""
    robot, _ = owned(keys := Keys())
    talk(robot, [], AUTHORITY_MS)
    phone, first = LowEnergy(robot), remote(robot, keys, 2)
    assert uploaded(robot, [(phone, first)], first, "SI|F(0.1, 30)") == "OK"
    talk(robot, [(phone, Bytes())], PLACE_MS - 50)
    early = LowEnergy(robot)
    assert early.has_ended and not phone.has_ended, "never before"
    assert ended(robot, [(phone, first)], first.ping()) == "OK"
    talk(robot, [(phone, Bytes())], 3 * PLACE_MS)
    assert not phone.has_ended, "while nobody else comes"
    owner = remote(robot, keys, 3)
    ends: Ends = [(end := LowEnergy(robot), owner)]
    assert phone.has_ended and not end.has_ended
    assert uploaded(robot, ends, owner) == "OK"
    phone.send(bytes(STOP_BYTES))
    talk(robot, ends, 3 * PLACE_MS)
    assert happened(robot)[-1] == "MOTORS 80 80", "its session lives, and nothing of the phone does"
    owner.stop(robot.now_ms)
    talk(robot, ends, 20)
    assert happened(robot)[-1] == "MOTORS 0 0"


def test_whoever_comes_too_early_costs_nobody_anything() -> None:
    robot, _ = owned(keys := Keys())
    talk(robot, [], AUTHORITY_MS)
    owner = remote(robot, keys, 2)
    ends: Ends = [(end := LowEnergy(robot, 247), owner)]
    assert uploaded(robot, ends, owner) == "OK"
    for _ in range(300):
        other = LowEnergy(robot, 100)
        assert other.has_ended and other.taken() == b""
        other.send(b"S\n" + bytes(STOP_BYTES))
        talk(robot, ends, 100)
    assert not end.has_ended and happened(robot)[-1] == "MOTORS 80 80"
    end.leave()
    talk(robot, [], 5)
    again = remote(robot, keys, 3)
    assert uploaded(robot, [(LowEnergy(robot), again)], again) == "OK", (
        "and the robot is still found"
    )


def test_who_leaves_while_another_one_comes_is_the_one_who_leaves() -> None:
    robot, _ = owned(keys := Keys())
    talk(robot, [], AUTHORITY_MS)
    for _ in range(5):
        phone, first = LowEnergy(robot), remote(robot, keys, 2)
        assert ended(robot, [(phone, first)], first.ping()) == "OK"
        talk(robot, [(phone, Bytes())], PLACE_MS)
        end, owner = LowEnergy(robot), remote(robot, keys, 3)
        phone.leave()  # again, and the number of its connection is free
        refused = LowEnergy(robot)
        refused.leave()
        assert uploaded(robot, [(end, owner)], owner) == "OK"
        talk(robot, [(end, owner)], 1500)
        assert happened(robot)[-1] == "MOTORS 80 80"
        end.leave()
        talk(robot, [], 5)
        assert happened(robot)[-1] == "MOTORS 0 0"


def has_client(robot: Esp32Robot) -> bool:
    return robot.radio("E") == b"\1"


def test_a_silent_phone_keeps_nobody_off_the_serial_port() -> None:
    """The core sends each further one away: the next try of who was sent away gets the place."""
    robot, _ = owned(keys := Keys())
    talk(robot, [], AUTHORITY_MS)
    phone, first = SerialPort(robot), remote(robot, keys, 2)
    assert uploaded(robot, [(phone, first)], first) == "OK"
    for _ in range(5):
        talk(robot, [(phone, first)], 5000)
        SerialPort(robot)
        assert has_client(robot), "who speaks stays"
    assert happened(robot)[-1] == "MOTORS 80 80"
    first.stop(robot.now_ms)
    talk(robot, [(phone, first)], 20)
    talk(robot, [(phone, Bytes())], PLACE_MS - 1000)
    SerialPort(robot)
    assert has_client(robot), "never before"
    talk(robot, [(phone, Bytes())], 3 * PLACE_MS)
    assert has_client(robot), "while nobody else comes"
    owner = remote(robot, keys, 3)
    SerialPort(robot)
    talk(robot, [], 5)
    assert not has_client(robot)
    ends: Ends = [(SerialPort(robot), owner)]
    assert uploaded(robot, ends, owner) == "OK"
    talk(robot, ends, 2 * PLACE_MS)
    assert happened(robot)[-1] == "MOTORS 80 80"
