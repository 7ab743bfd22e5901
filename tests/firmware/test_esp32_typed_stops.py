"""Typed stops of an ESP32: over each transport while another one drives, and where bytes are lost.

A radio's task hands bytes to the main loop by a ring of 1,023 places. A stop that finds no room
there is a stop all the same.
"""

from __future__ import annotations

import random

import pytest

from tests.machines.esp32 import Esp32Robot
from tests.support.esp32_radio import End, Network, RawClient, session, talk
from tests.support.esp32_wifi import join_network
from tests.support.images import image_of
from tests.support.owners import Keys
from tests.support.robot_on_esp32 import RADIOS, Ends, Make, boot, upload_text, wait_for_outcome
from tests.support.robot_on_host import actions_of
from tests.support.stop_spellings import ALL_PREFIXES, SHORTEST_STOP_MS, SILENCE_MS, spellings_after
from tiniscript.link.frames import Frame, encode_frame
from tiniscript.link.messages import BY_NAME
from tiniscript.link.session import Session
from tiniscript.virtual.protocol_sniffer import sniff_robot_client

ROOM = 1022  # bytes; one slot is for a leaving client
LATE_MS = 3  # a turn of the radio's task, and the delay of this computer's network
WHOLE = encode_frame(Frame(BY_NAME["STATUS"].number, 9, 0))


def start_drive(robot: Esp32Robot, driver: Session, end: End | None = None) -> Ends:
    """Make a robot drive, by its cable or over a transport."""
    clients: Ends = [(end, driver)]
    assert upload_text(robot, clients, driver) == "OK"
    talk(robot, clients, 10)
    assert actions_of(robot)[-1] == "MOTORS 80 80"
    return clients


def has_stopped(robot: Esp32Robot) -> bool:
    return actions_of(robot)[-1] == "MOTORS 0 0"


def check_stop(
    robot: Esp32Robot, end: End | None, clients: Ends, data: bytes, description: str
) -> None:
    """Send bytes that end with a stop. From then on, the robot does not drive."""
    typed: Ends = [*clients, (end, RawClient(data))]
    talk(robot, typed, LATE_MS)
    if not has_stopped(robot):
        talk(robot, typed, SHORTEST_STOP_MS)  # inside a started frame
    assert has_stopped(robot), description
    talk(robot, [*clients, (end, RawClient(b"SI|F(1,80)\n"))], 50)  # before a second of silence
    assert has_stopped(robot), description


def check_stop_after_every_prefix(
    robot: Esp32Robot, driver: Session, driver_end: End | None, end: End | None
) -> None:
    for k, (name, prefix) in enumerate(ALL_PREFIXES.items()):
        spellings = spellings_after(name)
        for spelling in (spellings[k % len(spellings)], spellings[-1 - k % len(spellings)]):
            clients = start_drive(robot, driver, driver_end)
            check_stop(robot, end, clients, prefix + spelling, f"{name} {spelling!r}")


@pytest.mark.parametrize("make", RADIOS)
def test_a_typed_stop_over_a_radio_stops_a_run_of_the_cable(make: Make) -> None:
    robot = boot()
    check_stop_after_every_prefix(robot, session(1, robot), None, make(robot))


def test_a_typed_stop_over_a_network_works() -> None:
    """Typed lines do not drive there, but a typed stop works."""
    robot, owner = join_network(Keys())
    end = Network(robot)
    end.send(b"\0\0")
    check_stop_after_every_prefix(robot, owner, None, end)
    end.leave()


@pytest.mark.parametrize("word", [b"S", b"\r\n sToP; ", b"SS", b"PARA", b"Stop.", b"\x03"])
def test_silence_ends_a_typed_stop_of_a_stranger(word: bytes) -> None:
    """A client in a network that may still be a web page is not admitted by it."""
    robot, owner = join_network(Keys())
    end = Network(robot)
    end.send(word)
    talk(robot, [(None, owner)], SILENCE_MS + 100)  # no program runs
    clients = start_drive(robot, owner)
    talk(robot, clients, SILENCE_MS + 100)
    assert not has_stopped(robot)
    stranger_end = Network(robot)
    stranger_end.send(word)
    talk(robot, clients, SILENCE_MS - 50)
    assert not has_stopped(robot)
    talk(robot, clients, 50 + LATE_MS)
    assert has_stopped(robot)
    page = b"S / HTTP/1.1\r\n"
    stranger_end.send(page)
    talk(robot, clients, LATE_MS)
    stranger_end.take()
    assert stranger_end.has_ended == (sniff_robot_client(word + page) is False)
    check_stop(robot, end, start_drive(robot, owner), b"S\n", "after one that has stopped nothing")
    end.leave()
    stranger_end.leave()


