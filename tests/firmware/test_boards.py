"""What the sketch does with the pins of a board: seen on a simulated one, to the cycle."""

from __future__ import annotations

import re
from itertools import pairwise

import pytest

from tests.machines.board import HERTZ, MS, Board
from tests.robots.test_robots import TEXTS
from tiniscript import robots
from tiniscript.robots.ports import AVRS
from tiniscript.robots.profile import Robot
from tiniscript.robots.reader import read

STEADY = 29.8  # ms after its release a button is surely up
PRESS, START = 100.0, 200.0  # ms: when the button goes down, and when it is surely up again
FORWARD, BACK, OFF = 50.0, 150.0, 350.0  # ms after the start of MOVES
MOVES = "SI|F(0.1, 80);B(0.1, 40);M(50, -100);W(0.1)"
TURN = 250.0


def robot_with(motors: str) -> Robot:
    """The robot tinibot with other motors."""
    head, _, rest = TEXTS["tinibot"].partition("[board.motors]")
    text = f"{head}[board.motors]\n{motors}\n[board.sensors.LIGHT_R]"
    text += rest.partition("[board.sensors.LIGHT_R]")[2]
    return read(text, "test")


def bridge(driver: str, more: str = "") -> str:
    return (
        f'driver = "{driver}"\nleft_pwm = 5\nleft_forward = 7\nleft_backward = 8\n'
        f"right_pwm = 6\nright_forward = 9\nright_backward = 10\n{more}"
    )


TWO_WIRE = (
    'driver = "two_wire"\nleft_forward = 5\nleft_backward = 6\n'
    "right_forward = 9\nright_backward = 10\n"
)
SERVOS = 'driver = "servos"\nleft_pin = 9\nright_pin = 6\nright_still_us = 1480\n'

# The pins in the order of the profile: forward with 80 %, back with 40 %, M(50, -100), off.
BRIDGE_STATES = (
    ("pwm 204", "high", "low", "pwm 204", "high", "low"),
    ("pwm 102", "low", "high", "pwm 102", "low", "high"),
    ("pwm 127", "high", "low", "pwm 255", "low", "high"),
    ("low",) * 6,
)
TWO_WIRE_STATES = (
    ("pwm 204", "low", "pwm 204", "low"),
    ("low", "pwm 102", "low", "pwm 102"),
    ("pwm 127", "low", "low", "pwm 255"),
    ("low",) * 4,
)
# One direction pin for each motor, and the board makes the other.
ONE_DIRECTION = (
    'driver = "pwm_dir"\nleft_pwm = 5\nleft_forward = 7\nright_pwm = 6\nright_forward = 9\n'
    'standby = "A5"\n'
)
ONE_DIRECTION_STATES = tuple(
    (*(state[k] for k in (0, 1, 3, 4)), "low" if state[0] == "low" else "high")
    for state in BRIDGE_STATES
)
DRIVERS = {
    "l298n": (bridge("l298n"), BRIDGE_STATES),
    "l293d": (bridge("l293d"), BRIDGE_STATES),
    "tb6612": (
        bridge("tb6612", 'standby = "A5"\n'),
        tuple((*state, "low" if state[0] == "low" else "high") for state in BRIDGE_STATES),
    ),
    "two_wire": (TWO_WIRE, TWO_WIRE_STATES),
    "pwm_dir": (ONE_DIRECTION, ONE_DIRECTION_STATES),
}


def driven(name: str) -> Robot:
    return robot_with(DRIVERS[name][0])


def started(robot: Robot, text: str, more: str = "") -> Board:
    board = Board(robot, text, more)
    board.press(PRESS, START - STEADY)
    return board


@pytest.mark.sampled("name", keep=2)
@pytest.mark.parametrize("name", sorted(DRIVERS))
def test_states_of_the_motor_pins(name: str) -> None:
    board = started(driven(name), MOVES).ran(START + OFF + 50)
    states = tuple(board.motors(START + ms) for ms in (FORWARD, BACK, TURN, OFF))
    assert states == DRIVERS[name][1]
    assert board.motors(START - 1) == states[-1]


@pytest.mark.parametrize(("powers", "pin"), [("80, 0", 0), ("0, 80", 3)])
def test_one_motor_drives_alone(powers: str, pin: int) -> None:
    board = started(driven("tb6612"), f"SI|M({powers});W(1)").ran(START + 60)
    state = board.motors(START + 50)
    assert (state[pin], state[-1]) == ("pwm 204", "high")


def on_board(name: str, chip: str, *changes: tuple[str, str]) -> Robot:
    """A shipped robot on another board, or wired in another way."""
    text = re.sub(r'^chip *= *"\w+"', f'chip = "{chip}"', TEXTS[name], flags=re.M)
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    return read(text, name)


@pytest.mark.sampled("chip")
@pytest.mark.parametrize(("name", "chip"), [
    ("tinibot", "uno"), ("tinibot", "nano"), ("tinibot", "mega"),
    ("liner", "nano"), ("liner", "mega"), ("grabber", "mega"),
    ("elegoo4", "uno"), ("elegoo4", "nano"), ("elegoo4", "mega"), ("sumo", "uno"),
])  # fmt: skip
def test_shipped_robots_drive(name: str, chip: str) -> None:
    robot = on_board(name, chip)
    board = started(robot, MOVES).ran(START + OFF + 50)
    states = DRIVERS[robot.board.motors.driver][1]
    assert tuple(board.motors(START + ms) for ms in (FORWARD, BACK, TURN, OFF)) == states


