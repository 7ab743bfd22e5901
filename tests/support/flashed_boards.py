"""Boards whose firmware is written, and how that ends."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

from tests.machines.bootloaders import Bootloader
from tests.machines.uno import built
from tests.support.casefile import ROOT
from tests.support.command import CommandResult
from tests.support.copies import linked
from tests.support.waiting import HANGS_S
from tools.uno import Uno

# How a program that others run may end badly: by itself, or ended from outside.
ENDS = (
    "sys.exit(3)",
    "sys.exit(255)",
    *(f"os.kill(os.getpid(), signal.{name})" for name in ("SIGKILL", "SIGTERM", "SIGSEGV")),
)


def copied(folder: Path) -> Path:
    """Return a copy of the package, without what is built for it, in a folder."""
    return linked(ROOT / "compiler", folder / "compiler", "ready", "page")


def to_hex(elf: Path, file: Path) -> None:
    subprocess.run(["avr-objcopy", "-O", "ihex", "-R", ".eeprom", elf, file], check=True)


# An avrdude has a session of its own: killed tests leave it behind, reading for ever from a port
# that is gone. So each process gets so many seconds of a processor.
LIMITED = ("/bin/sh", "-c", 'ulimit -t 60; exec "$@"', "sh")


def command(*words: str) -> list[str]:
    return [*LIMITED, sys.executable, "-m", "tiniscript", "firmware", "--yes", *words]


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


def interrupted(ready_file: Path, *words: str, **variables: str) -> CommandResult:
    """Return what it did where Ctrl-C comes as soon as something is in a file."""
    running = subprocess.Popen(
        command(*words), env={**os.environ, **variables}, stderr=subprocess.PIPE, text=True
    )
    while not (ready_file.exists() and ready_file.read_text()):
        assert running.poll() is None
    running.send_signal(signal.SIGINT)
    _, output = running.communicate(timeout=HANGS_S)
    return CommandResult(running.returncode, "", output)


def new_board(of: Bootloader) -> Uno:
    """Return a board as it comes: a bootloader, and no sketch worth the name."""
    uno = Uno(built("nothing"), board=of.board, bootloader=of.file, baud=of.baud, tells_sleep=False)
    uno.go(speed=1.5 if of.board == "mega" else 1.0)  # a Mega is given its time to begin
    return uno
