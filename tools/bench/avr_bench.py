"""Builds a program of `vm_arduino/extras/bench` or `extras/avr`, and runs it on a simulated chip.

It knows avr-g++, simavr, and the flags that users build with, but nothing about the programs.
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
COMMON_FLAGS = (
    f"-mmcu={CHIP}", "-std=c++11", "-Os", "-fno-exceptions", "-fno-rtti",
    "-ffunction-sections", "-fdata-sections", "-Wl,--gc-sections",
)  # fmt: skip
FLAGS = (*COMMON_FLAGS, "-flto", "-mrelax", "-mcall-prologues")  # the first ones of platformio.ini
WARNINGS = ("-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror")
REQUEST_MARK = b"TiniScript: here is the request"
REQUEST_BYTES = 8192
INSTALL_COMMAND = "apt-get install gcc-avr avr-libc binutils-avr simavr"


def missing_reason() -> str:
    """Return the reason why there is no simulated chip, or ""."""
    names = [name for name in ("avr-g++", "simavr") if not shutil.which(name)]
    return f"no {' and no '.join(names)} ({INSTALL_COMMAND})" if names else ""


# Sources of a program besides the machine.
EXTRA_SOURCES = {
    "store": ("store/store.cpp", "boards/avr/eeprom.cpp"),
    "reader": tuple(
        f"text/{path.name}" for path in sorted((SOURCES / "src" / "text").glob("*.[cS]*"))
    ),
}


@lru_cache(maxsize=8)
def build(name: str, sources: Path = SOURCES, *extra_flags: str, chip: str = CHIP) -> bytes:
    """Return `bench/NAME.cpp` with the machine of `sources`, an ELF file; `extra_flags` are
    flags."""
    source_paths = [
        sources / "extras" / "bench" / f"{name}.cpp",
        sources / "extras" / "chip" / "text.cpp",
        *sorted((sources / "src" / "vm").glob("*.[cS]*")),
    ]
    source_paths += [sources / "src" / extra_source for extra_source in EXTRA_SOURCES.get(name, ())]
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "program.elf"
        flags = f"-mmcu={chip}", *FLAGS[1:], *extra_flags, *WARNINGS
        result = subprocess.run(
            ["avr-g++", *flags, *map(str, source_paths), "-o", str(program)],
            capture_output=True,
            text=True,
        )
        if result.returncode != 0:
            raise RuntimeError(f"avr-g++ refuses {name}.cpp:\n{result.stderr[:4000]}")
        return program.read_bytes()


def run(program: bytes, request: bytes, chip: str = CHIP, timeout_s: int = 120) -> list[str]:
    """Return the lines that a built program says about a request. Raises TimeoutExpired."""
    offset = program.index(REQUEST_MARK)
    assert len(request) <= REQUEST_BYTES, len(request)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "program.elf"
        path.write_bytes(program[:offset] + request + program[offset + len(request) :])
        result = subprocess.run(
            ["simavr", "-m", chip, "-f", "16000000", str(path)],
            capture_output=True,
            timeout=timeout_s,
        )
    outputs = re.findall(rb"\x1b\[32m(.*?)\.\s*\x1b", result.stdout + result.stderr)
    lines = [line.decode() for line in outputs]
    if not lines or lines.pop() != "END":
        raise RuntimeError(f"the chip did not end: {(result.stdout + result.stderr)[-2000:]!r}")
    return lines
