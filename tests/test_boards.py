"""What the sketch does with the pins of a board: seen on a simulated one, to the cycle."""

from __future__ import annotations

from itertools import pairwise

import pytest

from tests.machines import board as boards
from tests.machines.board import HERTZ, MS, Board
from tests.test_robots import TEXTS
from tiniscript import robots
from tiniscript.robots.profile import Robot
from tiniscript.robots.reader import read

pytestmark = pytest.mark.skipif(bool(boards.missing()), reason=boards.missing() or "there is one")

PRESS, START = 100.0, 200.0  # ms: when the button goes down, and up
FORWARD, BACK, OFF = 50.0, 150.0, 350.0  # ms after the start of MOVES
MOVES = "SI|F(0.1, 80);B(0.1, 40);M(50, -100);W(0.1)"
TURN = 250.0


def robot_with(motors: str, chip: str = "uno") -> Robot:
    """The robot tinibot with other motors."""
    head, _, rest = TEXTS["tinibot"].partition("[board.motors]")
    text = f"{head}[board.motors]\n{motors}\n[board.sensors.LIGHT_R]"
    text += rest.partition("[board.sensors.LIGHT_R]")[2]
    return read(text.replace('chip = "uno"', f'chip = "{chip}"'), "test")


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
DRIVERS = {
    "l298n": (bridge("l298n"), BRIDGE_STATES),
    "l293d": (bridge("l293d"), BRIDGE_STATES),
    "tb6612": (
        bridge("tb6612", "standby = 12\n").replace("bluetooth", ""),
        tuple((*state, "low" if state[0] == "low" else "high") for state in BRIDGE_STATES),
    ),
    "two_wire": (TWO_WIRE, TWO_WIRE_STATES),
}


def driven(name: str) -> Robot:
    motors, _ = DRIVERS[name]
    if name == "tb6612":
        motors = motors.replace("standby = 12", 'standby = "A5"')
    return robot_with(motors)


def started(robot: Robot, text: str, more: str = "") -> Board:
    board = Board(robot, text, more)
    board.press(PRESS, START)
    return board


@pytest.mark.parametrize("name", sorted(DRIVERS))
def test_states_of_the_motor_pins(name: str) -> None:
    board = started(driven(name), MOVES).ran(START + OFF + 50)
    states = tuple(board.motors(START + ms) for ms in (FORWARD, BACK, TURN, OFF))
    assert states == DRIVERS[name][1]
    assert board.motors(START - 1) == states[-1]


@pytest.mark.parametrize("name", sorted(robots.names()))
def test_shipped_robots_drive(name: str) -> None:
    """On the Arduino of the profile: a Nano, a Mega with its other ports."""
    board = started(robots.load(name), MOVES).ran(START + OFF + 50)
    standby = 1 if name == "liner" else 0
    for ms, state in zip((FORWARD, BACK, TURN, OFF), BRIDGE_STATES, strict=True):
        last = ("low" if ms == OFF else "high",) * standby
        assert board.motors(START + ms) == (*state, *last)


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


def test_a_spike_on_the_button_starts_nothing() -> None:
    board = Board(robots.load("tinibot"), MOVES)
    board.press(100, 101)
    assert board.ran(300).moved() == []


def test_the_press_that_stops_does_not_start() -> None:
    board = started(robots.load("tinibot"), "SI|LOOP(FOREVER);F(1, 80);END_LOOP")
    board.press(500, 600)
    board.press(900, 1000)
    board.ran(1100)
    assert board.motors(499)[0] == "pwm 204"
    for ms in (500.5, 599, 650, 899, 999):
        assert board.motors(ms) == ("low",) * 6
    assert board.motors(1001)[0] == "pwm 204"


