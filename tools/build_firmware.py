"""Builds the firmware of the shipped robots for the package: `tsc firmware` writes it on boards.

    python tools/build_firmware.py

puts a file for each robot on each board that it fits, and the notices of what is in them, where
the package is made from. It builds with PlatformIO, offline stand-ins included, in a folder of its
own: the same files come out wherever that is, with the same compiler.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "compiler"), str(ROOT)]

from tiniscript.flash.ready import FOLDER, NOTICE, name_of
from tools.firmware_size import PROJECT, environments, measured
from tools.platformio_offline import CannotStandIn

LICENCE = Path("/usr/share/common-licenses/LGPL-2.1")  # Debian's copy
LICENCE_NAME = "LGPL-2.1.txt"
NOTICE_TEXT = f"""\
The files beside this one are the firmware of TiniScript's robots, ready to be written on a board.

They are made from TiniScript's folder vm_arduino, which is under the MIT licence, and contain:

- parts of Arduino's core for AVR boards (ArduinoCore-avr), Copyright Arduino and others, under the
  GNU Lesser General Public License, version 2.1 or later: {LICENCE_NAME}, beside this file. Its
  source: https://github.com/arduino/ArduinoCore-avr
- parts of avr-libc, Copyright its authors, under a licence of the BSD kind:
  https://www.nongnu.org/avr-libc/LICENSE.txt
- parts of libgcc, under the GNU General Public License with the GCC Runtime Library Exception.

To make them anew, with another core too: pio run -d vm_arduino, or tools/build_firmware.py, which
has made these, in TiniScript's source.
"""


class CannotBuild(Exception):
    """Something is missing; says what, and what to do."""


def build(name: str, target: Path) -> Path:
    """Build one environment of `vm_arduino/platformio.ini` into a folder; return the file."""
    with tempfile.TemporaryDirectory() as folder:
        project = Path(folder) / "vm_arduino"
        ignored = shutil.ignore_patterns(".pio", "own.h")
        shutil.copytree(PROJECT, project, ignore=ignored)
        sketch = measured(name, project)
        made = target / name_of(sketch.robot, sketch.board)
        shutil.copy(sketch.firmware.with_suffix(".hex"), made)
    return made


def build_all(target: Path, licence: Path) -> list[Path]:
    """Build everything into a folder that has nothing else then."""
    if not licence.is_file():
        raise CannotBuild(
            f"there is no {licence}: name a copy of the GNU LGPL 2.1 with --licence; "
            "https://www.gnu.org/licenses/old-licenses/lgpl-2.1.txt is one"
        )
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=target.parent) as scratch:
        new = Path(scratch) / "ready"
        new.mkdir()
        made = [build(name, new) for name in environments()]
        (new / NOTICE).write_text(NOTICE_TEXT, encoding="utf-8")
        shutil.copy(licence, new / LICENCE_NAME)
        shutil.rmtree(target, ignore_errors=True)
        new.rename(target)
    return [target / path.name for path in made]


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Build the firmware that the package brings.")
    parser.add_argument("--licence", type=Path, default=LICENCE, help="a copy of the GNU LGPL 2.1")
    options = parser.parse_args(arguments)
    try:
        made = build_all(FOLDER, options.licence)
    except (CannotBuild, CannotStandIn, RuntimeError) as why:
        print(f"build_firmware: {why}", file=sys.stderr)
        return 2
    for path in made:
        print(path.relative_to(ROOT))
    return 0


if __name__ == "__main__":
    sys.exit(main())
