"""A text that is twice as long takes twice the work: nobody waits for a hostile one."""

from __future__ import annotations

import sys
from types import FrameType

import pytest

from tiniscript import robots
from tiniscript.library.compiling import compile_source

ROBOT = robots.load("tinibot")
LEAST = 4_000  # pieces


def work(text: str) -> int:
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


@pytest.mark.parametrize(
    ("begin", "piece", "end"),
    [
        ("", "1+", "1"), ("", "1+", ""), ("", "SI|", ""), ("", "SI|\n", ""),
        ("", "SI|", "F(1, 80)"),
        ("SI|SHOW(", "1+", "1)"), ("SI|F(", "1+", "1)"), ("SI|IF(", "1+", "1)"), ("X = ", "1+", ""),
    ],
)  # fmt: skip
def test_a_long_text_takes_no_more_than_in_proportion(begin: str, piece: str, end: str) -> None:
    short, long = (work(f"{begin}{piece * count}{end}") for count in (LEAST, 4 * LEAST))
    assert long < 4.8 * short