# -- servos that turn without end


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
    assert forward and all(abs(us - (1500 + 408)) < 3 for us in forward)
    forward = [us for ms, us in right if START + 25 < ms < START + 200]
    assert forward and all(abs(us - (1480 - 408)) < 3 for us in forward)
    still = [us for ms, us in left if ms > START + 225]
    assert all(abs(us - 1500) < 3 for us in still)
    assert 48 <= len(still) <= 50
    assert 1150 < left[-1][0] - START < 1230
    full = [us for ms, us in right if START + 225 < ms < START + 400]
    assert full and all(abs(us - (1480 - 510)) < 3 for us in full)
    still = [us for ms, us in right if ms > START + 425]
    assert all(abs(us - 1480) < 3 for us in still)
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


@pytest.mark.parametrize("name", ["l298n", "two_wire"])
def test_the_interrupt_turns_the_pins_off_and_nothing_turns_them_on(name: str) -> None:
    text = "SI|LOOP(FOREVER);M(80, 80);M(-80, 80);END_LOOP"
    board = started(driven(name), text, STOPS)
    board.level(START + 50.123, STOP_PIN, True)
    board.press(500, 600)
    board.press(700, 800)
    board.ran(850)
    assert board.motors(START + 50)[0] != "low" or board.motors(START + 50)[1] != "low"
    stopped = [cycle for cycle in board.moved() if cycle < 790 * MS][-1] / MS
    assert 0 < (stopped - START - 50.123) * 1000 < STOP_US or stopped < START + 50.123
    off = ("low",) * len(board.motor_pins())
    for ms in (START + 50.123 + STOP_US / 1000, START + 51, 450, 650, 799):
        assert board.motors(ms) == off
    assert board.moved()[-1] > 800 * MS  # the button releases the latch


# -- sensors


def shown_as_power(reading: str) -> str:
    """A program that shows a reading as the power of a motor: PWM of 2.55 for each percent."""
    return f"SI|M({reading}, 0);W(5)"


@pytest.mark.parametrize("distance_cm", [3, 20, 50, 99])
@pytest.mark.parametrize("name", ["tinibot", "grabber"])
def test_an_echo_is_a_distance(name: str, distance_cm: int) -> None:
    robot = robots.load(name)
    board = started(robot, shown_as_power("DISTANCE"))
    at = [each.driver for each in robot.board.sensors].index("hc_sr04")
    pins = robot.board.sensors[at].pins
    board.echoes(pins["trigger"], pins["echo"], [distance_cm * 2 / 0.0343])
    board.ran(START + 60)
    assert board.motors(START + 55)[0] == f"pwm {distance_cm * 653 >> 8}"


@pytest.mark.parametrize("width_us", [0, 38_000])
def test_no_echo_is_far_away_and_takes_25_ms(width_us: int) -> None:
    """The second reading waits until the sensor has lowered its echo."""
    robot = robots.load("tinibot")
    text = "SI|IF(DISTANCE = 400);M(10, 0);ENDIF;IF(DISTANCE < 400);M(20, 0);ENDIF;W(5)"
    board = started(robot, text)
    pins = robot.board.sensors[2].pins
    board.echoes(pins["trigger"], pins["echo"], [width_us, 50 * 2 / 0.0343])
    board.ran(START + 100)
    level = f"pwm {10 * 653 >> 8}"
    assert board.motors(START + 24)[0] == "low"
    assert board.motors(START + 27)[0] == level
    assert board.motors(START + 99)[0] == f"pwm {20 * 653 >> 8}"


def test_a_long_trigger() -> None:
    """A sensor wants 10 us, and the loop does not wait for it."""
    robot = robots.load("tinibot")
    trigger = robot.board.sensors[2].pins["trigger"]
    board = started(robot, shown_as_power("DISTANCE"))
    board.watch(trigger)
    board.ran(START + 20)
    rose, fell = board.edges(trigger)
    assert 10 <= (fell - rose) * 1e6 / HERTZ < 200


