"""Firmwares for the simulated Uno: the small ones of `tests/uno`, built for a test."""

from __future__ import annotations

import subprocess
import tempfile
from functools import lru_cache
from pathlib import Path

from tests.machines.avr import FLAGS
from tests.machines.avr import missing as no_compiler
from tests.machines.host import WARNINGS
from tests.support.platformio import need
from tools import uno

SOURCES = Path(__file__).resolve().parent.parent / "uno"


def needed() -> None:
    """Skip a test where there is no simulated Uno or nothing to build firmwares with."""
    need(uno.missing() or no_compiler())


@lru_cache(maxsize=1)
def _folder() -> tempfile.TemporaryDirectory[str]:
    return tempfile.TemporaryDirectory()


@lru_cache(maxsize=16)
def built(name: str, **constants: int) -> Path:
    """Return `tests/uno/NAME.cpp` as an ELF file, with these constants in it."""
    needed()
    marks = [f"{constant}_{value}" for constant, value in constants.items()]
    elf = Path(_folder().name) / f"{'_'.join([name, *marks])}.elf"
    given = [f"-Dk{constant}={value}L" for constant, value in constants.items()]
    source = str(SOURCES / f"{name}.cpp")
    done = subprocess.run(
        ["avr-g++", *FLAGS, *WARNINGS, "-DF_CPU=16000000L", *given, source, "-o", str(elf)],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, f"avr-g++ refuses {name}.cpp:\n{done.stderr[:4000]}"
    return elf
