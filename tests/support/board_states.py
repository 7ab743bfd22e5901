"""The pins of each motor driver in each state of driving."""

from __future__ import annotations

import re

from tests.machines.board import HERTZ, MS, Board
from tests.support.edited_robots import TEXTS
from tiniscript.robots.profile import Robot
from tiniscript.robots.reader import read

STEADY_MS = 29.8  # ms after its release a button is surely up
PRESS_MS, START_MS = (
    100.0,
    200.0,
)  # ms: when the button goes down, and when it is certainly up again
FORWARD_MS, BACKWARD_MS, OFF_MS = 50.0, 150.0, 350.0  # ms after the start of MOVES
MOVES_PROGRAM = "SI|F(0.1, 80);B(0.1, 40);M(50, -100);W(0.1)"
TURN_MS = 250.0


def robot_with(motors: str) -> Robot:
    """The robot tinibot with other motors."""
    head, _, rest = TEXTS["tinibot"].partition("[board.motors]")
    text = f"{head}[board.motors]\n{motors}\n[board.sensors.LIGHT_R]"
    text += rest.partition("[board.sensors.LIGHT_R]")[2]
    return read(text, "test")


def bridge(driver: str, extra_toml: str = "") -> str:
    return (
        f'driver = "{driver}"\nleft_pwm = 5\nleft_forward = 7\nleft_backward = 8\n'
        f"right_pwm = 6\nright_forward = 9\nright_backward = 10\n{extra_toml}"
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


def robot_with_driver(name: str) -> Robot:
    return robot_with(DRIVERS[name][0])


def start_board(robot: Robot, text: str, extra_toml: str = "") -> Board:
    board = Board(robot, text, extra_toml)
    board.press(PRESS_MS, START_MS - STEADY_MS)
    return board


def on_board(name: str, chip: str, *changes: tuple[str, str]) -> Robot:
    """A shipped robot on another board, or wired in another way."""
    text = re.sub(r'^chip *= *"\w+"', f'chip = "{chip}"', TEXTS[name], flags=re.M)
    for old_text, new_text in changes:
        assert old_text in text
        text = text.replace(old_text, new_text, 1)
    return read(text, name)


def pulses(board: Board, pin: int) -> list[tuple[float, float]]:
    """Return the start of each pulse in ms, and its length in us."""
    edges = board.edges(pin)
    pairs = zip(edges[::2], edges[1::2], strict=False)
    return [(rise / MS, (down - rise) * 1e6 / HERTZ) for rise, down in pairs]


STOPS = """
#include <avr/interrupt.h>
#include "boards/motors.h"
// A change of A5 does what the link does when it sees a stop.
ISR(PCINT1_vect) { tiniscript::motors_stop(); }
__attribute__((constructor)) static void begin() { PCICR = 1 << 1; PCMSK1 = 1 << 5; }
"""
LAMP = '[[kit.actuators]]\nname = "LAMP"\nkind = "yes/no"\n\n[board]\n'
# Features that the shipped robots lack: a lamp that is on when its pin is low, a fan, a threshold
WORKSHOP = (
    ("[[kit.sensors]]", '[[kit.sensors]]\nname = "BRIGHT"\nkind = "yes/no"\n\n[[kit.sensors]]'),
    (
        "[board]\n",
        '[[kit.actuators]]\nname = "FAN"\nkind = "number"\nrange = [-30000, 30000]\n\n' + LAMP,
    ),
    ("bluetooth_state = 12", ""),
    ("right_forward = 9", "right_forward = 12"),
    (
        "[body]\n",
        '[board.actuators.FAN]\ndriver = "pwm"\npin = 9\n\n'
        '[board.actuators.LAMP]\ndriver = "digital"\npin = "A5"\nyes_is_low = true\n\n'
        '[board.sensors.BRIGHT]\ndriver = "threshold"\npin = "A2"\nthreshold = 600\n'
        "yes_is_low = true\n\n[body]\n",
    ),
)
