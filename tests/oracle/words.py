"""The equipment of a robot, and the words and limits of the language, independent of the
compiler.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from tests.oracle.arithmetic import nearest_in_range, nearest_whole


class Device(NamedTuple):
    """A sensor or an actuator; low and high are thousandths (0 and 1 for yes/no)."""

    name: str
    is_yes_no: bool
    low: int
    high: int


REMOTE = (
    Device("KEY_UP", True, 0, 1),
    Device("KEY_DOWN", True, 0, 1),
    Device("KEY_LEFT", True, 0, 1),
    Device("KEY_RIGHT", True, 0, 1),
    Device("KEY_A", True, 0, 1),
    Device("KEY_B", True, 0, 1),
    Device("PAD_X", False, -100_000, 100_000),
    Device("PAD_Y", False, -100_000, 100_000),
)
MAX_BESIDE_REMOTE = 8  # sensors of a kit


class Kit(NamedTuple):
    """The equipment of a robot, and its speed in thousandths of cm and of degrees per second."""

    sensors: tuple[Device, ...]
    actuators: tuple[Device, ...]
    speed: int = 0
    turn: int = 0
    has_remote: bool = True

    @property
    def readings(self) -> tuple[Device, ...]:
        """Return the sensors, and the remote control if there is room, by their numbers."""
        has_room = self.has_remote and len(self.sensors) <= MAX_BESIDE_REMOTE
        return self.sensors + (REMOTE if has_room else ())


PAPER_KIT = Kit(
    sensors=(
        Device("LIGHT_R", False, 0, 1_023_000),
        Device("LIGHT_L", False, 0, 1_023_000),
        Device("DISTANCE", False, 0, 400_000),
    ),
    actuators=(),
    speed=45_000,
    turn=360_000,
)


class Mistake(Exception):
    """The program is wrong; the text says why."""


LOWEST_VALUE = -(2**31)
HIGHEST_VALUE = 2**31 - 1
MAX_VARIABLES = 32
MAX_NESTING = 16
MAX_STACK = 16
MAX_DEFS = 16
MAX_VALUES = 4  # most parameters of a DEF
MAX_CALLS = 8
MAX_TASKS = 4

SETUPS = ("PING", "SI", "SB")
COMPARATORS = ("=", "<>", "<", ">", "<=", ">=")
FUNCTIONS = {"ROUND": 2, "ABS": 1, "MIN": 2, "MAX": 2, "RANDOM": 2}
MOVES = ("F", "B", "L", "R")

# The other spellings that are accepted for the ends of blocks.
ALIASES = {
    "END_IF": "ENDIF",
    "ENDLOOP": "END_LOOP",
    "ENDWHILE": "END_WHILE",
    "ENDDEF": "END_DEF",
    "ENDTASK": "END_TASK",
    "ENDWHEN": "END_WHEN",
}
BLOCK_WORDS = (
    "ELSEIF", "ELSE", "ENDIF", "END_LOOP", "END_WHILE", "END_DEF", "END_TASK", "END_WHEN"
)  # fmt: skip
TASK_WORDS = ("TASK", "WHEN")
LATER_WORDS = ("SEND",)
UNITS = {"F": "CM", "B": "CM", "L": "DEG", "R": "DEG"}  # unit of a distance that replaces a time

TIME = (0, HIGHEST_VALUE)
_POWER = (0, 100_000)
_SIDE = (-100_000, 100_000)


class Act(NamedTuple):
    """An instruction that is over at once, or after its time.

    `note` is its row of a trace, with the values by their places.
    """

    ranges: tuple[tuple[int, int], ...]
    note: str
    waits: bool

    def values(self, arguments: Iterable[int]) -> list[int]:
        """Return the values sent to the robot: milliseconds for a time, and whole numbers in
        range.
        """
        return [
            max(0, value)
            if limits == TIME
            else nearest_in_range(nearest_whole(value), *(n // 1000 for n in limits))
            for limits, value in zip(self.ranges, arguments, strict=True)
        ]


# The references define each: `docs/en/language.md`, and for the bytes `bytecode_spec.md`.
ACTS = {"BEEP": Act((TIME, (31_000, 20_000_000)), "BEEP {1} {0}", waits=True)}

# Instructions with arguments in parentheses, and the range of each argument.
RANGES: dict[str, tuple[tuple[int, int], ...]] = {
    "F": (TIME, _POWER),
    "B": (TIME, _POWER),
    "L": (TIME, _POWER),
    "R": (TIME, _POWER),
    "M": (_SIDE, _SIDE),
    "W": (TIME,),
    **{word: act.ranges for word, act in ACTS.items()},
}

# Words that stand for instructions, and these with the names of values in them, as the reference
# lists them: "- With fixed values: `HORN` = `BEEP(0.5, 440)` `HOOT(S)` = `BEEP(S, 440)`".
_REFERENCE = Path(__file__).parent.parent.parent / "docs" / "en" / "language.md"
FIXED_WORDS = {
    word: (tuple(names.split(", ")) if names else (), meaning)
    for line in _REFERENCE.read_text("utf-8").splitlines()
    if line.startswith("- With fixed values")
    for word, names, meaning in re.findall(r"`(\w+)(?:\(([^)`]*)\))?` = `([^`]+)`", line)
}

RESERVED = frozenset(
    (
        *SETUPS, *MOVES, *FUNCTIONS, *ALIASES, *BLOCK_WORDS, *TASK_WORDS, *LATER_WORDS,
        *UNITS.values(),
        "M", "S", "STOP", "W", "UNTIL", "FOREVER", *ACTS, "SHOW", "IF", "LOOP", "WHILE",
        "BREAK", "DEF", "START", "TRUE", "FALSE", "AND", "OR", "NOT", "TIME",
    )
)  # fmt: skip
