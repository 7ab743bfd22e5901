"""How much work something is, and the check of a text."""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import FrameType

from tiniscript import robots
from tiniscript.library.compiling import compile_source

ROBOT = robots.load("tinibot")


def count_calls(act: Callable[[], object]) -> int:
    """Return how many calls, of Python's functions and C's, something makes."""
    calls = 0

    def count(frame: FrameType, event: str, what: object) -> None:
        nonlocal calls
        calls += event in ("call", "c_call")

    before = sys.getprofile()
    sys.setprofile(count)
    try:
        act()
    finally:
        sys.setprofile(before)
    return calls


def calls_of_check(text: str) -> int:
    """Return how many calls the check of a text makes."""
    return count_calls(lambda: compile_source(text.encode(), ROBOT, "prog.ts", is_strict=False))
