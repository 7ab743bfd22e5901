"""A bad line to a robot with an ESP32: a line that stays low stops it, as on an Uno.

For a break of any length, the UART of this chip delivers one byte 0, and its driver reports it
once.
"""

from __future__ import annotations

import pytest

from tests.machines.esp32 import Esp32Robot
from tests.support.esp32_radio import session, talk
from tests.support.images import image_of
from tests.support.robot_on_esp32 import Ends, boot, wait_for_outcome
from tests.support.robot_on_host import actions_of
from tiniscript.link.messages import STOP_ZEROS

NAMES = ["tinibot32", "tinibotc3"]
FORWARD, OFF = "MOTORS 80 80", "MOTORS 0 0"
FIFO_MS = 12  # time until the driver hands over the chip's bytes


def type_line(robot: Esp32Robot, line: bytes = b"F(60, 80)\r\n") -> Esp32Robot:
    """Send a robot a line of text, after which it needs no computer."""
    robot.step(line)
    robot.wait(200)
    return robot


def framing(robot: Esp32Robot) -> int:
    client = session(9, robot)
    status = client.status()
    assert wait_for_outcome(robot, [(None, client)], status) == "OK" and status.outcome
    return status.outcome.values.framing


@pytest.mark.sampled("name")
@pytest.mark.parametrize("name", NAMES)
def test_a_line_held_low_stops_a_detached_program(name: str) -> None:
    robot = type_line(boot(name))
    assert actions_of(robot) == [FORWARD]
    robot.hold_line()
    robot.wait(10)
    assert actions_of(robot) == [FORWARD, OFF]
    robot.wait(3000)
    for _ in range(3):
        robot.hold_line(False)
        robot.wait(1200)
        type_line(robot, b"SI|F(60, 80)\r\n")
        assert actions_of(robot)[-1] == FORWARD, "a line that is high again has a sender"
        robot.hold_line()
        robot.wait(10)
        assert actions_of(robot)[-1] == OFF
    robot.hold_line(False)
    robot.wait(1200)
    assert framing(robot) >= 4


def test_a_line_that_stays_low_counts_as_unconnected() -> None:
    """A cable that was pulled out stays as it is, and the robot has its button."""
    robot = boot()
    client = session(1, robot)
    clients: Ends = [(None, client)]
    upload = client.upload(image_of("SB|F(60, 80)"))
    assert wait_for_outcome(robot, clients, upload) == "OK"
    talk(robot, clients, 2000)
    robot.hold_line()
    robot.wait(1500)
    robot.push()
    robot.wait(3000)
    assert actions_of(robot)[-1] == FORWARD
    robot.push()
    dead = Esp32Robot(kept_memory=robot.read_kept())
    dead.hold_line()
    dead.wait(500)
    dead.push()
    dead.wait(3000)
    assert actions_of(dead)[-1] == FORWARD, "nor has one that was never high"


@pytest.mark.parametrize("name", NAMES)
def test_a_short_disturbance_stops_no_robot(name: str) -> None:
    robot = type_line(boot(name))
    for _ in range(3):
        robot.hold_line()
        robot.wait(2)  # much longer than a byte
        robot.hold_line(False)
        robot.wait(50)
        robot.step(b"// \r\n")  # earlier bytes no longer matter
    robot.wait(1000)
    assert actions_of(robot) == [FORWARD]


def test_each_byte_with_a_framing_error_becomes_a_zero() -> None:
    robot = type_line(boot())
    for spoiled in (3, 4):
        robot.step(b"//\r\n")
        robot.wait(50)
        for _ in range(spoiled):
            robot.spoil_byte()
        robot.wait(FIFO_MS + 2, b"\xff")
        assert actions_of(robot)[-1] == (FORWARD if spoiled == 3 else OFF)
    assert framing(robot) == 7


@pytest.mark.parametrize("pause_ms", [1, 5, FIFO_MS, FIFO_MS + 1, 30, 200])
def test_every_framing_error_counts_as_fast_as_the_first(pause_ms: int) -> None:
    """No byte follows it, and others preceded it."""
    robot = type_line(boot())
    for _ in range(3):
        assert actions_of(robot)[-1] == FORWARD
        for _ in range(STOP_ZEROS):
            robot.wait(pause_ms)
            robot.spoil_byte()
        robot.wait(FIFO_MS + 2)
        assert actions_of(robot)[-1] == OFF
        robot.wait(1200)
        type_line(robot, b"SI|F(60, 80)\r\n")


@pytest.mark.parametrize("bytes_before", [b"", b"F(60, ", b"F(60, 80"])
def test_a_line_with_a_framing_error_in_it_does_nothing(bytes_before: bytes) -> None:
    """This holds for an error at any place, and however late the driver delivers the byte."""
    for late_ms in (0, 1, 5, FIFO_MS - 2):
        robot = boot()
        robot.step(bytes_before)
        robot.spoil_byte()
        robot.wait(late_ms)
        robot.step(b"F(60, 80)\r\n"[len(bytes_before) :])
        robot.wait(200)
        assert actions_of(robot) == [], (bytes_before, late_ms)
        robot.wait(1200)
        assert actions_of(type_line(robot)) == [FORWARD], "the next line is another one"


def test_bytes_after_a_framing_error_do_not_count_as_a_held_line() -> None:
    robot = type_line(boot())
    robot.spoil_byte()
    for _ in range(100):
        robot.step(b"\x01\x02\x04\x08")
    robot.wait(1000)
    assert actions_of(robot) == [FORWARD]
