"""Writes random TiniScript programs, random readings for them, and broken texts.

Every program is valid and nearly always ends or reaches its time limit soon. The names that it
uses and the kinds and ranges that it respects are those of the kit that it is given.
"""

from __future__ import annotations

import random

from tests.oracle.author import Author
from tests.oracle.breaking import break_text
from tests.oracle.layout import Layout
from tests.oracle.words import PAPER_KIT, Device, Kit

WIDE_KIT = Kit(
    sensors=(
        *PAPER_KIT.sensors,
        Device("TEMPERATURE", False, -40_000, 125_000),
        Device("TOUCH", True, 0, 1),
        Device("LINE", True, 0, 1),
    ),
    actuators=(
        Device("GRIPPER", False, 0, 180_000),
        Device("LIFT", False, -90_000, 90_000),
        Device("LED", True, 0, 1),
    ),
    speed=33_300,
    turn=7,
)


def program(rng: random.Random, kit: Kit, ways: bool = False) -> str:
    """A valid program; with `ways` some of its moves go by centimetres or degrees."""
    if rng.random() < 0.002:
        return rng.choice(("PING|check_connection", "ping|CHECK_CONNECTION\n", "", "SI|", "// -"))
    return Layout(rng).program(Author(rng, kit, ways).program())


def senses(rng: random.Random, kit: Kit) -> dict[str, list[int]]:
    """Readings in thousandths for some of the sensors, each within its range."""
    readings_by_sensor: dict[str, list[int]] = {}
    for device in kit.readings:
        if rng.random() < 0.25:
            continue
        readings: list[int] = []
        for _ in range(rng.randint(1, 8)):
            value = rng.randint(device.low, device.high)
            if not device.is_yes_no:
                value = rng.choice((value, value % 20_000, value // 1000 * 1000, device.low, 9_000))
                value = max(device.low, min(device.high, value))
            readings.append(value)
        readings_by_sensor[device.name] = readings
    return readings_by_sensor


__all__ = ["WIDE_KIT", "break_text", "program", "senses"]
