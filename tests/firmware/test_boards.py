"""The sketch's pins on a simulated board, to the cycle."""

from __future__ import annotations

from itertools import pairwise

import pytest

from tests.machines.board import MS, Board
from tests.support.board_states import (
    BACKWARD_MS,
    DRIVERS,
    FORWARD_MS,
    LAMP,
    MOVES_PROGRAM,
    OFF_MS,
    PRESS_MS,
    SERVOS,
    START_MS,
    STOPS,
    TURN_MS,
    on_board,
    pulses,
    robot_with,
    robot_with_driver,
    start_board,
)
from tiniscript import robots
from tiniscript.robots.ports import AVRS


@pytest.mark.sampled("name", keep=2)
@pytest.mark.parametrize("name", sorted(DRIVERS))
def test_motor_pins_follow_the_powers(name: str) -> None:
    board = start_board(robot_with_driver(name), MOVES_PROGRAM).run_for(START_MS + OFF_MS + 50)
    states = tuple(board.motors(START_MS + ms) for ms in (FORWARD_MS, BACKWARD_MS, TURN_MS, OFF_MS))
    assert states == DRIVERS[name][1]
    assert board.motors(START_MS - 1) == states[-1]


@pytest.mark.parametrize(("powers", "pin"), [("80, 0", 0), ("0, 80", 3)])
def test_a_single_motor_can_run_alone(powers: str, pin: int) -> None:
    board = start_board(robot_with_driver("tb6612"), f"SI|M({powers});W(1)").run_for(START_MS + 60)
    state = board.motors(START_MS + 50)
    assert (state[pin], state[-1]) == ("pwm 204", "high")


@pytest.mark.sampled("chip")
@pytest.mark.parametrize(("name", "chip"), [
    ("tinibot", "uno"), ("tinibot", "nano"), ("tinibot", "mega"),
    ("liner", "nano"), ("liner", "mega"), ("grabber", "mega"),
    ("elegoo4", "uno"), ("elegoo4", "nano"), ("elegoo4", "mega"), ("sumo", "uno"),
])  # fmt: skip
def test_shipped_robots_drive(name: str, chip: str) -> None:
    robot = on_board(name, chip)
    board = start_board(robot, MOVES_PROGRAM).run_for(START_MS + OFF_MS + 50)
    states = DRIVERS[robot.board.motors.driver][1]
    assert (
        tuple(board.motors(START_MS + ms) for ms in (FORWARD_MS, BACKWARD_MS, TURN_MS, OFF_MS))
        == states
    )


@pytest.mark.sampled("name", keep=2)
@pytest.mark.parametrize("name", ["servos", *sorted(DRIVERS)])
def test_nothing_moves_before_the_button(name: str) -> None:
    """Motor pins are low within a few cycles of the reset, and stay it; a press alone is not it."""
    robot = robot_with(SERVOS) if name == "servos" else robot_with_driver(name)
    board = Board(robot, MOVES_PROGRAM)
    board.set_level(PRESS_MS, robot.board.start_button, False)
    board.run_for(400)
    assert board.list_motor_changes() == []
    assert board.motors(60 / MS) == ("low",) * len(board.motor_pins())


def test_a_button_that_is_down_after_a_reset_starts_nothing() -> None:
    board = Board(robots.load("tinibot"), MOVES_PROGRAM)
    board.press(0, 150)
    assert board.run_for(300).list_motor_changes() == []


# -- servos that turn without end

LATE_US = 6  # a pulse ends when no other interrupt is at work


