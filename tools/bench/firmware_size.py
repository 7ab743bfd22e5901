"""Prints how much flash and RAM the whole sketch takes, for each robot on each board it fits.

Builds every AVR environment of `vm_arduino/platformio.ini` with PlatformIO, offline stand-ins
included. RAM is what is there all the time; the stack comes on top. What the stack leaves free is
measured on a simulated board, where that can be built.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "compiler"), str(ROOT)]

from tiniscript import robots
from tools import uno
from tools.bench import firmware_stack
from tools.builds.platformio_offline import CannotStandIn, config_of

PROJECT = ROOT / "vm_arduino"
OFFLINE = ROOT / "tools" / "builds" / "platformio_offline.py"
DEFAULT = "tinibot"  # where the name of an environment has no robot
# 512 and 2,048 bytes less than an old bootloader leaves of a Nano.
FLASH_MUST, FLASH_AIM = 30_208, 28_672
RAM_MUST, RAM_AIM = 1380, 1000
OWNERS = "    -D tiniscript_with_owners\n"  # in `platformio.ini`
WITHOUT_OWNERS_MUST, WITHOUT_OWNERS_AIM = 26_112, 24_000
NEW_NANO = "nano_new"
PLATFORM = "atmelavr"
COPIED_NOT = shutil.ignore_patterns(".pio", "own.h")
LARGE = "mega"  # a board that has more of everything


class Sketch(NamedTuple):
    robot: str
    board: str
    flash: int
    ram: int
    firmware: Path


def environments() -> list[str]:
    """Return the names of the environments that build the sketch for an AVR, `mega_grabber`.

    Those of a Nano with a new bootloader build what the others of a Nano do.
    """
    config = config_of(PROJECT)
    return [name for name in config.envs() if not name.startswith(NEW_NANO)
            and config.get(f"env:{name}", "platform") == PLATFORM]  # fmt: skip


def measured(name: str, project: Path = PROJECT) -> Sketch:
    """Build one environment and return its sizes. Raises RuntimeError with the log."""
    command = [sys.executable, str(OFFLINE), "--no-apt", "--project", str(project)]
    done = subprocess.run(
        [*command, "pio", "run", "-e", name],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    used = dict(re.findall(r"(Flash|RAM): .*used (\d+) bytes", done.stdout))
    if done.returncode != 0 or len(used) != 2:
        raise RuntimeError(done.stdout[-4000:])
    board, _, robot = name.partition("_")
    elf = project / ".pio" / "build" / name / "firmware.elf"
    return Sketch(robot or DEFAULT, board, int(used["Flash"]), int(used["RAM"]), elf)


def without_owners(folder: Path) -> Sketch:
    """Build an Uno's sketch without owners in a folder. Raises RuntimeError with the log."""
    project = Path(shutil.copytree(PROJECT, folder / PROJECT.name, ignore=COPIED_NOT))
    settings = project / "platformio.ini"
    text = settings.read_text(encoding="utf-8")
    if text.count(OWNERS) != 1:
        raise RuntimeError("platformio.ini has owners in another way than expected")
    settings.write_text(text.replace(OWNERS, ""), encoding="utf-8")
    return measured("uno", project)


def main() -> int:
    try:
        sketches = [measured(name) for name in environments()]
        with tempfile.TemporaryDirectory() as folder:
            small = without_owners(Path(folder))
    except (RuntimeError, CannotStandIn) as why:
        print(why, file=sys.stderr)
        return 2
    print("| robot | board | flash | RAM | free behind the stack |\n|---|---|---:|---:|---:|")
    is_enough = True
    for sketch in sketches:
        if sketch.board != LARGE:
            is_enough &= sketch.flash <= FLASH_MUST and sketch.ram <= RAM_MUST
        free = "-"
        if not uno.missing():
            found = firmware_stack.measured(
                sketch.firmware, robots.load(sketch.robot), sketch.board
            )
            is_enough &= found.least_free >= firmware_stack.LEAST_FREE
            free = f"{found.least_free:,}"
        print(f"| {sketch.robot} | {sketch.board} | {sketch.flash:,} | {sketch.ram:,} | {free} |")
    is_enough &= small.flash <= WITHOUT_OWNERS_MUST
    print(
        f"| {small.robot}, without owners | {small.board} | {small.flash:,} | {small.ram:,} | - |"
    )
    print(
        f"\nBytes. On an ATmega328P (uno, nano): flash must be at most {FLASH_MUST:,} (aim "
        f"{FLASH_AIM:,}), without owners {WITHOUT_OWNERS_MUST:,} (aim {WITHOUT_OWNERS_AIM:,}), "
        f"RAM {RAM_MUST:,} (aim {RAM_AIM:,}), and {firmware_stack.LEAST_FREE} must stay free "
        "where the deepest interrupt comes in the deepest place of the program."
    )
    if uno.missing():
        print(uno.missing())
    return int(not is_enough)


if __name__ == "__main__":
    sys.exit(main())
