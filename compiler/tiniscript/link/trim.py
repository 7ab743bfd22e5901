"""The trim of a robot's motors: what it keeps of them in three bytes.

Knows what the bytes mean. How the motors get what a program asks for, the robot knows
(`vm_arduino/src/firmware/trim.cpp`).
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from typing import NamedTuple

from tiniscript.link.messages import EXCHANGED, LEFT_REVERSED, RIGHT_REVERSED


class Trim(NamedTuple):
    """How the motors are wired, and what makes them drive straight.

    `balance` is the percent by which the left wheel is too strong, or the right one where it is
    less than 0; `least` the percent of power from which on the wheels move.
    """

    is_exchanged: bool = False
    is_left_reversed: bool = False
    is_right_reversed: bool = False
    balance: int = 0
    least: int = 0

    def data(self) -> bytes:
        wheels = (
            EXCHANGED * self.is_exchanged
            | LEFT_REVERSED * self.is_left_reversed
            | RIGHT_REVERSED * self.is_right_reversed
        )
        return struct.pack("<BbB", wheels, self.balance, self.least)


def told(values: Mapping[str, int | bytes]) -> Trim:
    """Return the trim that the reply to TRIM tells."""
    numbers = [values[name] for name in ("wheels", "balance", "least")]
    wheels, balance, least = (each for each in numbers if isinstance(each, int))
    return Trim(
        bool(wheels & EXCHANGED),
        bool(wheels & LEFT_REVERSED),
        bool(wheels & RIGHT_REVERSED),
        balance,
        least,
    )
