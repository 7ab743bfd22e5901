"""Programs stepped through on a simulated chip behave as in `tsc run`, except for the halts.

`python -m tests.firmware.test_breakpoints_chip 1000` runs many on a simulated Uno; another number
says with which seed it begins, and `mega` on which board.
"""

from __future__ import annotations

import random
import sys
import tempfile
from collections.abc import Callable, Iterator
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

import pytest

from tests.machines import MACHINES, Senses
from tests.oracle import programs
from tests.oracle.words import PAPER_KIT
from tests.support.campaign import failure_text
from tests.support.images import image_of
from tests.support.robot_on_uno import KIT, MOTORS, computer, switched_on
from tests.support.uno_trace import power
from tiniscript import robots
from tiniscript.base.fixed_point import value_text
from tiniscript.bytecode.image import Image, pack
from tiniscript.bytecode.statements import statement_starts
from tiniscript.flash.building import ENVIRONMENT_WITH_BREAKPOINTS
from tiniscript.link.messages import BREAKPOINTS, OWNERS, RESUME_STEP, TEXT_LEVEL
from tiniscript.link.payloads import HaltedEvent
from tiniscript.link.requests import OK
from tools.bench import firmware_size, firmware_stack
from tools.uno import CYCLES_PER_MS, Uno, missing

pytestmark = pytest.mark.skipif(bool(missing()), reason=missing())

BOARDS = {"uno": "uno_breakpoints", "mega": "mega"}  # PlatformIO environment of each board
OWN_MS = 1500  # observed time of a program
MAX_HALTS = 60
HALT_MS = 60  # longest time until a halt is known
SEEN_MS, LASTING_MS = 0.5, 20  # a setting too long to miss, and one certain to be seen
OFF_MS = 10  # tolerance for a setting, and extra tolerance for each halt
OFF_HALT_MS = 1.5
OFF_SHOW_MS = 25  # extra tolerance for each SHOW, which waits for room on the wire
STRANGE = ("TIME", "RANDOM")  # clocks and seeds are those of the chip
Setting = tuple[int, int]


class Seen(NamedTuple):
    shows: list[str]
    settings: list[tuple[float, Setting]]  # duration of each setting, apart from halts
    is_over: bool
    end_ms: float = 0
    halts: int = 0


def write_program(rng: random.Random) -> Image | None:
    """Return a random program that only reads values that are the same on the chip."""
    text = programs.program(rng, PAPER_KIT._replace(sensors=()))
    if any(word in text.upper() for word in STRANGE):
        return None
    image = image_of(text, KIT)
    return image if image.start == "SI" and statement_starts(image.code) else None


def run_in_tsc(image: Image) -> Seen:
    """Return the trace of `tsc run`."""
    data = pack(image.start, image.devices, image.code, needs=image.needs)
    trace = MACHINES["python"](data, KIT, Senses(max_ms=OWN_MS + HALT_MS * (MAX_HALTS + 2)))
    rows = [line.split(maxsplit=2) for line in trace.splitlines()]
    end_ms = float(rows[-1][0])
    times = [(float(row[0]), row[2]) for row in rows if row[1] == "MOTORS"]
    end_times_ms = [at_ms for at_ms, _ in times[1:]] + [end_ms]
    settings = [
        (end - at_ms, (int(powers.split()[0]), int(powers.split()[1])))
        for (at_ms, powers), end in zip(times, end_times_ms, strict=False)
    ]
    shows = [row[2] for row in rows if row[1] == "SHOW"]
    return Seen(shows, settings, rows[-1][1] in ("DONE", "FAULT"), end_ms)


def step_on_chip(image: Image, uno: Uno) -> Seen:
    """Step through a program on a chip; return the same."""
    wired_uno = computer(uno)
    session = wired_uno.session
    assert wired_uno.until(session.upload(image, runs=False, saves=False)) == OK
    starts = statement_starts(image.code)
    assert wired_uno.until(session.break_at(starts[:1])) == OK
    assert wired_uno.until(session.start()) == OK
    since_cycle, shows, halts = uno.cycle, list[str](), 0
    own_ms, is_over = 0, False
    while own_ms < OWN_MS + HALT_MS * (halts + 2) and halts < MAX_HALTS and not is_over:
        wired_uno.run(1)
        own_ms += 1
        for event in session.events():
            if event.name == "SHOW":
                shows.append(value_text(event.value, bool(event.is_yes_no)))
            elif isinstance(event, HaltedEvent):
                assert event.offset in starts
                halts += 1
                wired_uno.complete(session.resume(RESUME_STEP))
            is_over = is_over or event.name in ("DONE", "FAULT")
    assert halts, "it halts before its first statement"
    changes = [change.cycle for name in MOTORS for change in uno.pins.history(name)]
    cycles = sorted({cycle for cycle in changes if cycle > since_cycle})
    end_cycles = [*cycles[1:], uno.cycle]
    settings = [
        ((end - cycle) / CYCLES_PER_MS, (power(uno, "left", cycle), power(uno, "right", cycle)))
        for cycle, end in zip(cycles, end_cycles, strict=False)
    ]
    session.stop(wired_uno.now_ms)
    wired_uno.run(200)
    return Seen(shows, settings, is_over, own_ms, halts)


