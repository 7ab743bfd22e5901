"""Boards whose firmware is written, and the outcomes."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

from tests.machines.bootloaders import Bootloader
from tests.machines.uno import build_uno
from tests.support.casefile import ROOT
from tests.support.command import CommandResult
from tests.support.copies import link_copy
from tests.support.waiting import HANG_LIMIT_S
from tools.uno import Uno

# The ways in which a child program may end badly: by itself, or ended from outside.
CHILD_ENDS = (
    "sys.exit(3)",
    "sys.exit(255)",
    *(f"os.kill(os.getpid(), signal.{name})" for name in ("SIGKILL", "SIGTERM", "SIGSEGV")),
)


def copy_package(folder: Path) -> Path:
    """Return a copy of the package in a folder, without its build results."""
    return link_copy(ROOT / "compiler", folder / "compiler", "ready", "page")


def to_hex(elf: Path, file: Path) -> None:
    subprocess.run(["avr-objcopy", "-O", "ihex", "-R", ".eeprom", elf, file], check=True)


# An avrdude has its own session: killed tests leave it reading forever from a vanished port.
# Therefore each process has a limit of processor seconds.
CPU_LIMIT_COMMAND = ("/bin/sh", "-c", 'ulimit -t 60; exec "$@"', "sh")


def command(*words: str) -> list[str]:
    return [*CPU_LIMIT_COMMAND, sys.executable, "-m", "tiniscript", "firmware", "--yes", *words]


def tsc(package: Path, *words: str, **variables: str) -> CommandResult:
    result = subprocess.run(
        command(*words),
        env={**os.environ, "PYTHONPATH": str(package), **variables},
        capture_output=True,
        text=True,
        timeout=180,
        check=False,
    )
    return CommandResult(result.returncode, result.stdout, result.stderr)


def run_interrupted(ready_file: Path, *words: str, **variables: str) -> CommandResult:
    """Run a command, and press Ctrl-C as soon as a file has content; return the result."""
    process = subprocess.Popen(
        command(*words), env={**os.environ, **variables}, stderr=subprocess.PIPE, text=True
    )
    while not (ready_file.exists() and ready_file.read_text()):
        assert process.poll() is None
    process.send_signal(signal.SIGINT)
    _, output = process.communicate(timeout=HANG_LIMIT_S)
    return CommandResult(process.returncode, "", output)


def new_board(loader: Bootloader) -> Uno:
    """Return a board as it comes: a bootloader, and no sketch worth the name."""
    uno = Uno(
        build_uno("nothing"),
        board=loader.board,
        bootloader=loader.file,
        baud=loader.baud,
        tells_sleep=False,
    )
    uno.go(speed=1.5 if loader.board == "mega" else 1.0)  # a Mega is given its time to begin
    return uno
