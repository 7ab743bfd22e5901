"""Motors on a shield with a 74HC595: the sketch's output as the shield reads it.

`tests/machines/shift_register.py` is the register; the wiring between each L293D and its motor is
here.
"""

from __future__ import annotations

import random
from typing import NamedTuple

import pytest

from tests.machines.board import CONTROLS, HERTZ, MS, PORTS, Board
from tests.machines.shift_register import HOLD_NS, ShiftRegister, WrongTiming
from tests.support.board_states import (
    BACKWARD_MS,
    FORWARD_MS,
    MOVES_PROGRAM,
    OFF_MS,
    START_MS,
    STOPS,
    TURN_MS,
    start_board,
)
from tiniscript.robots.profile import ProfileRefused, Robot
from tiniscript.robots.reader import read
from tiniscript.robots.refusals import describe

NS = 1e9 / HERTZ  # nanoseconds in a cycle
# From the schematic of Adafruit's shield: outputs wired to each half L293D, and its PWM.
MOTORS = {"M1": (2, 3, 11), "M2": (1, 4, 3), "M3": (5, 7, 6), "M4": (0, 6, 5)}
WIRES = {"latch": 12, "enable": 7, "data": 8, "clock": 4}
SIDES = {"two": ("M3", "M4"), "four": ("M1 M2", "M3 M4"), "crossed": ("M2 M4", "M1 M3")}


def profile(left: str, right: str, chip: str = "uno") -> str:
    """Return a robot with little besides the shield: no buzzer uses a timer."""
    return f"""
[kit]
speed = 45
[[kit.sensors]]
name = "LIGHT"
kind = "number"
range = [0, 1023]
[board]
chip = "{chip}"
baud = 9600
start_button = 2
[board.motors]
driver = "hw130"
left = "{left}"
right = "{right}"
[board.sensors.LIGHT]
driver = "analog"
pin = "A0"
[body]
wheel_base_cm = 13.5
length_cm = 21
width_cm = 15
"""


ARM = """[[kit.actuators]]
name = "ARM"
kind = "number"
range = [0, 180]
"""
WIRED_ARM = """[board.actuators.ARM]
driver = "servo"
pin = 9
"""


def shield(left: str, right: str, chip: str = "uno") -> Robot:
    return read(profile(left, right, chip), "shield")


class Seen(NamedTuple):
    """The state of the motors from a cycle on: `M1` forward with 204 is `{"M1": 204}`."""

    cycle: int
    powers: dict[str, int]


def motor_states(board: Board) -> list[Seen]:
    """Play all writes into a shift register and L293Ds; return the motors' actions, in order.

    A motor whose PWM is on while its two inputs are not known is a motor that nobody controls.
    """
    register = ShiftRegister()
    states: list[Seen] = []
    values: dict[int, int] = {}
    for change in board.changes:
        values[change.address] = change.value
        for name, pin in WIRES.items():
            port, bit = board.bit(pin)
            if change.address == PORTS[port]:
                register.change(change.cycle * NS, name, bool(change.value >> bit & 1))
        powers = {}
        for motor, (forward, backward, pin) in MOTORS.items():
            level = level_of(board, pin, values)
            if level == 0:
                continue
            bits = register.outputs
            assert bits is not None, f"{motor} has power, and no direction"
            way = (bits >> forward & 1) - (bits >> backward & 1)
            powers[motor] = way * level
        if not states or states[-1].powers != powers:
            states.append(Seen(change.cycle, powers))
    return states


def level_of(board: Board, pin: int, values: dict[int, int]) -> int:
    """Return the level of a PWM pin; 255 if it is constantly high."""
    timer, channel = board.avr.compare_by_pin[pin]
    connection = {"a": 0x80, "b": 0x20, "c": 0x08}[channel]
    if values.get(CONTROLS[timer], 0) & connection:
        return values.get(board.compare_address(pin), 0)
    port, bit = board.bit(pin)
    return 255 * (values.get(PORTS[port], 0) >> bit & 1)


def powers_at(states: list[Seen], ms: float) -> dict[str, int]:
    return [state.powers for state in states if state.cycle <= ms * MS][-1]


def both(sides: tuple[str, str], left: int, right: int) -> dict[str, int]:
    powers = dict.fromkeys(sides[0].split(), left)
    return {**powers, **dict.fromkeys(sides[1].split(), right)}


@pytest.mark.sampled("name", "chip")
@pytest.mark.parametrize("chip", ["uno", "mega"])
@pytest.mark.parametrize("name", SIDES)
def test_both_motors_of_a_side_run_alike(name: str, chip: str) -> None:
    sides = SIDES[name]
    board = start_board(shield(*sides, chip), MOVES_PROGRAM).run_for(START_MS + OFF_MS + 50)
    states = motor_states(board)
    assert powers_at(states, START_MS - 1) == {}
    assert powers_at(states, START_MS + FORWARD_MS) == both(sides, 204, 204)
    assert powers_at(states, START_MS + BACKWARD_MS) == both(sides, -102, -102)
    assert powers_at(states, START_MS + TURN_MS) == both(sides, 127, -255)
    assert powers_at(states, START_MS + OFF_MS) == {}
    assert board.quiet_us < 40  # half the time of two bytes at 115,200 baud


