"""`tsc` as a process of its own, and a robot with an ESP32 behind a pseudo-terminal."""

from __future__ import annotations

from collections.abc import Iterator
from signal import SIGINT

import pytest

from tests.machines.esp32 import Esp32Robot
from tests.machines.host_firmware import HostFirmware
from tests.support.esp32_pty_robot import Esp32PtyRobot
from tests.support.pty_robot import on, uploading

SAVED = "saved in slot"


@pytest.fixture(params=["tinibot32", "tinibotc3"])
def robot(request: pytest.FixtureRequest) -> Iterator[Esp32PtyRobot]:
    found = Esp32PtyRobot(request.param)
    with found:
        yield found


def test_upload_stop_and_what_is_there_after_a_power_cut(robot: Esp32PtyRobot) -> None:
    command = uploading(robot)
    command.signal(SIGINT)
    done = command.ended()
    assert not robot.moves, (done.out, done.err)
    done = on(robot, "upload", "-e", "SB|F(0.3, 60)")
    assert done.code == 0, done.err
    robot.until(lambda: SAVED in on(robot, "info").out, "it is saved")
    robot.switch_off()
    robot.switch_on()
    robot.until(lambda: robot.robot_ms > 200, "it has started")
    robot.hold(100)  # longer than the sketch takes a spike to be
    robot.until(lambda: "MOTORS 60 60" in robot.did, "the button starts what was saved")


def test_a_line_and_a_reading(robot: Esp32PtyRobot) -> None:
    board = robot.profile.board
    pin = board.sensors[0].pins["pin"]

    def dim(found: HostFirmware) -> None:
        assert isinstance(found, Esp32Robot)
        found.analog(pin, 2048)

    robot.ask(dim)
    done = on(robot, "upload", "-e", "SI|SHOW(LIGHT_R);F(0.2, 50)")
    assert done.code == 0 and "512" in done.out
    assert robot.did[:2] == ["MOTORS 50 50", "MOTORS 0 0"]


def test_a_main_loop_that_hangs(robot: Esp32PtyRobot) -> None:
    """The timer stops the motors, the watchdog restarts the chip, and `tsc` says what hung."""
    command = uploading(robot)
    robot.hang(1100)
    assert "RESTART" in robot.did and not robot.moves
    robot.restart()
    command.ended()
    said = on(robot, "info")
    assert said.code == 0, said.err
    assert "hung" in said.out or "did not go on" in said.out, said.out
