"""The devices of a robot as words of the language."""

from __future__ import annotations

from tiniscript.base.fixed_point import as_text
from tiniscript.base.kit import Device
from tiniscript.base.words import Argument, Word


def actuator_word(device: Device) -> Word:
    """Return an actuator of a kit as a word that takes one value."""
    middle = device.low + (device.high - device.low) // 2000 * 1000
    sample = "TRUE" if device.is_yes_no else as_text(middle)
    return Word(
        device.name,
        "actuator",
        (Argument("value", device.unit, device.low, device.high, sample),),
    )