@pytest.mark.sampled("seed", keep=2)
@pytest.mark.parametrize("seed", range(8))
def test_no_motor_turns_against_its_side(seed: int) -> None:
    """This holds for any program: in between, a motor is only off, or has one of the two powers."""
    rng = random.Random(seed)
    moves = [(rng.choice([-80, -40, 0, 40, 80]), rng.choice([-80, -40, 0, 40, 80]))
             for _ in range(12)]  # fmt: skip
    text = "SI|" + ";".join(f"M({left}, {right});W(0.02)" for left, right in moves)
    sides = SIDES["crossed"]
    states = motor_states(start_board(shield(*sides), text).run_for(START_MS + 300))
    left_of = set(sides[0].split())
    previous = (0, 0)
    for number, (left, right) in enumerate(moves):
        begin_ms, end_ms = START_MS + 20 * number, START_MS + 20 * (number + 1)
        levels = [int(percent * 2.55) for percent in (left, right)]
        steady = powers_at(states, end_ms - 1)
        assert steady == {m: p for m, p in both(sides, *levels).items() if p}
        for state in states:
            if not begin_ms - 1 < state.cycle / MS < end_ms - 1:
                continue
            for motor, power in state.powers.items():
                side = 0 if motor in left_of else 1
                assert power in (levels[side], int(previous[side] * 2.55))
        previous = (left, right)


@pytest.mark.sampled("chip")
@pytest.mark.parametrize("chip", ["uno", "mega"])
def test_nothing_moves_before_the_button_nor_after_a_stop(chip: str) -> None:
    robot = shield(*SIDES["four"], chip)
    extra_code = STOPS if chip == "uno" else ""
    board = start_board(robot, "SI|LOOP(FOREVER);M(80, 80);M(-80, 80);END_LOOP", extra_code)
    if chip == "uno":
        board.set_level(START_MS + 50.123, 19, True)
    board.press(400, 450)
    board.run_for(430)
    states = motor_states(board)
    assert all(state.cycle >= (START_MS - 1) * MS for state in states if state.powers)
    stop_ms = START_MS + 50.123 + 0.02 if chip == "uno" else 402
    assert all(state.cycle < stop_ms * MS for state in states if state.powers)
    enable = board.edges(WIRES["enable"])
    assert enable[0] < 100, "its outputs are off before a program drives"


@pytest.mark.parametrize(("changes", "message"), [
    ([(0, "data", True), (20, "clock", True)], "data before the clock"),
    ([(0, "data", True), (0, "clock", True)], "data before the clock"),
    ([(0, "clock", True), (HOLD_NS - 1, "data", True)], "data after the clock"),
    ([(0, "clock", True), (10, "clock", False)], "a pulse of the clock"),
    ([(0, "clock", True), (50, "clock", False), (60, "clock", True)], "a pulse of the clock"),
    ([(0, "clock", True), (10, "latch", True)], "the clock before the latch"),
    ([(0, "latch", True), (10, "latch", False)], "a pulse of the latch"),
])  # fmt: skip
def test_the_simulated_register_refuses_wrong_timing(
    changes: list[tuple[float, str, bool]], message: str
) -> None:
    register = ShiftRegister()
    with pytest.raises(WrongTiming, match=message):
        for ns, name, is_high in changes:
            register.change(ns, name, is_high)


def test_the_simulated_register_shows_eight_bits_at_its_latch_only() -> None:
    register = ShiftRegister()
    ns = 0.0
    for bit in (1, 0, 1, 0, 0, 1, 1, 0):
        for name, is_high in (("data", bool(bit)), ("clock", True), ("clock", False)):
            ns += 100
            register.change(ns, name, is_high)
    assert register.outputs is None
    register.change(ns + 100, "latch", True)
    assert register.outputs == 0b10100110
    register.change(ns + 200, "enable", True)
    assert register.outputs is None


def messages_of(robot: str) -> list[str]:
    with pytest.raises(ProfileRefused) as exception_info:
        read(robot, "test")
    return describe(exception_info.value, "en")


def test_devices_that_take_the_shields_pins_are_named() -> None:
    """A buzzer takes the timer of M1 and M2, on a Mega a servo that of M1."""
    four = profile(*SIDES["four"])
    assert read(four, "test").board.buzzer is None
    beeping = four.replace("start_button = 2", 'start_button = 2\nbuzzer = "A5"')
    assert messages_of(beeping) == [
        f"board.motors.left: the speed of {motor} is the PWM of pin {pin}, which needs timer 2,"
        " but board.buzzer already uses that timer. Leave one of the two out."
        for motor, pin in (("M1", 11), ("M2", 3))
    ]
    assert read(beeping.replace("M1 M2", "M3").replace("M3 M4", "M4"), "test").board.buzzer == 19
    servo = four.replace("[board]", ARM + "[board]").replace("[body]", WIRED_ARM + "[body]")
    assert read(servo, "test").board.actuators[0].pins == {"pin": 9}, "where the shield has it"
    assert messages_of(servo.replace('"uno"', '"mega"')) == [
        "board.motors.left: the speed of M1 is the PWM of pin 11, which needs timer 1,"
        " but board.actuators.ARM.pin already uses that timer. Leave one of the two out."
    ]
    assert messages_of(four.replace("start_button = 2", "start_button = 12")) == [
        "board.motors.driver: the shield uses pin 12 for LATCH, but board.start_button already"
        " uses it. Use another pin for board.start_button, or another motor of the shield."
    ]
    assert messages_of(four.replace("M3 M4", "M2 M4")) == [
        "board.motors.right: the shield uses pin 3 for M2, but board.motors.left already uses it."
        " Use another pin for board.motors.left, or another motor of the shield."
    ]
    assert messages_of(servo.replace("pin = 9", "pin = 4"))[0].startswith(
        "board.actuators.ARM.pin is pin 4, which board.motors.driver already uses."
    )
    for chip in ("esp32dev", "esp32c3"):
        text = four.replace('"uno"', f'"{chip}"').replace('"A0"', "3" if chip[-1] == "3" else "34")
        assert [text.partition(",")[0] for text in messages_of(text)] == [
            "board.motors.driver is a shield for boards with the pins of an Uno"
        ]
