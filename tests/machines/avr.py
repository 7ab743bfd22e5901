"""The machine in C++ on a simulated ATmega328P or ATmega2560.

Builds `vm_arduino/extras/avr` with avr-g++ once, writes each request into the built program where
its flash waits for it, and lets `simavr` run that. The answer is the output of the UART.
"""

from __future__ import annotations

import subprocess
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from tests.machines.host import (
    SOURCES,
    WARNINGS,
    Ran,
    build_cached,
    contents,
    parse_run,
    run_request,
)
from tests.machines.pace import NO_DELAY, Pace
from tiniscript.base.kit import Kit
from tools.bench import avr_bench

if TYPE_CHECKING:
    from tests.machines import Senses

UNO, NANO, MEGA = "uno", "nano", "mega"
PORTABLE_CHIP = "portable"  # an Uno with the machine of all other chips
COMPILER_ARGUMENTS = {
    UNO: ("atmega328p", "-Dtiniscript_with_tasks"),
    NANO: ("atmega328p",),
    PORTABLE_CHIP: ("atmega328p", "-Dtiniscript_with_tasks", "-Dtiniscript_portable"),
    # Some variables lie after a border of 256 bytes.
    MEGA: ("atmega2560", "-Wl,--section-start=.data=0x8002c0"),
}
FLAGS = ("-std=c++11", "-Os", "-flto", "-fno-exceptions", "-fno-rtti")
missing = avr_bench.missing_reason


@lru_cache(maxsize=4)
def program(chip: str) -> bytes:
    """Return the program of a chip, an ELF file."""
    folders = [SOURCES / name for name in ("src/vm", "extras/chip", "extras/avr")]
    made_from = contents(SOURCES / "src", *folders)
    source_paths = sorted(str(path) for folder in folders for path in folder.glob("*.[cS]*"))
    mcu, *extra_arguments = COMPILER_ARGUMENTS[chip]
    flags = (f"-mmcu={mcu}", *extra_arguments, *FLAGS, *WARNINGS)
    return compile_sources("the C++ machine", flags, source_paths, made_from).read_bytes()


def compile_sources(
    description: str, flags: Sequence[str], source_paths: Sequence[str], made_from: list[bytes]
) -> Path:
    """Return the program of sources; unchanged parts are reused."""

    def make(path: Path) -> None:
        words = ["avr-g++", *flags, *source_paths, "-o", str(path)]
        completed = subprocess.run(words, capture_output=True, text=True)
        assert completed.returncode == 0, (
            f"avr-g++ refuses {description}:\n{completed.stderr[:4000]}"
        )

    return build_cached("avr-g++", flags, made_from, make)


def run_on(
    chip: str,
    image: bytes,
    kit: Kit,
    senses: Senses,
    not_ready: int = 0,
    pace: Pace = NO_DELAY,
    begin_ms: int = 0,
) -> Ran:
    """Run an image, which is read and verified by the simulated chip."""
    request = run_request(image, kit, senses, not_ready, begin_ms)
    return parse_run(answer(chip, b"P" + pace.pack(kit) + request))


def answer(chip: str, request: bytes, limit_s: int = 120) -> str:
    """Return the program's answer to a request. Raises TimeoutExpired."""
    lines = avr_bench.run(program(chip), request, COMPILER_ARGUMENTS[chip][0], limit_s)
    return "".join(f"{line}\n" for line in lines)
