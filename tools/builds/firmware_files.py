"""Builds the firmware of the shipped robots for a package, so that users need not build it.

    python -m tools.builds.firmware_files

puts a file for each robot on each board that it fits, and the notices of their contents, where the
package is made from. It builds as `tsc firmware` does, with PlatformIO, offline stand-ins included:
the same files come out wherever that is, with the same compiler.
"""

from __future__ import annotations

import argparse
import os
import shutil
import sys
import tempfile
from pathlib import Path

from tiniscript import robots
from tiniscript.base.languages import SOURCE_LANGUAGE
from tiniscript.cli.firmware_build import robots_on_boards
from tiniscript.flash import building
from tiniscript.flash.ready import FOLDER, NOTICE_FILE, file_name_of, title_of
from tiniscript.library import install_advice
from tiniscript.robots.profile import Robot, answer_languages
from tools import ROOT, CannotMake
from tools.builds.platformio_offline import PROJECT, settings_for

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

To make them anew, with another core too: pio run -d vm_arduino, or
tools/builds/firmware_files.py, which has made these, in TiniScript's source.
"""


def shipped_robots() -> list[Robot]:
    """Return each shipped robot on each board that it fits, in each language."""
    return [
        robot
        for name in robots.names()
        for language in answer_languages()
        for robot in robots_on_boards(name, language)
    ]


def halting_robots() -> list[Robot]:
    """Return each shipped robot on each board whose firmware may have breakpoints instead of the
    reader of text, which then has no language."""
    return [
        robot
        for name in robots.names()
        for robot in robots_on_boards(name, SOURCE_LANGUAGE)
        if building.can_have_breakpoints(robot)
    ]


def build(robot: Robot, target: Path, has_breakpoints: bool = False) -> Path:
    """Build the firmware of a robot on its board into a folder; return the file."""
    sources = building.sources()
    assert sources is not None, "no vm_arduino beside this folder"
    title = title_of(robot, has_breakpoints)
    path = target / file_name_of(title, robot.board.chip, sources.digest(robot, has_breakpoints))
    path.write_bytes(building.build(sources, robot, lambda progress: None, has_breakpoints))
    return path


def build_all(target: Path, licence: Path) -> list[Path]:
    """Build everything into a folder, which then contains nothing else."""
    if not licence.is_file():
        raise CannotMake(
            f"there is no {licence}: name a copy of the GNU LGPL 2.1 with --licence; "
            "https://www.gnu.org/licenses/old-licenses/lgpl-2.1.txt is one"
        )
    if building.platformio() is None:
        install_command = install_advice.command(install_advice.FIRMWARE)
        raise CannotMake(f"PlatformIO is not installed. Install it:  {install_command}")
    os.environ.update(settings_for(PROJECT, is_offline=False))
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=target.parent) as scratch:
        new_folder = Path(scratch) / "ready"
        new_folder.mkdir()
        paths = [build(robot, new_folder) for robot in shipped_robots()]
        paths += [build(robot, new_folder, has_breakpoints=True) for robot in halting_robots()]
        (new_folder / NOTICE_FILE).write_text(NOTICE_TEXT, encoding="utf-8")
        shutil.copy(licence, new_folder / LICENCE_NAME)
        if target.exists():
            target.rename(Path(scratch) / "old")
        new_folder.rename(target)
    return [target / path.name for path in paths]


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Build the firmware that the package brings.")
    parser.add_argument("--licence", type=Path, default=LICENCE, help="a copy of the GNU LGPL 2.1")
    options = parser.parse_args(arguments)
    try:
        paths = build_all(FOLDER, options.licence)
    except (building.CannotBuild, CannotMake) as error:
        print(f"build_firmware: {getattr(error, 'log', '') or error}", file=sys.stderr)
        return 2
    for path in paths:
        print(path.relative_to(ROOT))
    return 0


if __name__ == "__main__":
    sys.exit(main())