def list_long_settings(steps: Seen, min_ms: float) -> list[Setting]:
    """Return the lasting settings of the motors, without repetitions and pauses."""
    lasting = [setting for ms, setting in steps.settings if ms >= min_ms and setting != (0, 0)]
    return [setting for setting, _ in groupby(lasting)]


def sum_durations(steps: Seen) -> dict[Setting, float]:
    """Return the total duration of each setting."""
    result: dict[Setting, float] = {}
    for ms, setting in steps.settings:
        if setting != (0, 0) and ms >= SEEN_MS:
            result[setting] = result.get(setting, 0) + ms
    return result


def is_within(shorter: list[Setting], longer: list[Setting]) -> bool:
    """Return whether `shorter` is a subsequence of `longer`."""
    rest = iter(longer)
    return all(setting in rest for setting in shorter)


def compare(image: Image, uno: Uno) -> bool:
    """Compare a program; return whether it has ended."""
    expected_observation, run = run_in_tsc(image), step_on_chip(image, uno)
    show_count = min(len(expected_observation.shows), len(run.shows))
    assert run.shows[:show_count] == expected_observation.shows[:show_count]
    assert is_within(list_long_settings(run, SEEN_MS), list_long_settings(expected_observation, 0))
    assert run.is_over or expected_observation.end_ms > OWN_MS or run.halts == MAX_HALTS
    if run.is_over:
        assert run.shows == expected_observation.shows and expected_observation.is_over
        expected, actual = sum_durations(expected_observation), sum_durations(run)
        for setting in expected.keys() | actual.keys():
            off_ms = abs(expected.get(setting, 0) - actual.get(setting, 0))
            max_ms = OFF_MS + OFF_HALT_MS * run.halts + OFF_SHOW_MS * len(run.shows)
            assert off_ms <= max_ms, setting
        assert is_within(
            list_long_settings(expected_observation, LASTING_MS), list_long_settings(run, SEEN_MS)
        )
    return run.is_over


def images(first: int) -> Iterator[tuple[int, Image]]:
    seed = first
    while True:
        image = write_program(random.Random(seed))
        if image is not None:
            yield seed, image
        seed += 1


@pytest.fixture(scope="module", params=[*BOARDS])
def chip(
    request: pytest.FixtureRequest, sketches: Callable[[str], Path],
    tmp_path_factory: pytest.TempPathFactory,
) -> Iterator[Uno]:  # fmt: skip
    board: str = request.param
    memory = tmp_path_factory.mktemp("eeprom") / board
    with switched_on(sketches(BOARDS[board]), memory, board) as uno:
        yield uno


@pytest.mark.sampled("first", "chip")
@pytest.mark.parametrize("first", [0, 100, 200])
def test_a_stepped_program_gives_its_trace(chip: Uno, first: int) -> None:
    programs_of = images(first)
    for _ in range(2):
        seed, image = next(programs_of)
        print(f"seed {seed}")  # printed if the test fails
        compare(image, chip)


def test_a_robot_that_can_halt_announces_it_and_reads_no_text_on_an_uno(chip: Uno) -> None:
    wired_uno = computer(chip)
    assert wired_uno.until(wired_uno.session.hello()) == OK
    assert wired_uno.session.robot is not None
    features = wired_uno.session.robot.values.features
    assert features & (BREAKPOINTS | OWNERS) == BREAKPOINTS | OWNERS
    assert bool(features & TEXT_LEVEL) is (chip.board == "mega")


@pytest.mark.sampled(of="long ways of a chip")
@pytest.mark.parametrize(("board", "environment"), [*ENVIRONMENT_WITH_BREAKPOINTS.items()])
def test_a_firmware_with_breakpoints_leaves_enough_stack(
    board: str, environment: str, sketches: Callable[[str], Path]
) -> None:
    stack = firmware_stack.measure(sketches(environment), robots.load("tinibot"), board, True)
    assert stack.least_free >= firmware_stack.MIN_FREE


if __name__ == "__main__":
    total = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    begin = int(sys.argv[2]) if len(sys.argv) > 2 else 0
    board = sys.argv[3] if len(sys.argv) > 3 else "uno"
    elf = firmware_size.measure(BOARDS[board]).firmware
    ran = over = 0
    with (
        tempfile.TemporaryDirectory() as folder,
        switched_on(elf, Path(folder) / "eeprom", board) as robot,
    ):
        for number, program in images(begin):
            try:
                over += compare(program, robot)
            except AssertionError as wrong:
                raise SystemExit(f"seed {number}: {failure_text(wrong)}") from None
            ran += 1
            if ran == total:
                break
    print(f"{ran} programs, {over} to their end, stepped on a simulated {board}: as tsc run says")
