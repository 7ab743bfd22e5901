"""The parts of a robot that programs see: sensors, actuators, remote control, and its speed.

Knows names, order, kinds, units and ranges, and the fingerprints and hashes made of them. Knows no
pins and no files: `robots` reads those.
"""

# No `from __future__ import annotations`: typing would compile each field's again, one by one.
import zlib
from collections.abc import Sequence
from typing import NamedTuple

from tiniscript.base.fixed_point import Fault, in_range, rounded_quotient, value_text
from tiniscript.base.words import ROLES, Argument, Word

NUMBER = "number"
YES_NO = "yes/no"

MAX_DEVICES = 32  # the most sensors of a kit, and the most actuators
DEVICES_POLYNOMIAL = 0x2D  # x^16 + x^5 + x^3 + x^2 + 1 without its first term: primitive


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

    @property
    def word(self) -> Word:
        """An actuator as a word that takes one value."""
        middle_value = self.low + (self.high - self.low) // 2000 * 1000
        sample = self.text(1 if self.is_yes_no else middle_value)
        value = Argument("value", self.unit, self.low, self.high, sample)
        return Word(self.name, ROLES["actuator"], (value,))

    def text(self, value: int) -> str:
        """Return a reading or a setting as a run prints it."""
        return value_text(value, self.is_yes_no)


# The readings of a remote control, which every robot with a link has.
REMOTE = (
    *(Device(f"KEY_{key}", YES_NO, "", 0, 1) for key in ("UP", "DOWN", "LEFT", "RIGHT", "A", "B")),
    *(Device(f"PAD_{axis}", NUMBER, "", -100_000, 100_000) for axis in ("X", "Y")),
)
# The labels of its keys, in every language.
REMOTE_SIGNS = dict(zip((device.name for device in REMOTE), "↑↓←→AB↔↕", strict=True))
MAX_SENSORS_BESIDE_REMOTE = 8  # sensors at most: sets of readings have 16 bits

# Words of kits that are younger than 0.2: they give way to a program's own names.
KIT_WORDS_SINCE = {device.name: "0.3" for device in REMOTE}


class Kit(NamedTuple):
    """`speed` and `turn` are thousandths of a centimetre and of a degree in a second at 100 %.

    0: not known, and programs have no moves by the one or the other. `given_words` are the words
    that have given way to one program's own.
    """

    sensors: tuple[Device, ...]
    actuators: tuple[Device, ...] = ()
    speed: int = 0
    turn: int = 0
    given_words: frozenset[str] = frozenset()

    @property
    def has_remote(self) -> bool:
        """Return whether the readings of a remote control fit."""
        return len(self.sensors) <= MAX_SENSORS_BESIDE_REMOTE

    @property
    def readings(self) -> tuple[Device, ...]:
        """Return all that a program can read, by their numbers: the sensors, then the remote.

        A sensor with another name there, or named like a word of the profile, has no name.
        """
        if not self.has_remote:
            return self.sensors
        taken_words = self.given_words.union(self.names) & KIT_WORDS_SINCE.keys()
        if not taken_words:
            return (*self.sensors, *REMOTE)
        return (*self.sensors, *(device._replace(name="") if device.name in taken_words else device
                                 for device in REMOTE))  # fmt: skip

    def asks_remote(self, uses: Sequence[tuple[str, int]]) -> bool:
        """Return whether code that uses these devices reads a remote control; uses are as in
        `uses`.
        """
        return any(kind == "sensor" and k >= len(self.sensors) for kind, k in uses)

    def go_ms(self, extent: int, power: int, is_turn: bool) -> int:
        """Return the duration in ms of a move, or a turn if `is_turn`, of so many thousandths.

        `power` is 0 to 100. Raises Fault if it never comes there, or takes too long.
        """
        if extent <= 0:
            return 0
        per_second = (self.turn if is_turn else self.speed) * power  # thousandths of a percent
        if not per_second:
            raise Fault("NO_POWER")
        return in_range(rounded_quotient(extent * 100_000, per_second))

    @property
    def names(self) -> tuple[str, ...]:
        """Return the words of the sensors, then those of the actuators."""
        return tuple(device.name for device in (*self.sensors, *self.actuators))

    @property
    def fingerprint(self) -> int:
        """Return 16 bits, never 0, that change with everything that a profile says to programs."""
        return _hash_of("".join(self.lines()))

    @property
    def hashes(self) -> tuple[int, ...]:
        """Return 16 bits, never 0, for each device: the readings, then the actuators."""
        return tuple(map(_hash_of, self.device_lines()))

    def hash_of_used(self, uses: Sequence[tuple[str, int]]) -> int:
        """Return the hash of the devices that code uses, in its order; 0 for none.

        A use is "sensor" or "actuator" and its number. For each one the hash is multiplied by x, as
        a polynomial over two elements modulo a primitive one, and the device's hash is added. So a
        device that differs is counted once, however many times the code uses it.
        """
        hashes = self.hashes if uses else ()
        devices_hash = 0
        for kind, number in uses:
            devices_hash <<= 1
            if devices_hash > 0xFFFF:
                devices_hash ^= 0x10000 | DEVICES_POLYNOMIAL
            devices_hash ^= hashes[number + (0 if kind == "sensor" else len(self.readings))]
        return devices_hash

    def lines(self) -> list[str]:
        """Return the lines of the profile that describe each device, in the form that is hashed."""
        return [*_device_lines("sensor", self.sensors), *_device_lines("actuator", self.actuators)]

    def device_lines(self) -> list[str]:
        """Return the lines of each device that programs can see, in the form that is hashed."""
        remote = REMOTE if self.has_remote else ()
        return [
            *_device_lines("sensor", (*self.sensors, *remote)),
            *_device_lines("actuator", self.actuators),
        ]


def _device_lines(kind: str, devices: Sequence[Device]) -> list[str]:
    return [
        f"{kind} {device.name} {device.kind} {device.unit} {device.low} {device.high}\n"
        for device in devices
    ]


def _hash_of(text: str) -> int:
    return zlib.crc32(text.encode()) & 0xFFFF or 0xFFFF
