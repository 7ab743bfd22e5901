"""The two sides of each board as they are printed on it, with the USB socket at the top.

Knows which pins are next to each other. `None` is a gap; what is no number is only a name.
"""

from __future__ import annotations

from typing import NamedTuple

Slot = int | str | None


class Sides(NamedTuple):
    name: str
    left: tuple[Slot, ...]
    right: tuple[Slot, ...]


def _slots(text: str) -> tuple[Slot, ...]:
    """Return the slots of `"5V - 13..8"`: names, a gap, and pins from 13 down to 8."""
    slots: list[Slot] = []
    for word in text.split():
        first_word, _, last_word = word.partition("..")
        if not first_word.isdigit():
            slots.append(None if word == "-" else word)
        else:
            step = 1 if int(last_word or first_word) >= int(first_word) else -1
            slots += range(int(first_word), int(last_word or first_word) + step, step)
    return tuple(slots)


RECEIVE_PINS = {"esp32dev": 3, "esp32c3": 20}  # receive pins of the link; 0 on other chips
ROW_AT_THE_END = range(22, 54)  # a Mega's double row; only its used pins are drawn

SIDES = {
    board: Sides(name, _slots(left), _slots(right))
    for board, name, left, right in (
        ("uno", "Arduino Uno", "3.3V 5V GND GND VIN - 14..19", "GND 13..8 - 7..0"),
        ("nano", "Arduino Nano", "13 3V3 REF 14..21 5V RST GND VIN", "12..2 GND RST 0 1"),
        ("mega", "Arduino Mega",
         "3.3V 5V GND GND VIN - 54..61 - 62..69", "GND 13..8 - 7..0 - 14..21"),
        ("esp32dev", "ESP32-DevKitC", "CLK D0 D1 15 2 0 4 16 17 5 18 19 GND 21 3 1 22 23 GND",
         "5V CMD D3 D2 13 GND 12 14 27..25 33 32 35 34 39 36 EN 3V3"),
        ("esp32c3", "ESP32-C3-DevKitM-1", "GND 19 18 GND 4..7 GND 8 9 GND 20 21 GND",
         "GND 5V 5V GND 10 1 0 GND RST GND 3 2 3V3 3V3 GND"),
    )
}  # fmt: skip