@pytest.mark.parametrize("words", [[b"SSS"], [b"S", b"s", b"S"], [b"STOP ", b"STOP"]])
def test_a_stranger_who_sends_no_line_end_stops(words: list[bytes]) -> None:
    """A request has no line end before its target, and the stop admits no one."""
    robot, owner = join_network(Keys())
    clients = start_drive(robot, owner)
    end = Network(robot)
    for word in words:
        assert not has_stopped(robot)
        end.send(word)
        talk(robot, clients, LATE_MS)
    assert has_stopped(robot)
    end.leave()


def test_a_typed_stop_over_the_cable_stops_a_run_of_a_radio() -> None:
    robot = boot()
    check_stop_after_every_prefix(robot, session(1, robot), RADIOS[0](robot), None)


@pytest.mark.parametrize("make", RADIOS)
def test_the_next_client_begins_a_new_line(make: Make) -> None:
    """Unfinished text of the previous client ends with its connection."""
    robot = boot()
    driver = session(1, robot)
    clients = start_drive(robot, driver)
    end = make(robot)
    end.send(b"F(1,")
    talk(robot, clients, 2)
    end.leave()
    talk(robot, clients, 2)
    make(robot).send(b"S\n")
    talk(robot, clients, LATE_MS)
    assert has_stopped(robot)


@pytest.mark.parametrize("make", RADIOS)
@pytest.mark.parametrize("stop", [b"S\n", b" stop ;\r", bytes(4), b"Stop.\n", b"SSS", b"\0S\0"])
def test_a_stop_is_recognized_even_if_the_buffer_is_full(make: Make, stop: bytes) -> None:
    """This holds wherever the ring ends within it, and if the robot reads before the rest
    arrives."""
    robot = boot()
    driver, end = session(1, robot), make(robot)
    line = b"F(1,80)\n"
    for bytes_left in range(-1, len(stop) + 1):  # bytes of the stop that find room
        clients = start_drive(robot, driver)
        line_before = (line * ROOM)[: ROOM - bytes_left - 1] + b"\n"
        check_stop(robot, end, clients, line_before + stop, f"{bytes_left} of {stop!r}")
    for lost_count in range(len(stop)):
        clients = start_drive(robot, driver)
        end.send(b"(" * ROOM + b"\n" + stop[:lost_count])
        talk(robot, clients, 20)
        check_stop(
            robot, end, clients, stop[lost_count:], f"the rest after {lost_count} of {stop!r}"
        )


@pytest.mark.parametrize("make", RADIOS)
def test_lost_bytes_cause_no_stop(make: Make) -> None:
    """Nor does a frame that contains a line S and arrives whole after the lost bytes."""
    robot = boot()
    driver, end = session(1, robot), make(robot)
    clients = start_drive(robot, driver)
    client = session(2, robot)
    code = b"Z\n\nS\n\xcc\x03"
    for bytes_before in (b"F(1,80)\n" * 400, WHOLE * 400, b"FT\nS T\n\0\0FT" * 400):
        end.send(bytes_before)
        talk(robot, [*clients, (end, RawClient())], 2500)  # until the waiting lines are answered
        frame = encode_frame(Frame(BY_NAME["LIVE"].number, 9, 0, b"\1" + code))
        assert b"\nS\n" in frame
        end.send(b"\0" + frame)
        talk(robot, clients, SHORTEST_STOP_MS + 20)
        assert not has_stopped(robot)
    assert wait_for_outcome(robot, [*clients, (end, client)], client.status()) == "OK"


def motor_actions(robot: Esp32Robot) -> list[str]:
    return [line for line in actions_of(robot) if line.startswith("MOTORS")]


LINES = b"".join(b"F(1,%d)\n" % (20 + k % 70) for k in range(100))


@pytest.mark.sampled("make", "stop", keep=3)
@pytest.mark.parametrize("make", RADIOS)
@pytest.mark.parametrize("stop", [b"S\n", b"PARA\n", b"SSS", b"STOP STOP ", bytes(4), b"\x03\n"])
def test_a_stop_overtakes_the_lines_that_wait(make: Make, stop: bytes) -> None:
    """Earlier lines never start afterwards, and later ones count again."""
    robot = boot()
    driver, end = session(1, robot), make(robot)
    clients = start_drive(robot, driver)
    few_lines, many_lines = LINES[: 8 * 40], LINES[: 8 * 100]
    for bytes_before in (few_lines, many_lines, many_lines + b"LOOP(2)\n", b"\0" + many_lines):
        client = RawClient()
        end.send(bytes_before + stop)
        robot.wait(1)
        assert has_stopped(robot), (bytes_before[-20:], stop)
        talk(robot, [*clients, (end, client)], 500)
        talk(robot, [(end, client)], 3000)  # the driver has left
        assert has_stopped(robot), (bytes_before[-20:], stop)
        client.to_send = b"\r\nSI|F(0.1,33)\n"
        talk(robot, [(end, client)], 1500)
        assert motor_actions(robot)[-2:] == ["MOTORS 33 33", "MOTORS 0 0"], (
            bytes_before[-20:],
            client.received,
        )
        talk(robot, clients, 1500)
        clients = start_drive(robot, driver)


