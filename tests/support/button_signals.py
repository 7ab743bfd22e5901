"""The firmware's code of the button alone: its reaction to edges on its wire."""

from __future__ import annotations

import subprocess
from collections.abc import Iterable, Sequence

from tests.machines.host import FLAGS, SOURCES, compile_program
from tests.support.casefile import ROOT

ButtonEvents = list[tuple[int, str]]  # time in us, and P, H or R


def button_events(cases: Iterable[tuple[int, int, Sequence[int]]]) -> list[ButtonEvents]:
    """Return the button's events in each case: the turn, the first look, and the edges."""
    button = SOURCES / "src" / "boards" / "button.cpp"
    program = compile_program([button, ROOT / "tests" / "button" / "main.cpp"], FLAGS)
    lines = "\n".join(
        " ".join(map(str, (turn, first_edge, *edges))) for turn, first_edge, edges in cases
    )
    completed = subprocess.run(
        [program], input=lines + "\n", capture_output=True, text=True, check=True
    )
    rows = [row.split() for row in completed.stdout.splitlines()]
    return [list(zip(map(int, row[::2]), row[1::2], strict=True)) for row in rows]
