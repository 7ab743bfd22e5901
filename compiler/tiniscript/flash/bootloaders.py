"""The bootloaders of boards: the data that avrdude needs for each.

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

# For each value of `--chip`: the board of the firmware, and the bootloaders to try. Which of the
# two a Nano has cannot be seen from outside.
BOARDS: dict[str, tuple[str, tuple[Bootloader, ...]]] = {
    "uno": ("uno", (UNO,)),
    "nano": ("nano", (NANO, NANO_OLD)),
    "nano-old": ("nano", (NANO_OLD,)),
    "mega": ("mega", (MEGA,)),
}
