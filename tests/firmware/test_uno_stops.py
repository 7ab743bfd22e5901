"""The time from a stop to the motor pins on a simulated chip, whatever the robot is doing; and the
RAM that the stack leaves free at the sketch's deepest point.

A busy robot is stopped at some places of the sweep of `python -m tools.bench.link`. The possible
delay before a stop is bounded: all code that keeps interrupts off, each at its longest and all at
once.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from tiniscript import robots
from tools.bench.firmware_stack import MIN_FREE, measure
from tools.bench.stops import BusyRobot, Place, sample
from tools.uno import CYCLES_PER_MS

MAX_CYCLES = 12 * CYCLES_PER_MS // 1000
BEST_ECHO_CYCLES = range(-64, -24, 8)  # cycles: just before the last byte is there
STOP_COUNT = 24
SEED = 12


@pytest.mark.sampled("environment", "name", "more_cycles")
@pytest.mark.parametrize(("environment", "name", "more_cycles"), [
    ("uno", "tinibot", 0),
    ("nano_liner", "liner", 0),
    ("uno_tinibot2", "tinibot2", 0),  # includes an edge of each disc
    # Addresses of three bytes, ports far away, and the pulses of a servo
    ("mega_grabber", "grabber", 60),
    ("mega_tinibot2", "tinibot2", 60),
])  # fmt: skip
def test_a_stop_reaches_the_pins_in_12_us(
    environment: str,
    name: str,
    more_cycles: int,
    sketches: Callable[[str], Path],
    capsys: pytest.CaptureFixture[str],
) -> None:
    robot = robots.load(name)
    with BusyRobot(
        sketches(environment), robot, environment.partition("_")[0], robot.board.baud
    ) as stopped_busy_robot:
        places = sample(stopped_busy_robot, STOP_COUNT, SEED)
        if stopped_busy_robot.has_echo:
            places += [Place(places[0].cycle, echo, True) for echo in BEST_ECHO_CYCLES]
        for place in places:
            cycles = stopped_busy_robot.stop(place)
            assert 0 < cycles <= MAX_CYCLES, place
        together = stopped_busy_robot.worst_case_cycles()
    with capsys.disabled():
        slowest_us, together_us = (
            cycles / CYCLES_PER_MS * 1000
            for cycles in (max(stopped_busy_robot.stop_cycles), together)
        )
        print(f"\n  {slowest_us:.1f} us; all at once {together_us:.1f} us", end=" ")
    assert together <= MAX_CYCLES + more_cycles


# -- free RAM of the whole sketch at its deepest --------------------------------------------------


@pytest.mark.sampled(of="long ways of a chip")
@pytest.mark.parametrize(
    ("environment", "robot"),
    [("uno", "tinibot"), ("nano_liner", "liner"), ("uno_tinibot2", "tinibot2")],
)
def test_the_sketch_leaves_stack_free(
    environment: str,
    robot: str,
    sketches: Callable[[str], Path],
    capsys: pytest.CaptureFixture[str],
) -> None:
    stack = measure(sketches(environment), robots.load(robot), environment.partition("_")[0])
    with capsys.disabled():
        print(f"\n  {stack.untouched_bytes} bytes untouched, {stack.least_free} at least", end=" ")
    assert stack.program > 100 and stack.interrupt > 20
    assert stack.least_free <= stack.untouched_bytes + 4
    assert stack.untouched_bytes >= MIN_FREE
    assert stack.least_free >= MIN_FREE
