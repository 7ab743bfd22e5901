"""The supply of the simulated Uno and Mega: the firmware measures it before it saves."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import pytest

from tests.machines.wired import Wired
from tests.support.board_builds import BOARDS
from tests.support.robot_on_uno import NAMES, computer, read_saved_state, send
from tiniscript.link.messages import SAVED_LOW_SUPPLY, SAVED_STORED
from tiniscript.link.requests import OK
from tools.uno import CYCLES_PER_MS, Uno

LOW, STORED = SAVED_LOW_SUPPLY, SAVED_STORED
SAVES = "SI|SHOW(1)"


def wait_until_saved(wired_uno: Wired, limit_ms: int = 4000) -> int:
    """Return the storage state of the program, once it is decided."""
    end_ms = wired_uno.now_ms + limit_ms
    while wired_uno.now_ms < end_ms:
        saved_count = read_saved_state(wired_uno)
        if saved_count in (LOW, STORED):
            return saved_count
        wired_uno.run(20)
    raise AssertionError("still saving")


@BOARDS
@pytest.mark.parametrize(
    ("volts", "millivolts"), [(5, STORED), (4.05, STORED), (3.95, LOW), (3, LOW)]
)
def test_saving_works_from_four_volts_on(robot: Uno, volts: float, millivolts: int) -> None:
    wired_uno = computer(robot)
    robot.set_supply(volts)
    send(wired_uno, SAVES)
    assert wait_until_saved(wired_uno) == millivolts


def marks(uno: Uno, since_cycle: int) -> list[int]:
    """Return the times at which validating bytes of the program's first slots were written."""
    places = (129, 130, 131, 577, 578, 579)
    return [
        event.cycle
        for event in uno.events
        if event.kind == "eeprom" and event["address"] in places and event["value"] not in (0, 255)
        if event.cycle >= since_cycle
    ]


def test_a_supply_drop_between_two_checks_is_noticed(uno: Uno) -> None:
    """The voltage is measured before each of the three."""
    wired_uno = computer(uno)
    start_cycle = uno.cycle
    send(wired_uno, SAVES)
    while len(marks(uno, start_cycle)) < 1:
        wired_uno.run(1)
    uno.set_supply(3.5)
    assert wait_until_saved(wired_uno) == LOW
    wired_uno.run(1500)
    assert len(marks(uno, start_cycle)) == 1
    uno.set_supply(4.5)
    wired_uno.run(1500)
    assert read_saved_state(wired_uno) == STORED
    assert len(marks(uno, start_cycle)) == 3


LIGHT = "SI|LOOP(FOREVER);SHOW(LIGHT_L);SHOW(LIGHT_R);END_LOOP"


@pytest.mark.parametrize("volts", [5.0, 3.5])
def test_sensors_and_the_supply_take_turns(uno: Uno, volts: float) -> None:
    """A program that reads two analog sensors all the time reads them right, and is saved."""
    uno.set_analog("A0", 200)
    uno.set_analog("A1", 800)
    wired_uno = computer(uno)
    uno.set_supply(volts)
    send(wired_uno, LIGHT)
    shown_values: list[int] = []
    for _ in range(150):
        wired_uno.run(10)
        shown_values += [event.value for event in wired_uno.session.events()
                  if event.name == "SHOW"]  # fmt: skip
    assert len(shown_values) > 50
    assert set(shown_values) == {200_000, 800_000}
    assert all(first != second for first, second in pairwise(shown_values))
    assert wait_until_saved(wired_uno) == (STORED if volts > 4 else LOW)


def test_a_measurement_that_a_motor_ends_leaves_the_converter_to_the_sensors(uno: Uno) -> None:
    """The pauses are shorter than a measurement, so each measurement is abandoned, and the program
    is not saved."""
    uno.set_analog("A1", 800)
    wired_uno = computer(uno)
    start_cycle = uno.cycle
    pushes = "W(0.001); M(50, 50); SHOW(LIGHT_L); W(0.02); M(0, 0);"
    send(wired_uno, f"SI|LOOP(FOREVER); {pushes} END_LOOP")
    wired_uno.run(2000)
    shown_values = [event.value for event in wired_uno.session.events() if event.name == "SHOW"]
    assert len(shown_values) > 50 and set(shown_values) == {800_000}
    assert marks(uno, start_cycle) == []


def test_a_program_that_drives_in_short_pushes_is_saved_in_between(uno: Uno) -> None:
    wired_uno = computer(uno)
    start_cycle = uno.cycle
    send(wired_uno, "SI|LOOP(FOREVER);F(0.1, 80);W(0.05);END_LOOP")
    assert wait_until_saved(wired_uno) == STORED
    driving = uno.pins.history("left forward")
    for cycle in marks(uno, start_cycle):
        pin_changes_before = [change for change in driving if change.cycle <= cycle]
        assert pin_changes_before[-1].state == "low"
        # 3.4 ms from the beginning of the write, with the event in the middle.
        later_cycles = [change.cycle for change in driving if change.cycle > cycle]
        assert not later_cycles or later_cycles[0] - cycle >= 1.5 * CYCLES_PER_MS
    assert wired_uno.session.is_running


LOOKS = "SI|LOOP(FOREVER);SHOW(DISTANCE);SHOW(LIGHT_L);SHOW(LIGHT_R);END_LOOP"
STEP = 69  # thousandths of a centimetre in the 4 us of the robot's clock


@pytest.mark.sampled("board", "distance_cm", keep=1)
@pytest.mark.parametrize("board", ["uno", "mega"])
@pytest.mark.parametrize("distance_cm", [3, 50, 390])
def test_readings_are_right_while_names_are_kept_and_the_line_is_bad(
    board: str, distance_cm: int, sketches: Callable[[str], Path]
) -> None:
    """Saving keeps a program from running, the line interrupts it: readings come late at most."""
    with Uno(sketches(board), names=NAMES, board=board, baud=9600) as uno:
        uno.run_ms(300)
        uno.set_analog("A0", 200)
        uno.set_analog("A1", 800)
        uno.set_sonar_distance("trigger", "echo", distance_cm)
        wired_uno = computer(uno)
        send(wired_uno, LOOKS, is_detached=True)
        start_cycle, shown_values = uno.cycle, []
        for turn in range(20):
            assert wired_uno.until(wired_uno.session.name(b"TINI%d" % turn)) == OK
            wired_uno.session.name(b"TINIBOT")
            wired_uno.run(30)
            uno.send(b"\x55", has_bad_stop_bits=True)
            wired_uno.run(20)
            shown_values += [event.value for event in wired_uno.session.events()
                             if event.name == "SHOW"]  # fmt: skip
        assert wired_uno.session.is_running
        writes = [
            event for event in uno.events if event.kind == "eeprom" and event.cycle > start_cycle
        ]
        outputs = [
            pin_change.cycle
            for pin_change in uno.pins.history("trigger")
            if pin_change.state == "low"
        ]
    assert len(writes) > 300
    assert len(shown_values) > 30
    distances = [value for value in shown_values if value not in (200_000, 800_000)]
    assert len(distances) > 10
    # an edge waits for up to two other interrupts: 20 us, and for a step of the robot's clock
    wrong_values = [value for value in distances if abs(value - 1000 * distance_cm) > 6 * STEP]
    assert not wrong_values
    assert {200_000, 800_000} < set(shown_values)
    assert min(b - a for a, b in pairwise(outputs) if a > start_cycle) >= 30 * CYCLES_PER_MS
