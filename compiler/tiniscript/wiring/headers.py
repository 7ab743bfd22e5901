"""The two sides of each board as they are printed on it, with the USB socket at the top.

Knows which pin is beside which. `None` is a gap; what is no number is only a name.
"""

from __future__ import annotations

from typing import NamedTuple

Slot = int | str | None


class Sides(NamedTuple):
    name: str
    left: tuple[Slot, ...]
    right: tuple[Slot, ...]


def _analog(first: int, count: int) -> tuple[int, ...]:
    return tuple(range(first, first + count))


def _down(high: int, low: int) -> tuple[int, ...]:
    return tuple(range(high, low - 1, -1))


POWER = ("3.3V", "5V", "GND", "GND", "VIN")
ROW_AT_THE_END = range(22, 54)  # a Mega's double row; only its used pins are drawn

SIDES = {
    "uno": Sides(
        "Arduino Uno",
        (*POWER, None, *_analog(14, 6)),
        ("GND", *_down(13, 8), None, *_down(7, 0)),
    ),
    "nano": Sides(
        "Arduino Nano",
        (13, "3V3", "REF", *_analog(14, 8), "5V", "RST", "GND", "VIN"),
        (*_down(12, 2), "GND", "RST", 0, 1),
    ),
    "mega": Sides(
        "Arduino Mega",
        (*POWER, None, *_analog(54, 8), None, *_analog(62, 8)),
        ("GND", *_down(13, 8), None, *_down(7, 0), None, *range(14, 22)),
    ),
}
