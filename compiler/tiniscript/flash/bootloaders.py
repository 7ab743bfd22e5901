"""The bootloaders of boards: the data that avrdude needs for each.

Knows no files and no ports.
"""

from __future__ import annotations

from typing import NamedTuple


class Bootloader(NamedTuple):
    """The avrdude name of a bootloader, and its speed in bits per second."""

    name: str
    programmer: str
    part: str
    baud: int


UNO = Bootloader("uno", "arduino", "m328p", 115_200)
NANO = Bootloader("nano", "arduino", "m328p", 115_200)
NANO_OLD = Bootloader("nano-old", "arduino", "m328p", 57_600)
MEGA = Bootloader("mega", "wiring", "m2560", 115_200)

# Board and bootloaders to try, by value of `--chip`. A Nano does not show which of two it has.
BOARDS: dict[str, tuple[str, tuple[Bootloader, ...]]] = {
    "uno": ("uno", (UNO,)),
    "nano": ("nano", (NANO, NANO_OLD)),
    "nano-old": ("nano", (NANO_OLD,)),
    "mega": ("mega", (MEGA,)),
}
