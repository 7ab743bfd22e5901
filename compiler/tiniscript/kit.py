"""What programs see of a robot: its sensors and actuators.

Knows names, order, kinds, units and ranges, and the fingerprint made of them. Knows no pins
and no files: `robots` reads those.
"""

from __future__ import annotations

import zlib
from typing import NamedTuple

from tiniscript.fixed_point import as_text

NUMBER = "number"
YES_NO = "yes/no"


class Device(NamedTuple):
    """A sensor or an actuator. `low` and `high` are thousandths; 0 and 1 for yes/no."""

    name: str
    kind: str
    unit: str
    low: int
    high: int

    @property
    def is_yes_no(self) -> bool:
        return self.kind == YES_NO

    def text(self, value: int) -> str:
        """Return a reading or a setting as a run prints it."""
        return ("TRUE" if value else "FALSE") if self.is_yes_no else as_text(value)


class Kit(NamedTuple):
    sensors: tuple[Device, ...]
    actuators: tuple[Device, ...]

    @property
    def fingerprint(self) -> int:
        """Return 16 bits, never 0, that change with everything that a program can see."""
        lines = [
            f"{what} {device.name} {device.kind} {device.unit} {device.low} {device.high}\n"
            for what, devices in (("sensor", self.sensors), ("actuator", self.actuators))
            for device in devices
        ]
        return zlib.crc32("".join(lines).encode()) & 0xFFFF or 0xFFFF
