"""Programs with tasks on a simulated Uno or Mega, with the firmware that ships: pins and stops."""

from __future__ import annotations

import pytest

from tests.support.board_builds import BOARDS, each_board
from tests.support.casefile import ROOT, Case, read
from tests.support.robot_on_host import outcome
from tests.support.robot_on_uno import FORWARD, MOTORS, OFF, computer, send, states
from tests.support.task_states import STATES
from tests.support.uno_trace import (
    OFF_MS,
    MotorSetting,
    check_pins,
    last_zero,
    motor_settings,
    program,
)
from tiniscript.link.messages import STATE_STOPPED
from tiniscript.link.requests import OK
from tools.uno import CYCLES_PER_MS, Uno

AWAY_PROGRAM = (ROOT / "examples" / "away.ts").read_text(encoding="utf-8")
NOTICE_MS = 90.0  # time for a WHEN to notice: 20 ms, plus an echo 30 ms after the previous one
BUSY_PROGRAM = "F(FOREVER, 60);" + "TASK;X = 0;LOOP(FOREVER);X = X + 1;END_LOOP;END_TASK;" * 4
STOP_BYTES = bytes(8)
STOP_ZEROS = (
    3  # the last zero of a stop that a robot must have seen after a frame, which ends with one
)
STOP_US = 12


def without_readings() -> list[Case]:
    """Return the cases of tasks that a simulated board can follow to the millisecond."""
    cases = [case for case in read(ROOT / "tests" / "cases" / "tasks.md") if "robot" in case.parts]
    cases = [case for case in cases if "tiniscript" in case.parts]
    return [case for case in cases if not {"READ", "FAULT"} & set(case.parts["robot"].split())]


@pytest.mark.sampled("case", "board", keep=2)
@BOARDS
@pytest.mark.parametrize("case", without_readings(), ids=lambda case: case.title)
def test_the_pins_follow_the_trace(case: Case, robot: Uno) -> None:
    check_pins(case, robot)


@each_board
def test_the_clock_runs_on_while_four_tasks_count(robot: Uno) -> None:
    text = "LOOP(3);F(0.1, 60);B(0.1, 60);END_LOOP;" + BUSY_PROGRAM.partition(";")[2]
    check_pins(
        program(text)._replace(parts={"tiniscript": text, "senses": "max-time = 0.5"}), robot
    )


def list_settings(robot: Uno, since_cycle: int) -> list[MotorSetting]:
    """Return the motor settings since a cycle, without those of standing."""
    return [setting for setting in motor_settings(robot, since_cycle) if setting[1:] != (0, 0)]


@each_board
def test_the_robot_backs_away_from_an_obstacle_and_drives_on(robot: Uno) -> None:
    """It does so each time, and if the obstacle has gone in the meantime, it drives on at once."""
    robot.set_sonar_distance("trigger", "echo", 80)
    wired_uno = computer(robot)
    send(wired_uno, AWAY_PROGRAM, is_detached=True)
    wired_uno.run(500)
    assert states(robot) == FORWARD
    for wait_ms in (0, 7):
        wired_uno.run(wait_ms)
        near_cycle = robot.cycle
        robot.set_sonar_distance("trigger", "echo", 10)
        wired_uno.run(700)
        robot.set_sonar_distance("trigger", "echo", 80)
        wired_uno.run(800)
        settings = list_settings(robot, near_cycle)
        assert [setting[1:] for setting in settings] == [(-60, -60), (60, -60), (60, 60)]
        begins, turns, goes_on = (setting.ms for setting in settings)
        assert begins < NOTICE_MS and abs(turns - begins - 500) < OFF_MS
        assert 500 - OFF_MS < goes_on - turns < 500 + NOTICE_MS


