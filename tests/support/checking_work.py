"""How much work the check of a text is."""

from __future__ import annotations

import sys
from types import FrameType

from tiniscript import robots
from tiniscript.library.compiling import compile_source

ROBOT = robots.load("tinibot")


def calls_of_check(text: str) -> int:
    """Return how many calls, of Python's functions and C's, the check of a text makes."""
    calls = 0

    def count(frame: FrameType, event: str, what: object) -> None:
        nonlocal calls
        calls += event in ("call", "c_call")

    before = sys.getprofile()
    sys.setprofile(count)
    try:
        compile_source(text.encode(), ROBOT, "prog.ts", is_strict=False)
    finally:
        sys.setprofile(before)
    return calls