@pytest.mark.parametrize("make", RADIOS)
def test_a_stop_inside_a_waiting_open_block_belongs_to_the_block(make: Make) -> None:
    """As over a cable, it ends the running program at once and also becomes part of the line."""
    robot = boot()
    end, client = make(robot), RawClient()
    talk(robot, [(end, RawClient(b"SI|F(60, 80)\n"))], 100)
    lines = b"".join(b"F(0.01,%d) // one of twenty\n" % (20 + k) for k in range(20))
    end.send(b"LOOP(1)\n" + lines + b"S\nF(0.01,80)\nEND_LOOP\n")
    robot.wait(1)
    assert motor_actions(robot)[-1] == "MOTORS 0 0"
    talk(robot, [(end, client)], 2000)
    assert motor_actions(robot)[-3:] == ["MOTORS 39 39", "MOTORS 80 80", "MOTORS 0 0"]
    assert client.received.endswith(b"// OK\r\n// DONE\r\n")


@pytest.mark.parametrize("make", RADIOS)
def test_a_frame_before_a_waiting_stop_has_no_effect(make: Make) -> None:
    robot = boot()
    end = make(robot)
    live = b"\0" + encode_frame(Frame(BY_NAME["LIVE"].number, 9, 0, image_of("F(60, 80)").code))
    end.send(LINES[:0] + b"// " + b"x" * 500 + b"\n" + live * 6 + b"\nS\n")
    robot.wait(300)
    assert motor_actions(robot) == []


@pytest.mark.parametrize("make", RADIOS)
def test_a_stop_counts_even_if_its_client_leaves_at_once(make: Make) -> None:
    """In every state of the receiver: the client's other data is discarded, but not a complete
    stop.
    """
    robot = boot()
    driver = session(1, robot)
    count = 0
    for k, (name, prefix) in enumerate(ALL_PREFIXES.items()):
        spellings = spellings_after(name)
        for spelling in (spellings[k % len(spellings)], spellings[-1 - k % len(spellings)]):
            stops = []
            for leaves in (False, True):
                clients, end = start_drive(robot, driver), make(robot)
                driver.events()
                end.send(prefix + spelling)
                if leaves:
                    end.leave()
                talk(robot, clients, LATE_MS)
                events = [event.name for event in driver.events()]
                stops.append(has_stopped(robot) and "STOPPED" in events)
                end.leave()
                talk(robot, clients, LATE_MS)
            assert stops[1] or not stops[0], f"{name} {spelling!r}"
            count += stops[0]
    assert count > len(ALL_PREFIXES)


@pytest.mark.parametrize("make", RADIOS)
def test_a_stop_of_a_client_that_leaves_keeps_nobody_from_driving(make: Make) -> None:
    """This holds for any amount of waiting data, either of two clients, and any time of their
    leaving."""
    robot = boot()
    rng = random.Random(make.__name__)
    for number in range(30):
        waiting = LINES[: 8 * rng.randrange(1, 120)]
        left_ms = rng.randrange(4)
        first, second = rng.choice(
            ((b"S\n", b""), (b"", b"S\n"), (b"S\n", b"S\n"), (bytes(4), b"S\n"))
        )
        (end := make(robot)).send(waiting + first)
        talk(robot, [(end, RawClient())], left_ms)
        end.leave()
        (end := make(robot)).send(second)
        talk(robot, [(end, RawClient())], left_ms)
        end.leave()
        talk(robot, [], 300)  # until all of it is read
        client = session(100 + number, robot)
        end = make(robot)
        assert upload_text(robot, [(end, client)], client) == "OK"
        talk(robot, [(end, client)], 20)
        outcome = (len(waiting), first, second, left_ms)
        assert motor_actions(robot)[-1] == "MOTORS 80 80", outcome
        end.leave()
        talk(robot, [], 20)
        assert motor_actions(robot)[-1] == "MOTORS 0 0", outcome