@each_board
def test_a_missing_echo_delays_no_other_task(robot: Uno) -> None:
    robot.set_sonar_distance("trigger", "echo", None)
    wired_uno = computer(robot)
    heard_count = len(robot.received_bytes)
    send(wired_uno, "LOOP(4);F(0.2, 60);B(0.2, 60);END_LOOP;WHEN(DISTANCE < 15);S;END_WHEN",
         is_detached=True)  # fmt: skip
    wired_uno.run(2000)
    settings = list_settings(robot, last_zero(robot, heard_count))
    assert [setting[1:] for setting in settings] == [(60, 60), (-60, -60)] * 4
    for number, setting in enumerate(settings):
        assert abs(setting.ms - 200 * number) < OFF_MS, settings
    assert states(robot) == OFF


@pytest.mark.sampled("later_ms", "board", keep=2)
@BOARDS
@pytest.mark.parametrize("later_ms", [100, 200, 500, 5000])
def test_an_echo_before_an_interruption_ends_no_move(later_ms: int, robot: Uno) -> None:
    """A ping is under way when a WHEN takes the motors: after that a new one is heard."""
    robot.set_sonar_distance("trigger", "echo", 350)
    wired_uno = computer(robot)
    backing_when = f"WHEN(LIGHT_R + LIGHT_L > 1000);B({later_ms / 1000}, 60);END_WHEN"
    send(wired_uno, f"F(FOREVER, 60)UNTIL(DISTANCE < 300);S;{backing_when}", is_detached=True)
    wired_uno.run(300)
    robot.run_until("trigger", "low", 60)
    robot.run_ms(35)
    robot.set_sonar_distance("trigger", "echo", 250)  # distance of the next ping
    robot.set_analog("A0", 1023)
    begun_pin_change = robot.run_until("trigger", "low", 60)
    wired_uno.run(6)
    assert list_settings(robot, begun_pin_change.cycle)[0][1:] == (-60, -60)
    robot.set_sonar_distance("trigger", "echo", 350)
    robot.set_analog("A0", 0)
    wired_uno.run(later_ms + 200)
    assert [setting[1:] for setting in list_settings(robot, begun_pin_change.cycle)] == [
        (-60, -60),
        (60, 60),
    ]
    assert states(robot) == FORWARD


@each_board
def test_a_stop_ends_busy_tasks(robot: Uno) -> None:
    """It reaches the pins as fast as in any program, and no motor starts again."""
    wired_uno = computer(robot)
    send(wired_uno, BUSY_PROGRAM, is_detached=True)
    wired_uno.run(50)
    assert states(robot) == FORWARD
    robot.send(STOP_BYTES)
    robot.run_ms(20)
    stop_cycle = max(robot.pins[name].cycle for name in ("left", "right"))
    last_cycle = robot.received_bytes[STOP_ZEROS - 1 - len(STOP_BYTES)].cycle
    assert states(robot) == OFF
    assert 0 < stop_cycle - last_cycle < STOP_US * CYCLES_PER_MS // 1000
    wired_uno.run(300)
    assert states(robot) == OFF
    assert wired_uno.session.events()[-1].name == "STOPPED"


@pytest.mark.sampled("state", "board", keep=2)
@BOARDS
@pytest.mark.parametrize("state", STATES)
def test_a_stop_ends_all_tasks(state: str, robot: Uno) -> None:
    """No task continues, even in the next program."""
    wired_uno = computer(robot)
    send(wired_uno, STATES[state], is_detached=True)
    wired_uno.run(300)
    assert (states(robot) == OFF) == (state == "a task waits")
    robot.send(STOP_BYTES)
    robot.run_ms(20)
    assert states(robot) == OFF
    stop_cycle = robot.cycle
    wired_uno.run(2000)
    assert not [name for name in MOTORS if robot.pins.history(name)[-1].cycle > stop_cycle]
    status = wired_uno.session.status()
    assert wired_uno.until(status) == OK
    assert outcome(status).values.state == STATE_STOPPED
    send(wired_uno, "F(600, 80)", is_detached=True)
    wired_uno.run(100)
    assert states(robot) == FORWARD
