"""The messages of a robot that reads text, for wrong lines and for people.

Knows numbers and names; the catalogue `robot` has the words. Generated into the firmware, which has
room for one language. A number is never reused. Texts are ASCII, for any terminal.
"""

from __future__ import annotations

from tiniscript.base.languages import find_text

MAX_CHARACTERS = 40  # characters of a text

# Problems by number, starting with 1. A message begins with a column; that of RANGE also with the
# value's number and its least value, and ends with the largest. fmt: off
PROBLEMS = (
    "CHECKSUM",
    "CHARACTER",
    "NUMBER",
    "TOO_BIG",
    "SETUP",
    "PING",
    "INSTRUCTION",
    "UNKNOWN_WORD",
    "UNKNOWN_VALUE",
    "RESERVED",
    "SEPARATOR",
    "OPEN",
    "CLOSE",
    "VALUE",
    "COUNT",
    "RANGE",
    "WANTS_NUMBER",
    "WANTS_YES_NO",
    "COMPARE",
    "NOT",
    "KIND",
    "FOREVER_HERE",
    "UNTIL",
    "BLOCK",
    "BREAK",
    "DEF",
    "TAKEN",
    "LIMIT",
    "FULL",
    "LACKS",
    "COMMA",
    "ONE_TASK",
)
DEF_PROBLEMS = frozenset(("DEF", "ONE_TASK"))  # only robots whose reader knows DEF report these
# The firmware composes the text of MISTAKE and HELP.
REMARKS = (
    "OK",
    "OK_BUTTON",
    "LOST",
    "WAITING",
    "GIVEN_UP",
    "STOPPED",
    "LATCHED",
    "SAVING",
    "REFUSED",
    "NOT_OWNER",
    "HELD_BACK",
    "DONE",
    "FAULT",
    "MISTAKE",
    "HELLO",
    "HELP",
    "CUT",
    "LEVEL_UNO",
    "LEVEL_MEGA",
    "LEVEL_ESP32",
    "FAILED",
    "MUTE",
    "PAUSE",
    "ENTER",
    "NO_ZERO",
    "STARTED_AGAIN",
    "NO_KEYS",
)
# fmt: on

PROBLEM_NAMES = dict(enumerate(PROBLEMS, 1))


def problem_text(kind: str, name: str, language: str) -> str:
    """Return the text of a `problem` or a `remark`."""
    return find_text("robot", f"{kind}/{name}", language) or ""
