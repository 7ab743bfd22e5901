"""The trim of a robot's motors, which the robot keeps in three bytes.

Knows what the bytes mean. The robot applies the trim to its motors
(`vm_arduino/src/firmware/trim.cpp`).
"""

from __future__ import annotations

import struct
from typing import NamedTuple

from tiniscript.link.messages import EXCHANGED, LEFT_REVERSED, RIGHT_REVERSED
from tiniscript.link.payloads import TrimReply


class Trim(NamedTuple):
    """How the motors are wired, and the correction that makes the robot drive straight.

    `balance` is the percent by which the left wheel is too strong; if it is below 0, the right
    wheel is. `least` is the smallest power in percent that moves the wheels.
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


def told(reply: TrimReply) -> Trim:
    """Return the trim in the reply to TRIM."""
    return Trim(
        bool(reply.wheels & EXCHANGED),
        bool(reply.wheels & LEFT_REVERSED),
        bool(reply.wheels & RIGHT_REVERSED),
        reply.balance,
        reply.least,
    )
