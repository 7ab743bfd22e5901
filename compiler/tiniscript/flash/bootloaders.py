"""The bootloaders of boards: what a program that writes must know of each.

Knows no files and no ports.
"""

from __future__ import annotations

from typing import NamedTuple


class Bootloader(NamedTuple):
    """How avrdude calls it, and the bits per second at which it listens."""

    name: str
    programmer: str
    part: str
    baud: int


UNO = Bootloader("uno", "arduino", "m328p", 115_200)
NANO = Bootloader("nano", "arduino", "m328p", 115_200)
NANO_OLD = Bootloader("nano-old", "arduino", "m328p", 57_600)
MEGA = Bootloader("mega", "wiring", "m2560", 115_200)

# What `--board` says: the board that the firmware is for, and the bootloaders that are tried.
# From outside nobody can tell which of the two a Nano has.
BOARDS: dict[str, tuple[str, tuple[Bootloader, ...]]] = {
    "uno": ("uno", (UNO,)),
    "nano": ("nano", (NANO, NANO_OLD)),
    "nano-old": ("nano", (NANO_OLD,)),
    "mega": ("mega", (MEGA,)),
}