@pytest.mark.parametrize(("name", "reading", "channel", "millivolts", "power"), [
    ("tinibot", "LIGHT_R / 20", 0, 2500, 511 / 20),
    ("tinibot", "LIGHT_L / 20", 1, 5000, 1023 / 20),
    ("grabber", "TEMPERATURE", 0, 750, 25),
    ("grabber", "TEMPERATURE", 0, 5000, 100),
    ("liner", "BATTERY * 10", 7, 3700, 74),
])  # fmt: skip
def test_a_voltage_is_a_reading(
    name: str, reading: str, channel: int, millivolts: int, power: float
) -> None:
    board = started(robots.load(name), shown_as_power(reading))
    board.analog(channel, millivolts)
    board.ran(START + 10)
    shown = int(board.motors(START + 9)[0].removeprefix("pwm "))
    assert abs(shown - power * 2.55) < 3


@pytest.mark.parametrize(("name", "sensor", "pin", "is_high", "is_true"), [
    ("liner", "LINE_L", 15, True, True),
    ("liner", "LINE_R", 16, False, False),
    ("liner", "BUTTON", 12, True, False),
    ("liner", "BUTTON", 12, False, True),
    ("grabber", "BUTTON", 28, False, True),
])  # fmt: skip
def test_a_level_is_yes_or_no(
    name: str, sensor: str, pin: int, is_high: bool, is_true: bool
) -> None:
    text = f"SI|IF({sensor});M(20, 0);ELSE;M(10, 0);ENDIF;W(5)"
    board = started(robots.load(name), text)
    board.level(0, pin, is_high)
    board.ran(START + 5)
    assert board.motors(START + 4)[0] == f"pwm {(20 if is_true else 10) * 653 >> 8}"


# -- what a robot has besides


@pytest.mark.parametrize("hertz", [31, 100, 440, 880, 3000, 12345, 19800, 20000])
@pytest.mark.parametrize("name", ["tinibot", "grabber"])
def test_a_beep_has_its_frequency_and_its_length(name: str, hertz: int) -> None:
    robot = robots.load(name)
    board = started(robot, f"SI|BEEP(0.3, {hertz})")
    board.watch(robot.board.buzzer)
    board.ran(START + 290)
    edges = board.edges(robot.board.buzzer)
    periods = (len(edges) - 1) // 2
    found = HERTZ * periods / (edges[2 * periods] - edges[0])
    assert abs(found / hertz - 1) < 0.01


def test_a_program_that_has_ended_plays_its_tune() -> None:
    robot = robots.load("tinibot")
    board = started(robot, "SI|F(0.1, 50)")
    board.watch(robot.board.buzzer)
    board.ran(START + 500)
    edges = [cycle / MS - START for cycle in board.edges(robot.board.buzzer)]
    assert 99 < edges[0] < 102
    assert 338 < edges[-1] < 342
    halves = [b - a for a, b in pairwise(edges)]
    assert halves[0] > 1.3 * halves[-2]


def test_the_light_is_on_while_a_program_could_start() -> None:
    robot = robots.load("tinibot")
    light = robot.board.status_led
    assert light is not None
    board = started(robot, "SI|W(0.2)")
    board.watch(light)
    board.ran(START + 300)
    assert [board.pin(light, START + ms) for ms in (-50, 100, 250)] == ["high", "low", "high"]


def test_a_servo_and_a_lamp() -> None:
    robot = robots.load("grabber")
    board = started(
        robot, "SI|GRIPPER(0);LED(TRUE);W(0.1);GRIPPER(90);W(0.1);GRIPPER(9 * 9 * 9);W(0.1)"
    )
    for pin in (11, 30):
        board.watch(pin)
    board.ran(START + 320)
    found = pulses(board, 11)
    assert found[0][0] > START
    for after, us in ((25, 600), (125, 1500), (225, 2400)):
        each = [length for ms, length in found if START + after < ms < START + after + 70]
        assert each and all(abs(length - us) < 3 for length in each)
    assert board.pin(30, START + 50) == "high"
