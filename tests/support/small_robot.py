"""A robot with few sensors, whose readings can be left out."""

from __future__ import annotations

import random
import re

from tests.machines.host_firmware import HostFirmware
from tests.oracle.task_programs import task_program

MARK = "BEEP(0.001, 31);"  # reports the start of a program


class SmallRobot(HostFirmware):
    """A robot that, like an Uno, reads text into the place of its program."""

    has_draft = False


FIRST_READINGS, READINGS = (1_000, 2_000, 3_000), (9_000, 600_000, 5_000)


def draw_program(rng: random.Random) -> str:
    """Return a program that begins with the mark, and draws nothing itself."""
    text = re.sub(r"RANDOM\(\d, \d\)", str(rng.randint(0, 3)), task_program(rng)[0])
    moves = rng.choice(("", "F(60, 80);", "X = 0;W(0.05);SHOW(1 / X);", "M(30, -30);",
                        "BEEP(3, 262);"))  # fmt: skip
    return MARK + text.replace("\n", ";") + ";" + moves


def without_readings(text: str) -> str:
    text = re.sub(r";(DISTANCE|LIGHT_L)(?=;)", ";W(0)", text)
    return re.sub("DISTANCE|LIGHT_L", "TIME", text)