def test_servo_motors_turn_and_rest_for_a_second() -> None:
    board = start_board(robot_with(SERVOS), "SI|F(0.2, 80);M(0, 100);W(0.2)").run_for(
        START_MS + 2000
    )
    left, right = (pulses(board, pin) for pin in board.motor_pins())
    assert left[0][0] >= START_MS and right[0][0] >= START_MS
    forward = [us for ms, us in left if START_MS + 25 < ms < START_MS + 200]
    assert forward and all(abs(us - (1500 + 408)) < LATE_US for us in forward)
    forward = [us for ms, us in right if START_MS + 25 < ms < START_MS + 200]
    assert forward and all(abs(us - (1480 - 408)) < LATE_US for us in forward)
    still = [us for ms, us in left if ms > START_MS + 225]
    assert all(abs(us - 1500) < LATE_US for us in still)
    assert 48 <= len(still) <= 50
    assert 1150 < left[-1][0] - START_MS < 1230
    full = [us for ms, us in right if START_MS + 225 < ms < START_MS + 400]
    assert full and all(abs(us - (1480 - 510)) < LATE_US for us in full)
    still = [us for ms, us in right if ms > START_MS + 425]
    assert all(abs(us - 1480) < LATE_US for us in still)
    assert 48 <= len(still) <= 51
    gaps = [b[0] - a[0] for a, b in pairwise(left)]
    assert all(abs(gap - 20) < 0.1 for gap in gaps)


# -- the stop that an interrupt does

STOP_PIN = 19
STOP_US = 20.0


@pytest.mark.sampled("name")
@pytest.mark.parametrize("name", ["l298n", "two_wire"])
def test_the_interrupt_turns_the_pins_off_and_nothing_turns_them_on(name: str) -> None:
    text = "SI|LOOP(FOREVER);M(80, 80);M(-80, 80);END_LOOP"
    board = start_board(robot_with_driver(name), text, STOPS)
    board.set_level(START_MS + 50.123, STOP_PIN, True)
    board.press(500, 600)
    board.press(700, 800)
    board.run_for(850)
    off_levels = ("low",) * len(board.motor_pins())
    assert (
        board.motors(START_MS + 50) != off_levels
    )  # the left one turns round, and may be off just then
    stop_cycle = [cycle for cycle in board.list_motor_changes() if cycle < 790 * MS][-1] / MS
    assert 0 < (stop_cycle - START_MS - 50.123) * 1000 < STOP_US or stop_cycle < START_MS + 50.123
    for ms in (START_MS + 50.123 + STOP_US / 1000, START_MS + 51, 450, 650, 799):
        assert board.motors(ms) == off_levels
    assert board.list_motor_changes()[-1] > 800 * MS  # the button releases the latch


SWEPT_CYCLES = 3700
STOPPING = "SI|LOOP(FOREVER);M(80, 80);M(-80, 80);LAMP(TRUE);LAMP(FALSE);END_LOOP"


@pytest.mark.sampled("chip", "lamp", "stop_pin", "group")
@pytest.mark.parametrize(("chip", "lamp", "stop_pin", "group"), [
    ("uno", "12", 19, 1),
    ("mega", "16", 53, 0),  # a port with three motor pins, which no single instruction can change
])  # fmt: skip
def test_a_stop_at_any_cycle_stops(chip: str, lamp: str, stop_pin: int, group: int) -> None:
    """An interrupted instruction never turns on what the interrupt turned off."""
    wired_text = f'[board.actuators.LAMP]\ndriver = "digital"\npin = {lamp}\n\n[body]\n'
    changes = (("[board]\n", LAMP), ("bluetooth_state = 12", ""), ("[body]\n", wired_text))
    robot = on_board("tinibot", chip, *changes)
    bit = AVRS[chip].interrupt_by_pin[stop_pin].bit
    extra_code = STOPS.replace("PCINT1", f"PCINT{group}").replace("1 << 1", f"1 << {group}")
    extra_code = extra_code.replace("PCMSK1 = 1 << 5", f"PCMSK{group} = 1 << {bit}")
    board = start_board(robot, STOPPING, extra_code)
    board.sweep(1, SWEPT_CYCLES, STOP_US, stop_pin)  # before the program drives again
    board.run_for(START_MS + 2)
    edges = [cycle for cycle in board.edges(7) if cycle > (START_MS + 1) * MS]
    assert edges[2] - edges[0] < SWEPT_CYCLES, "not a whole turn of the program"
    assert len(board.copies) == SWEPT_CYCLES
    missed_copies = [number for number, copy in enumerate(board.copies) if not board.is_off(copy)]
    assert not missed_copies
