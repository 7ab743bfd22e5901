"""Complaints of a strict compiler."""

from __future__ import annotations

import subprocess
from pathlib import Path

from tests.machines.host import SOURCES

BOARD = SOURCES / "src" / "boards"
STRICT_FLAGS = ("-Wall", "-Wextra", "-Werror", "-fno-exceptions", "-fno-rtti", "-ffreestanding",
          "-fsyntax-only")  # fmt: skip


def complaints(path: Path, *flags: str, standard: str = "gnu++11") -> str:
    """Return the complaints of this computer's compiler about a file."""
    command = ["g++", f"-std={standard}", *STRICT_FLAGS, *flags, str(path)]
    return subprocess.run(command, capture_output=True, text=True, check=False).stderr[:3000]
