"""Numbers with a unit, which TiniScript writes without.

Knows how many of our units one is: `500 ms` are 0.5 seconds. Knows no place in a program.
"""

from __future__ import annotations

from tiniscript.fixed_point import as_text
from tiniscript.words import UNITS


def in_thousandths(number: str, unit: str) -> int | None:
    """Return `number` of a unit in thousandths of our unit; None if it is not a number."""
    try:
        return round(float(number) * UNITS[unit][1])
    except (ValueError, OverflowError):
        return None


def converted(number: str, unit: str) -> str:
    """Return a number in our unit: `0.5` for `500` and `MS`."""
    if UNITS[unit][1] == 1000:
        return number
    value = in_thousandths(number, unit)
    return number if value is None else as_text(value)