@pytest.mark.sampled("name", keep=2)
@pytest.mark.parametrize("name", ["servos", *sorted(DRIVERS)])
def test_nothing_moves_before_the_button(name: str) -> None:
    """Motor pins are low within a few cycles of the reset, and stay it; a press alone is not it."""
    robot = robot_with(SERVOS) if name == "servos" else driven(name)
    board = Board(robot, MOVES)
    board.level(PRESS, robot.board.start_button, False)
    board.ran(400)
    assert board.moved() == []
    assert board.motors(60 / MS) == ("low",) * len(board.motor_pins())


def test_a_button_that_is_down_after_a_reset_starts_nothing() -> None:
    board = Board(robots.load("tinibot"), MOVES)
    board.press(0, 150)
    assert board.ran(300).moved() == []


# -- servos that turn without end

LATE_US = 6  # a pulse ends when no other interrupt is at work


def pulses(board: Board, pin: int) -> list[tuple[float, float]]:
    """Return when each pulse began, in ms, and its length in us."""
    edges = board.edges(pin)
    pairs = zip(edges[::2], edges[1::2], strict=False)
    return [(up / MS, (down - up) * 1e6 / HERTZ) for up, down in pairs]


def test_servos_turn_and_stand_for_a_second() -> None:
    board = started(robot_with(SERVOS), "SI|F(0.2, 80);M(0, 100);W(0.2)").ran(START + 2000)
    left, right = (pulses(board, pin) for pin in board.motor_pins())
    assert left[0][0] >= START and right[0][0] >= START
    forward = [us for ms, us in left if START + 25 < ms < START + 200]
    assert forward and all(abs(us - (1500 + 408)) < LATE_US for us in forward)
    forward = [us for ms, us in right if START + 25 < ms < START + 200]
    assert forward and all(abs(us - (1480 - 408)) < LATE_US for us in forward)
    still = [us for ms, us in left if ms > START + 225]
    assert all(abs(us - 1500) < LATE_US for us in still)
    assert 48 <= len(still) <= 50
    assert 1150 < left[-1][0] - START < 1230
    full = [us for ms, us in right if START + 225 < ms < START + 400]
    assert full and all(abs(us - (1480 - 510)) < LATE_US for us in full)
    still = [us for ms, us in right if ms > START + 425]
    assert all(abs(us - 1480) < LATE_US for us in still)
    assert 48 <= len(still) <= 51
    gaps = [b[0] - a[0] for a, b in pairwise(left)]
    assert all(abs(gap - 20) < 0.1 for gap in gaps)


# -- the stop that an interrupt does

STOPS = """
#include <avr/interrupt.h>
#include "boards/motors.h"
// A change of A5 does what the link does when it sees a stop.
ISR(PCINT1_vect) { tiniscript::motors_stop(); }
__attribute__((constructor)) static void begin() { PCICR = 1 << 1; PCMSK1 = 1 << 5; }
"""
STOP_PIN = 19
STOP_US = 20.0


@pytest.mark.sampled("name")
@pytest.mark.parametrize("name", ["l298n", "two_wire"])
def test_the_interrupt_turns_the_pins_off_and_nothing_turns_them_on(name: str) -> None:
    text = "SI|LOOP(FOREVER);M(80, 80);M(-80, 80);END_LOOP"
    board = started(driven(name), text, STOPS)
    board.level(START + 50.123, STOP_PIN, True)
    board.press(500, 600)
    board.press(700, 800)
    board.ran(850)
    off = ("low",) * len(board.motor_pins())
    assert board.motors(START + 50) != off  # the left one turns round, and may be off just then
    stopped = [cycle for cycle in board.moved() if cycle < 790 * MS][-1] / MS
    assert 0 < (stopped - START - 50.123) * 1000 < STOP_US or stopped < START + 50.123
    for ms in (START + 50.123 + STOP_US / 1000, START + 51, 450, 650, 799):
        assert board.motors(ms) == off
    assert board.moved()[-1] > 800 * MS  # the button releases the latch


SWEPT_CYCLES = 3700
STOPPING = "SI|LOOP(FOREVER);M(80, 80);M(-80, 80);LAMP(TRUE);LAMP(FALSE);END_LOOP"
LAMP = '[[kit.actuators]]\nname = "LAMP"\nkind = "yes/no"\n\n[board]\n'


@pytest.mark.sampled("chip", "lamp", "stop_pin", "group")
@pytest.mark.parametrize(("chip", "lamp", "stop_pin", "group"), [
    ("uno", "12", 19, 1),
    ("mega", "16", 53, 0),  # on the port of three motor pins, which no single instruction changes
])  # fmt: skip
def test_a_stop_at_any_cycle_stops(chip: str, lamp: str, stop_pin: int, group: int) -> None:
    """Nothing that the interrupt has turned off is turned on by what it came in between."""
    wired = f'[board.actuators.LAMP]\ndriver = "digital"\npin = {lamp}\n\n[body]\n'
    changes = (("[board]\n", LAMP), ("bluetooth_state = 12", ""), ("[body]\n", wired))
    robot = on_board("tinibot", chip, *changes)
    bit = AVRS[chip].interrupt_by_pin[stop_pin].bit
    more = STOPS.replace("PCINT1", f"PCINT{group}").replace("1 << 1", f"1 << {group}")
    more = more.replace("PCMSK1 = 1 << 5", f"PCMSK{group} = 1 << {bit}")
    board = started(robot, STOPPING, more)
    board.sweep(1, SWEPT_CYCLES, STOP_US, stop_pin)  # before the program drives again
    board.ran(START + 2)
    edges = [cycle for cycle in board.edges(7) if cycle > (START + 1) * MS]
    assert edges[2] - edges[0] < SWEPT_CYCLES, "not a whole turn of the program"
    assert len(board.copies) == SWEPT_CYCLES
    missed = [number for number, copy in enumerate(board.copies) if not board.is_off(copy)]
    assert not missed
