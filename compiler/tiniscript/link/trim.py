"""The trim of a robot's motors and how fast it was measured to be, which the robot keeps.

It knows the meaning of the bytes. The robot applies the trim to its motors
(`vm_arduino/src/firmware/trim.cpp`), and the pace to moves by centimetres and degrees (`pace.cpp`).
"""

from __future__ import annotations

import struct
from typing import Any, NamedTuple

from tiniscript.link.messages import EXCHANGED, LEFT_REVERSED, PACE_BYTES, RIGHT_REVERSED
from tiniscript.link.payloads import TrimReply

MAX_PACE = 655.35  # cm or degrees in a second, at 80 %


class Pace(NamedTuple):
    """The speed of a robot at 40 and 80 %: centimetres or degrees per second.

    0 and 0: not measured, and the kit's numbers hold.
    """

    speed_40: float = 0.0
    speed_80: float = 0.0
    turn_40: float = 0.0
    turn_80: float = 0.0

    @property
    def rises(self) -> bool:
        """Return whether the robot is faster at 80 % than at 40, or unmeasured: others are
        refused.
        """
        speeds = (self[:2], self[2:])
        return all(at_40 < at_80 or (at_40, at_80) == (0, 0) for at_40, at_80 in speeds)

    def data(self) -> bytes:
        return struct.pack("<4H", *(round(100 * speed) for speed in self))


class Trim(NamedTuple):
    """The wiring of the motors, and the correction that makes the robot drive straight.

    `balance` is the percent by which the left wheel is too strong; if it is below 0, the right
    wheel is. `least` is the smallest power in percent that moves the wheels. Without a pace, the
    robot cannot keep one, or keeps the one that it has.
    """

    is_exchanged: bool = False
    is_left_reversed: bool = False
    is_right_reversed: bool = False
    balance: int = 0
    least: int = 0
    pace: Pace | None = None

    def data(self) -> bytes:
        wheels = (
            EXCHANGED * self.is_exchanged
            | LEFT_REVERSED * self.is_left_reversed
            | RIGHT_REVERSED * self.is_right_reversed
        )
        pace = b"" if self.pace is None else self.pace.data()
        return struct.pack("<BbB", wheels, self.balance, self.least) + pace

    def as_data(self) -> dict[str, Any]:
        """Return the trim as data for JSON."""
        return {**self._asdict(), "pace": None if self.pace is None else self.pace._asdict()}


def trim_from_reply(reply: TrimReply) -> Trim:
    """Return the trim in the reply to TRIM."""
    pace = None
    if len(reply.pace) == PACE_BYTES:
        pace = Pace(*(hundredths / 100 for hundredths in struct.unpack("<4H", reply.pace)))
    return Trim(
        bool(reply.wheels & EXCHANGED),
        bool(reply.wheels & LEFT_REVERSED),
        bool(reply.wheels & RIGHT_REVERSED),
        reply.balance,
        reply.least,
        pace,
    )
