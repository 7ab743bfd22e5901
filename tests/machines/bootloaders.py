"""The bootloaders that boards come with, for the simulated ones: those of Debian's Arduino core.

Debian builds Optiboot with a compiler that makes it longer than the 512 bytes of its place. Here
it is built from the same source with a setting more, and fits, as what Arduino ships does.
"""

from __future__ import annotations

import subprocess
import tempfile
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

from tests.machines.board import ARDUINO

FOLDER = ARDUINO / "bootloaders"
BOOTLOADER_ADDRESS, VERSION_ADDRESS = 0x7E00, 0x7FFE
FLAGS = (
    "-w", "-Os", "-fno-split-wide-types", "-fno-inline-small-functions",
    "-fno-inline-functions-called-once", "-mmcu=atmega328p", "-DF_CPU=16000000L",
    "-DLED_START_FLASHES=3", "-DBAUD_RATE=115200",
    f"-Wl,--section-start=.text={BOOTLOADER_ADDRESS:#x}",
    f"-Wl,--section-start=.version={VERSION_ADDRESS:#x}", "-Wl,--relax", "-nostartfiles",
    "-nostdlib",
)  # fmt: skip


class Bootloader(NamedTuple):
    """`board` is the simulated one; the rest is how avrdude calls it."""

    board: str
    file: Path
    programmer: str
    part: str
    baud: int


@lru_cache(maxsize=1)
def _folder() -> tempfile.TemporaryDirectory[str]:
    return tempfile.TemporaryDirectory()


def optiboot(folder: Path, text: str) -> Path:
    """Build a source of Optiboot; return the file."""
    source, elf, file = (folder / f"optiboot.{kind}" for kind in ("c", "elf", "hex"))
    source.write_text(text, encoding="utf-8")
    include_option = f"-I{FOLDER / 'optiboot'}"
    subprocess.run(["avr-gcc", *FLAGS, include_option, source, "-o", elf], check=True)
    sections = ("-j", ".text", "-j", ".version", "--set-section-flags", ".version=alloc,load")
    subprocess.run(["avr-objcopy", *sections, "-O", "ihex", elf, file], check=True)
    return file


@lru_cache(maxsize=1)
def _optiboot() -> Path:
    source = FOLDER / "optiboot" / "optiboot.c"
    return optiboot(Path(_folder().name), source.read_text(encoding="utf-8", errors="replace"))


def bootloader(board: str) -> Bootloader:
    """Return the bootloader of an `uno`, an old `nano` or a `mega`."""
    if board == "uno":
        return Bootloader("uno", _optiboot(), "arduino", "m328p", 115_200)
    if board == "nano":
        old_bootloader = FOLDER / "atmega" / "ATmegaBOOT_168_atmega328.hex"
        return Bootloader("uno", old_bootloader, "arduino", "m328p", 57_600)
    wiring = FOLDER / "stk500v2" / "stk500boot_v2_mega2560.hex"
    return Bootloader("mega", wiring, "wiring", "m2560", 115_200)
