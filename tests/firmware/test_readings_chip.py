"""Reported readings delay no program on a simulated Mega either, at 9600 baud.

`python -m tests.firmware.test_readings_chip 100` runs many; another number says with which seed it
begins.
"""

from __future__ import annotations

import random
import sys
import tempfile
from collections.abc import Callable, Iterator
from itertools import count, islice
from math import inf
from pathlib import Path

import pytest

from tests.support.campaign import failure_text
from tests.support.images import image_of
from tests.support.robot_on_uno import KIT, MOTORS, computer, switched_on
from tests.support.sensed_runs import BYTE_TICKS, is_steady, sensed_run
from tests.support.shown_in_loops import TimedAction, largest_difference_ms, program
from tests.support.uno_trace import power
from tiniscript import robots
from tiniscript.bytecode.image import Image
from tiniscript.link.requests import OK
from tools.bench import firmware_size
from tools.bench.firmware_stack import set_obstacles
from tools.uno import CYCLES_PER_MS, Uno, missing

pytestmark = pytest.mark.skipif(bool(missing()), reason=missing())

BOARD = "mega"
RUN_MS = 1500
CHANGE_INTERVAL_MS = 25  # between two changes of the light
LIGHT = ("A0", "A1")
SAME_SETTING_MS = 0.05  # pins of one setting
LARGEST_DELAY_MS = 1.5  # one byte, and the main loop's delay until it looks
# The times at which a run begins while the computer sends PINGs. It may be all that parts two runs
# without readings.
START_TIMES_MS = (0, 70, 130, 17, 41, 93, 113, 150, 171, 199)


def run_image(image: Image, uno: Uno, is_told: bool, wait_ms: int) -> tuple[list[TimedAction], int]:
    """Return a program's settings with their times since the first, and the number of readings
    reported.
    """
    wired_uno = computer(uno)
    session = wired_uno.session
    assert wired_uno.until(session.upload(image, runs=False, saves=False)) == OK
    assert wired_uno.until(session.tell_readings(is_told)) == OK
    wired_uno.run(wait_ms)
    assert wired_uno.until(session.start()) == OK
    since_cycle, rng = uno.cycle, random.Random(1)
    for _ in range(RUN_MS // CHANGE_INTERVAL_MS):
        for pin in LIGHT:
            uno.set_analog(pin, rng.randrange(1024))
        wired_uno.run(CHANGE_INTERVAL_MS)
    reading_count = sum(event.name == "READING" for event in session.events())
    end = uno.cycle
    session.stop(wired_uno.now_ms)
    wired_uno.run(200)
    changes = sorted({change.cycle for name in MOTORS for change in uno.pins.history(name)
                      if since_cycle < change.cycle < end})  # fmt: skip
    lasting = [(cycle, f"{power(uno, 'left', cycle)} {power(uno, 'right', cycle)}")
               for cycle, next_cycle in zip(changes, [*changes[1:], end], strict=False)
               if next_cycle - cycle > SAME_SETTING_MS * CYCLES_PER_MS]  # fmt: skip
    first = lasting[0][0] if lasting else 0
    return [((cycle - first) / CYCLES_PER_MS, powers) for cycle, powers in lasting], reading_count


def steady_programs(first: int) -> Iterator[tuple[int, str]]:
    """Return programs that move, and do so at the same times on any line: of others no two runs are
    the same."""
    for seed in count(first):
        text = program(random.Random(seed)).replace("DISTANCE", "LIGHT_R")  # no echo is waited for
        if len(sensed_run(text, seed, False, BYTE_TICKS).did) > 1 and is_steady(text, seed):
            yield seed, text


def compare(text: str, uno: Uno) -> int:
    """Run a program with readings: it behaves as without them. Return the number of reported
    readings."""
    image = image_of(text, KIT)
    changes_without_readings, report_count = run_image(image, uno, True, 0)
    nearest_ms = inf
    for begin_ms in START_TIMES_MS:
        nearest_ms = min(
            nearest_ms,
            largest_difference_ms(
                run_image(image, uno, False, begin_ms)[0], changes_without_readings
            ),
        )
        if nearest_ms <= LARGEST_DELAY_MS:
            return report_count
    raise AssertionError(f"{nearest_ms:.1f} ms from each run without: {text}")


@pytest.fixture(scope="module")
def chip(
    sketches: Callable[[str], Path], tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Uno]:
    memory = tmp_path_factory.mktemp("eeprom") / BOARD
    with switched_on(sketches(BOARD), memory, BOARD) as uno:
        set_obstacles(uno, robots.load("tinibot"))
        yield uno


@pytest.mark.sampled("first", keep=2)
@pytest.mark.parametrize("first", range(0, 100, 10))
def test_reporting_readings_does_not_change_the_timing_of_a_mega(chip: Uno, first: int) -> None:
    compare(next(steady_programs(first))[1], chip)


if __name__ == "__main__":
    total = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    begin = int(sys.argv[2]) if len(sys.argv) > 2 else 0
    elf = firmware_size.measure(BOARD).firmware
    readings = 0
    with (
        tempfile.TemporaryDirectory() as folder,
        switched_on(elf, Path(folder) / "eeprom", BOARD) as robot,
    ):
        set_obstacles(robot, robots.load("tinibot"))
        for number, text in islice(steady_programs(begin), total):
            try:
                readings += compare(text, robot)
            except AssertionError as wrong:
                raise SystemExit(f"seed {number}: {failure_text(wrong)}") from None
    print(f"{total} programs on a simulated {BOARD}, {readings} readings told: none was delayed")
