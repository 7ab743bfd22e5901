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
RECEIVE_PINS = {"esp32dev": 3, "esp32c3": 20}  # of the link; 0 on the others
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
    "esp32dev": Sides(
        "ESP32-DevKitC",
        ("CLK", "D0", "D1", 15, 2, 0, 4, 16, 17, 5, 18, 19, "GND", 21, 3, 1, 22, 23, "GND"),
        (
            "5V",
            "CMD",
            "D3",
            "D2",
            13,
            "GND",
            12,
            14,
            27,
            26,
            25,
            33,
            32,
            35,
            34,
            39,
            36,
            "EN",
            "3V3",
        ),
    ),
    "esp32c3": Sides(
        "ESP32-C3-DevKitM-1",
        ("GND", 19, 18, "GND", 4, 5, 6, 7, "GND", 8, 9, "GND", 20, 21, "GND"),
        ("GND", "5V", "5V", "GND", 10, 1, 0, "GND", "RST", "GND", 3, 2, "3V3", "3V3", "GND"),
    ),
}
