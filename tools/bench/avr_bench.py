"""Builds a program of `vm_arduino/extras/bench` or `extras/avr`, and runs it on a simulated chip.

Knows avr-g++, simavr, and the flags that users build with; nothing of what the programs do.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
from functools import lru_cache
from pathlib import Path

from tools import ROOT

SOURCES = ROOT / "vm_arduino"
CHIP = "atmega328p"
USUAL = (
    f"-mmcu={CHIP}", "-std=c++11", "-Os", "-fno-exceptions", "-fno-rtti",
    "-ffunction-sections", "-fdata-sections", "-Wl,--gc-sections",
)  # fmt: skip
FLAGS = (*USUAL, "-flto", "-mrelax", "-mcall-prologues")  # the first ones of platformio.ini
WARNINGS = ("-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror")
MARK = b"TiniScript: here is the request"
REQUEST_BYTES = 8192
INSTALL_COMMAND = "apt-get install gcc-avr avr-libc binutils-avr simavr"


def missing() -> str:
    """Return why there is no simulated chip, or nothing."""
    names = [name for name in ("avr-g++", "simavr") if not shutil.which(name)]
    return f"no {' and no '.join(names)} ({INSTALL_COMMAND})" if names else ""


# What a program needs besides the machine.
MORE = {
    "store": ("store/store.cpp", "boards/avr/eeprom.cpp"),
    "reader": tuple(
        f"text/{path.name}" for path in sorted((SOURCES / "src" / "text").glob("*.[cS]*"))
    ),
}


@lru_cache(maxsize=8)
def build(name: str, sources: Path = SOURCES, *more: str, chip: str = CHIP) -> bytes:
    """Return `bench/NAME.cpp` with the machine of `sources`, an ELF file; `more` are flags."""
    code = [
        sources / "extras" / "bench" / f"{name}.cpp",
        sources / "extras" / "chip" / "text.cpp",
        *sorted((sources / "src" / "vm").glob("*.[cS]*")),
    ]
    code += [sources / "src" / item for item in MORE.get(name, ())]
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "program.elf"
        flags = f"-mmcu={chip}", *FLAGS[1:], *more, *WARNINGS
        completed = subprocess.run(
            ["avr-g++", *flags, *map(str, code), "-o", str(program)],
            capture_output=True,
            text=True,
        )
        if completed.returncode != 0:
            raise RuntimeError(f"avr-g++ refuses {name}.cpp:\n{completed.stderr[:4000]}")
        return program.read_bytes()


def run(program: bytes, request: bytes, chip: str = CHIP, limit_s: int = 120) -> list[str]:
    """Return the lines that a built program says about a request. Raises TimeoutExpired."""
    at = program.index(MARK)
    assert len(request) <= REQUEST_BYTES, len(request)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "program.elf"
        path.write_bytes(program[:at] + request + program[at + len(request) :])
        completed = subprocess.run(
            ["simavr", "-m", chip, "-f", "16000000", str(path)],
            capture_output=True,
            timeout=limit_s,
        )
    text = re.findall(rb"\x1b\[32m(.*?)\.\s*\x1b", completed.stdout + completed.stderr)
    lines = [line.decode() for line in text]
    if not lines or lines.pop() != "END":
        raise RuntimeError(
            f"the chip did not end: {(completed.stdout + completed.stderr)[-2000:]!r}"
        )
    return lines
