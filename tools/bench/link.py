"""Prints how quick the link is, from the wire to the motor pins, on a simulated Uno, to the cycle.

Builds the firmware of the robot `tinibot` for each baud, offline stand-ins included, and lets a
session talk with it. Cycles are exact; radio modules and USB chips are not in them.
"""

from __future__ import annotations

import re
import shutil
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple, TypeVar

from tests.machines.wired import Wired
from tests.support.images import image_of
from tiniscript import robots
from tools import ROOT, uno
from tools.bench import firmware_size, page, stops
from tools.bench.compiler import PROGRAMS
from tools.bench.firmware_stack import connect, require_ok
from tools.uno import CYCLES_PER_MS, Uno

PROJECT = ROOT / "vm_arduino"
BAUDS = (9600, 115_200)
MOTORS = ("D5", "D6", "D7", "D8", "D9", "D10")
ROBOT = firmware_size.DEFAULT
KIT = robots.load(ROBOT).kit
SHORT_PROGRAM = PROGRAMS[0]

# At most: ms from the first start bit to the pins, by baud; us.
MAX_START_MS = {9600: 25.0, 115_200: 4.0}
MAX_LIVE_US = 100
MAX_STOP_US = 12
# Limit for an ATmega328P; a Mega's timers and ports need longer instructions.
MAX_TOGETHER_US = 12.0
ROWS = (
    f"from the first start bit of `{SHORT_PROGRAM}` to the motor pins",
    "from the last byte of the same line, if `tsc live` sends it, to the motor pins",
    "from the last byte of a stop to motors off, in a busy robot: the slowest",
    "the same: the median",
    "the same: at most, if everything that can delay a stop happens at the same time",
)
OTHER_BOARDS = {  # keyed by environment
    "nano_liner": "`liner`, Nano", "mega_grabber": "`grabber`, Mega",
    "uno_tinibot2": "`tinibot2`, Uno, with an edge of each disc just before the stop",
    "mega_tinibot2": "`tinibot2`, Mega, with an edge of each disc just before the stop",
}  # fmt: skip
# Environments that must meet the limit but are not in the table.
UNSHOWN_ENVIRONMENTS = ("mega", "mega_liner")
UPLOAD_COUNT = 20  # the main loop is elsewhere each time: the slowest counts
PHASE_CYCLES = 37
T = TypeVar("T")


class Figures(NamedTuple):
    """The slowest times to the pins at one baud rate, in ms and us."""

    start_ms: float
    live_us: float
    stop: stops.StopTimes


def copy_project(project: Path) -> Path:
    return Path(shutil.copytree(PROJECT, project, ignore=shutil.ignore_patterns(".pio", "own.h")))


def build(baud: int, folder: Path) -> Path:
    """Return the firmware for a baud. Raises RuntimeError with the log."""
    project = copy_project(folder / f"vm_arduino_{baud}")
    kits = project / "src" / "boards" / "kits"
    header = (kits / "tinibot.h").read_text(encoding="utf-8")
    own_header, count = re.subn(r"kBaud = \d+;", f"kBaud = {baud};", header)
    if not count:
        raise RuntimeError("tinibot.h says nothing of a baud")
    (kits / "own.h").write_text(own_header, encoding="utf-8")
    firmware_size.measure("uno", project)
    return project / ".pio" / "build" / "uno" / "firmware.elf"


def first_move(board: Uno, since_cycle: int) -> int:
    """Return the cycle at which the last of the pins that a motor needs is on."""
    changes = [
        change.cycle
        for pin in MOTORS
        for change in board.pins.history(pin)
        if change.cycle > since_cycle and change.state in ("high", "pwm")
    ]
    return max(changes)


def measure(firmware: Path, baud: int) -> Figures:
    with Uno(firmware, baud=baud) as board:
        wired_uno = connect(board, robots.load(ROBOT), baud)
        require_ok(wired_uno, wired_uno.session.hello())
        start_ms = max(measure_start(wired_uno, 300 + k)[0] for k in range(UPLOAD_COUNT))
        live_us = max(
            measure_start(wired_uno, 300 + k, is_live=True)[1] for k in range(UPLOAD_COUNT)
        )
    stop = stops.slowest(firmware, robots.load(ROBOT), "uno", baud)
    return Figures(start_ms, live_us, stop)


