"""PlatformIO for tests: its requirements here, and the sketch that it builds."""

from __future__ import annotations

import importlib.util
import os
import shlex
import shutil
import subprocess
import sys
from functools import lru_cache
from pathlib import Path

import pytest

from tests.machines.host import make_once
from tests.support.casefile import ROOT
from tests.support.command import CommandResult
from tests.support.copies import link_copy
from tests.support.needs import need

OFFLINE = [sys.executable, "-m", "tools.builds.platformio_offline"]
SKETCH = ROOT / "vm_arduino"


@lru_cache(maxsize=1)
def prepare() -> tuple[dict[str, str], str]:
    """Return the variables that `pio` needs (none if it is online), and the reason why it cannot
    run."""
    if importlib.util.find_spec("platformio") is None:
        return {}, "PlatformIO is not installed"
    completed = subprocess.run(OFFLINE, cwd=ROOT, capture_output=True, text=True, check=False)
    exports = (shlex.split(row)[1].partition("=")[::2] for row in completed.stdout.splitlines())
    return dict(exports), completed.stderr if completed.returncode else ""


def copy_sketch(folder: Path) -> Path:
    """Return a copy of the sketch in a folder, to build and to break."""
    need(prepare()[1])
    return link_copy(SKETCH, folder / "vm_arduino", ".pio", "__pycache__", "own.h")


def pio(project: Path, *words: str) -> CommandResult:
    """Run `pio`; return its output."""
    completed = subprocess.run(
        [sys.executable, "-m", "platformio", *words],
        cwd=project,
        env={**os.environ, **prepare()[0]},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    return CommandResult(completed.returncode, completed.stdout, "")


def shared_folder(factory: pytest.TempPathFactory) -> Path:
    """Return the folder that all workers of a session have."""
    base = factory.getbasetemp()
    return base.parent if base.name.startswith("popen-") else base


def build_changed_sketch(
    folder: Path, name: str, old_text: str, new_text: str, environment: str = "uno"
) -> Path:
    """Return the sketch with a change in a file of `src/`, built in a folder."""
    project = copy_sketch(folder)
    file = project / "src" / name
    text = file.read_text(encoding="utf-8")
    assert text.count(old_text) == 1, f"{name} has another {old_text!r} now"
    file.unlink()
    file.write_text(text.replace(old_text, new_text), encoding="utf-8")
    pio(project, "run", "-e", environment).gives(0)
    return project / ".pio" / "build" / environment / "firmware.elf"


def firmware(board: str, build_folder: Path, shared_path: Path) -> Path:
    """Return the sketch for a board, an ELF file, built once for all workers of a session."""

    def build_elf(path: Path) -> None:
        project = copy_sketch(build_folder)
        pio(project, "run", "-e", board).gives(0)
        shutil.copy(project / ".pio" / "build" / board / "firmware.elf", path)

    return make_once(shared_path / f"{board}.elf", build_elf)
