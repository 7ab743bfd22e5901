"""The Arduino IDE's own builder for tests: its requirements here, and the sketch that it builds."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path
from typing import NamedTuple

from tests.machines import board as boards
from tests.support.needs import need
from tests.support.platformio import SKETCH

BUILDER_HARDWARE = Path("/usr/share/arduino-builder")
BOARDS = {"uno": "uno", "mega": "mega:cpu=atmega2560"}


class SketchBuild(NamedTuple):
    hex: Path
    log: str  # output of the builder, including warnings


def firmware(board: str, build_folder: Path, shared_path: Path) -> SketchBuild:
    """Return the sketch for a board, built once for all workers of a session."""
    built = SketchBuild(shared_path / f"builder-{board}.hex", "")
    log = built.hex.with_suffix(".log")
    if not log.exists():
        build = _build(board, build_folder)
        own_path = shared_path / f"builder-{board}.{os.getpid()}"
        for text, target in ((build.hex.read_text(), built.hex), (build.log, log)):
            own_path.write_text(text, encoding="utf-8")
            own_path.replace(target)
    return built._replace(log=log.read_text(encoding="utf-8"))


def _build(board: str, folder: Path) -> SketchBuild:
    if not shutil.which("arduino-builder"):
        need("no arduino-builder on this computer")
    need(boards.missing())
    copy = folder / "vm_arduino"
    shutil.copytree(SKETCH, copy, ignore=shutil.ignore_patterns(".pio", "own.h"))
    build = folder / "build"
    build.mkdir()
    completed = subprocess.run(
        ["arduino-builder", "-compile", "-warnings", "all",
         "-hardware", BUILDER_HARDWARE, "-hardware", boards.ARDUINO.parents[1],
         "-tools", "/usr/bin", "-fqbn", f"arduino:avr:{BOARDS[board]}", "-build-path", build,
         "-prefs=compiler.cpp.extra_flags=-DDECIMAL_DIG=__DECIMAL_DIG__",
         copy / "vm_arduino.ino"],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )  # fmt: skip
    assert completed.returncode == 0, completed.stdout[-4000:]
    return SketchBuild(build / "vm_arduino.ino.hex", completed.stdout)