def measure_start(wired_uno: Wired, wait_ms: int, *, is_live: bool = False) -> tuple[float, float]:
    """Return ms from a frame's first start bit and us from its end to the pins.

    The frame is PROGRAM, or LIVE with no run before it.
    """
    board, session = wired_uno.uno, wired_uno.session
    image = image_of(SHORT_PROGRAM, KIT)
    if is_live:
        require_ok(wired_uno, session.clear())
    board.run_to(board.cycle + wait_ms * PHASE_CYCLES)
    begin_cycle = board.cycle
    require_ok(wired_uno, session.live(image.code) if is_live else session.upload(image))
    move_cycle = first_move(board, begin_cycle)
    bytes_before_move = [byte for byte in board.received_bytes if byte.cycle <= move_cycle]
    frame_ends = [k for k, byte in enumerate(bytes_before_move[:-1]) if byte.value == 0]
    frame = bytes_before_move[frame_ends[-1] + 1 :]
    session.stop(wired_uno.now_ms)
    wired_uno.run(wait_ms)
    return (
        (move_cycle - frame[0].began) / CYCLES_PER_MS,
        (move_cycle - frame[-1].cycle) / CYCLES_PER_MS * 1000,
    )


def on_each_baud(
    measure: Callable[[Path, int], T], print_and_check: Callable[[dict[int, T], Path], bool]
) -> int:
    """Build the firmware for each baud, and measure it; return the exit code.

    `print_and_check` prints the results, by baud, and returns whether it is within its limits; it
    may build more in the folder that it gets.
    """
    if reason := uno.missing():
        print(reason, file=sys.stderr)
        return 2
    with tempfile.TemporaryDirectory() as name:
        try:
            figures_by_baud = {baud: measure(build(baud, Path(name)), baud) for baud in BAUDS}
            return int(not print_and_check(figures_by_baud, Path(name)))
        except RuntimeError as error:
            print(error, file=sys.stderr)
            return 2


def main() -> int:
    return on_each_baud(measure, print_figures)


def print_figures(figures_by_baud: dict[int, Figures], folder: Path) -> bool:
    """Print the figures, and those of the other sketches; return whether all are kept."""
    figures = [*figures_by_baud.values()]
    page.show("link", [
        (ROWS[0], *(f"{baud_figures.start_ms:.1f} ms" for baud_figures in figures)),
        (ROWS[1], *(f"{baud_figures.live_us:.0f} µs" for baud_figures in figures)),
        (ROWS[2], *(f"{baud_figures.stop.us:.1f} µs" for baud_figures in figures)),
        (ROWS[3], *(f"{baud_figures.stop.median_us:.1f} µs" for baud_figures in figures)),
        (ROWS[4], *(f"{baud_figures.stop.together_us:.1f} µs" for baud_figures in figures)),
    ])  # fmt: skip
    stop_of_sketch = measure_other_stops(folder)
    page.show("link", [
        (row, f"{stop_of_sketch[name].us:.1f} µs", f"{stop_of_sketch[name].together_us:.1f} µs")
        for name, row in OTHER_BOARDS.items()
    ], position=1)  # fmt: skip
    late_sketches = [name for name, stop in stop_of_sketch.items() if stop.us > MAX_STOP_US]
    if late_sketches:
        print(
            f"stops later than after {MAX_STOP_US} µs: {', '.join(late_sketches)}", file=sys.stderr
        )
    return not late_sketches and all(
        is_within_limits(baud, baud_figures) for baud, baud_figures in figures_by_baud.items()
    )


def measure_other_stops(folder: Path) -> dict[str, stops.StopTimes]:
    """Return the slowest stops of the other sketches, by environment, each at its robot's baud."""
    project = copy_project(folder / "vm_arduino")
    stop_of_sketch = {}
    for name in (*OTHER_BOARDS, *UNSHOWN_ENVIRONMENTS):
        sketch = firmware_size.measure(name, project)
        robot = robots.load(sketch.robot)
        stop_of_sketch[name] = stops.slowest(sketch.firmware, robot, sketch.board, robot.board.baud)
    return stop_of_sketch


def is_within_limits(baud: int, figures: Figures) -> bool:
    """Return whether the figures are as they must be."""
    is_quick = figures.start_ms <= MAX_START_MS[baud] and figures.live_us <= MAX_LIVE_US
    return (
        is_quick and figures.stop.us <= MAX_STOP_US and figures.stop.together_us <= MAX_TOGETHER_US
    )


if __name__ == "__main__":
    sys.exit(main())
