"""Prints how much flash and RAM the whole sketch takes, for each robot on an Uno and on a Nano.

Builds these environments of `vm_arduino/platformio.ini` with PlatformIO, offline stand-ins
included; a Mega has six times as much room. RAM is the amount that is always used; the stack comes
on top. The free RAM below the stack is measured on a simulated board, if one can be built.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

from tiniscript import robots
from tiniscript.flash import building
from tools import ROOT, uno
from tools.bench import firmware_stack, page
from tools.builds.platformio_offline import config_of

PROJECT = ROOT / "vm_arduino"
DEFAULT = "tinibot"  # robot of environments whose name has none
NEW_NANO = "nano_new"
# Variants that no shipped robot gets.
SMALLER_ENVIRONMENTS = (
    *(name for name, _ in building.SMALLER_FIRMWARE.values()),
    *building.ENVIRONMENT_WITH_BREAKPOINTS.values(),
)
PLATFORM = "atmelavr"


class Sketch(NamedTuple):
    robot: str
    board: str
    flash: int
    capacity: int  # bytes of flash that the board's bootloader leaves
    ram: int
    firmware: Path


def environments() -> list[str]:
    """Return the names of the environments that build the sketch for an AVR, `mega_grabber`.

    Those of a Nano with a new bootloader build the same as the others of a Nano.
    """
    config = config_of(PROJECT)
    return [name for name in config.envs() if not name.startswith((NEW_NANO, *SMALLER_ENVIRONMENTS))
            and config.get(f"env:{name}", "platform").split()[0] == PLATFORM]  # fmt: skip


def parts_of(name: str) -> tuple[str, str]:
    """Return the robot and the board of an environment."""
    board, _, robot = name.partition("_")
    return robot or DEFAULT, board


def row_of(robot: str, board: str) -> str:
    """Return the page's row for a build of a robot with a board: `liner`, Nano."""
    return f"`{robot}`, {board.capitalize()}"


def small_board_environments() -> list[str]:
    """Return the environments for an ATmega328P: an Uno, or a Nano."""
    return [name for name in environments() if parts_of(name)[1] in ("uno", "nano")]


def page_rows() -> list[str]:
    """Return the rows of the page's table."""
    return [row_of(*parts_of(name)) for name in small_board_environments()]


def measure(name: str, project: Path = PROJECT) -> Sketch:
    """Build one environment and return its sizes. Raises RuntimeError with the log."""
    command = [sys.executable, "-m", "tools.builds.platformio_offline", "--project", str(project)]
    result = subprocess.run(
        [*command, "pio", "run", "-e", name],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    rows = re.findall(r"(Flash|RAM): .*used (\d+) bytes from (\d+)", result.stdout)
    sizes = {name: (int(bytes), int(capacity)) for name, bytes, capacity in rows}
    if result.returncode != 0 or len(sizes) != 2:
        raise RuntimeError(result.stdout[-4000:])
    elf = project / ".pio" / "build" / name / "firmware.elf"
    return Sketch(*parts_of(name), *sizes["Flash"], sizes["RAM"][0], elf)


def main() -> int:
    try:
        sketches = [measure(name) for name in small_board_environments()]
    except RuntimeError as error:
        print(error, file=sys.stderr)
        return 2
    has_room = True
    size_rows = []
    for sketch in sketches:
        has_room &= sketch.flash <= sketch.capacity
        free_text = "-"
        if not uno.missing():
            stack = firmware_stack.measure(sketch.firmware, robots.load(sketch.robot), sketch.board)
            has_room &= stack.least_free >= firmware_stack.MIN_FREE
            free_text = f"{stack.least_free:,}"
        sizes = [f"{size:,}" for size in (sketch.flash, sketch.capacity, sketch.ram)]
        size_rows.append([row_of(sketch.robot, sketch.board), *sizes, free_text])
    page.show("firmware_size", size_rows)
    if uno.missing():
        print(uno.missing())
    return int(not has_room)


if __name__ == "__main__":
    sys.exit(main())
