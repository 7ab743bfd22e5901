"""Finds the modules that a statement imports in its own process."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import tiniscript

COMPILER = Path(tiniscript.__file__).resolve().parent.parent


def modules_imported_by(statement: str) -> set[str]:
    code = f"import sys; {statement}; print(' '.join(sys.modules))"
    completed = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=COMPILER
    )
    return set(completed.stdout.split())
