"""The effect of a stop on actuators on a simulated board, from the button to the pins."""

from __future__ import annotations

import pytest

from tests.machines.board import MS, Board
from tests.support.board_states import (
    START_MS,
    STEADY_MS,
    STOPS,
    WORKSHOP,
    on_board,
    pulses,
    start_board,
)
from tiniscript.robots.ports import AVRS
from tiniscript.robots.profile import Robot

GRIPPER, LED = 11, 30  # pins of grabber
HOLD_AT_STOP = ('at_stop = "release"', 'at_stop = "hold"')
WIRE = 53  # a pin of a Mega whose change is an interrupt
HANGING_HANDLER = "ISR(PCINT0_vect) { sei(); for (;;) {} }"


def grabber_robot(holds_position: bool = False) -> Robot:
    return on_board("grabber", "mega", *([HOLD_AT_STOP] if holds_position else []))


def busy(robot: Robot, text: str, extra_code: str = "") -> Board:
    board = start_board(robot, text, extra_code)
    board.watch(GRIPPER)
    board.watch(LED)
    return board


def interrupt(code: str) -> str:
    """Return code that replaces the interrupt of the stop wire."""
    bit = AVRS["mega"].interrupt_by_pin[WIRE].bit
    text = STOPS.replace("1 << 1", "1 << 0").replace("PCMSK1 = 1 << 5", f"PCMSK0 = 1 << {bit}")
    next_before = next(line for line in text.splitlines() if line.startswith("ISR"))
    return text.replace(next_before, code)


def pulses_from(board: Board, ms: float) -> int:
    return sum(at_ms > ms for at_ms, _ in pulses(board, GRIPPER))


@pytest.mark.sampled("holds_position")
@pytest.mark.parametrize("holds_position", [False, True])
def test_a_stop_turns_actuators_off(holds_position: bool) -> None:
    """A lamp in any case; a servo gets no more pulses, unless its profile says that it holds."""
    board = busy(grabber_robot(holds_position), "SI|GRIPPER(90);LED(TRUE);W(5)")
    board.press(START_MS + 105, START_MS + 300)
    board.run_for(START_MS + 280)
    assert board.pin(LED, START_MS + 104) == "high"
    assert board.pin(LED, START_MS + 106) == "low"
    assert pulses_from(board, START_MS) >= 5
    assert (pulses_from(board, START_MS + 106) >= 5) == holds_position
    assert all(abs(us - 1500) < 6 for _, us in pulses(board, GRIPPER)), "a pulse was cut"


def test_a_stopped_actuator_stays_off_until_a_program_sets_it() -> None:
    board = busy(grabber_robot(), "SI|W(0.1);GRIPPER(90);LED(TRUE);W(5)")
    board.press(START_MS + 150, START_MS + 200)
    board.press(START_MS + 300, START_MS + 400 - STEADY_MS)
    board.run_for(START_MS + 600)
    assert board.pin(LED, START_MS + 140) == "high"
    for ms in (152, 299, 399, 450, 498):
        assert board.pin(LED, START_MS + ms) == "low"
    assert board.pin(LED, START_MS + 505) == "high"
    times = [at_ms - START_MS for at_ms, _ in pulses(board, GRIPPER)]
    assert not [at_ms for at_ms in times if 151 < at_ms < 499]
    assert [at_ms for at_ms in times if at_ms > 500]


def test_a_program_that_is_being_stopped_sets_nothing() -> None:
    """The interrupt has turned the motors off, and the main loop does not know it yet."""
    stop = "ISR(PCINT0_vect) { tiniscript::motors_stop(); }"
    board = busy(grabber_robot(), "SI|LOOP(FOREVER);LED(TRUE);LED(FALSE);END_LOOP", interrupt(stop))
    board.set_level(START_MS + 50.123, WIRE, True)
    board.run_for(START_MS + 80)
    edges = [cycle / MS - START_MS for cycle in board.edges(LED)]
    assert [at_ms for at_ms in edges if at_ms < 50.1]
    assert not [at_ms for at_ms in edges if at_ms > 50.3]


@pytest.mark.sampled("holds_position")
@pytest.mark.parametrize("holds_position", [False, True])
def test_a_hanging_main_loop_turns_everything_off(holds_position: bool) -> None:
    """This includes outputs that a profile holds, because nothing controls them any more."""
    board = busy(
        grabber_robot(holds_position), "SI|GRIPPER(90);LED(TRUE);W(5)", interrupt(HANGING_HANDLER)
    )
    board.set_level(START_MS + 50, WIRE, True)
    board.run_for(START_MS + 170)
    assert board.pin(LED, START_MS + 140) == "high"
    assert board.pin(LED, START_MS + 160) == "low"
    assert pulses_from(board, START_MS + 60) >= 4
    assert pulses_from(board, START_MS + 160) == 0


def test_a_stop_turns_off_a_fan_and_an_active_low_lamp() -> None:
    board = start_board(on_board("tinibot", "uno", *WORKSHOP), "SI|FAN(80);LAMP(TRUE);W(5)")
    for pin in (9, 19):
        board.watch(pin)
    board.press(START_MS + 100, START_MS + 200)
    board.run_for(START_MS + 150)
    assert [board.pin(9, START_MS + ms) for ms in (90, 101)] == ["pwm 128", "low"]
    assert [board.pin(19, START_MS + ms) for ms in (90, 101)] == ["low", "high"]
