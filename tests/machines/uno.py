"""Firmwares for the simulated Uno: the small ones of `tests/uno`, built for a test."""

from __future__ import annotations

import re
from functools import lru_cache
from pathlib import Path

from tests.machines.avr import COMPILER_ARGUMENTS, FLAGS, UNO, compile_sources
from tests.machines.avr import missing as no_compiler
from tests.machines.host import WARNINGS
from tests.support.needs import need
from tools import uno

SOURCES = Path(__file__).resolve().parent.parent / "uno"


def skip_unless_available() -> None:
    """Skip a test if there is no simulated Uno or no compiler for firmware."""
    need(uno.missing() or no_compiler())


@lru_cache(maxsize=16)
def build_uno(name: str, **constants: int) -> Path:
    """Return `tests/uno/NAME.cpp` as an ELF file, with these constants and what it includes."""
    skip_unless_available()
    define_flags = [f"-Dk{constant}={value}L" for constant, value in constants.items()]
    source = SOURCES / f"{name}.cpp"
    flags = (
        f"-mmcu={COMPILER_ARGUMENTS[UNO][0]}",
        *FLAGS,
        *WARNINGS,
        "-DF_CPU=16000000L",
        *define_flags,
    )
    included = re.findall(r'(?m)^#include "(.+)"', source.read_text(encoding="utf-8"))
    contents = [(SOURCES / path).read_bytes() for path in (source.name, *included)]
    return compile_sources(source.name, flags, [str(source)], contents)
