"""The work of an action, and of checking a text."""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import FrameType

from tiniscript import robots
from tiniscript.library.compiling import compile_source

ROBOT = robots.load("tinibot")


def count_calls(act: Callable[[], object]) -> int:
    """Return the number of calls of Python and C functions in an action."""
    calls = 0

    def count(frame: FrameType, event: str, argument: object) -> None:
        nonlocal calls
        calls += event in ("call", "c_call")

    getprofile_before = sys.getprofile()
    sys.setprofile(count)
    try:
        act()
    finally:
        sys.setprofile(getprofile_before)
    return calls


def calls_of_check(text: str) -> int:
    """Return the number of calls in the check of a text."""
    return count_calls(lambda: compile_source(text.encode(), ROBOT, "prog.ts", is_strict=False))
