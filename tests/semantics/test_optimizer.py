"""The optimiser: code that it shortens, and code that it must leave alone.

`test_agreement` shows on random programs that it never changes a trace or a fault.
"""

from __future__ import annotations

import pytest

from tests.support.ir_text import program_text
from tiniscript import check_text, robots
from tiniscript.semantics.optimizer import optimize_program

KIT = robots.load("tinibot").kit


def short(text: str) -> str:
    """Return the optimised program as text, without its start mode."""
    program = check_text(text, KIT).program
    assert program is not None
    return program_text(optimize_program(program)).split("\n", 1)[1]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("SHOW(-(2 - 5) / 4)", "Show 0.75\n"),
        ("SHOW(NOT TRUE)", "Show yes_no0\n"),
        # Faulting code is not optimized away.
        ("SHOW(1 / 0)", "Show 1 0 DIV\n"),
        ("SHOW(0 * (1 / 0))", "Show 0 1 0 DIV MUL\n"),
        # AND and OR
        ("SHOW(FALSE AND 1 / 0 > 1)", "Show yes_no0\n"),
        ("SHOW(TRUE AND TIME > 1)", "Show TIME 1 GT\n"),
        ("SHOW(1 / TIME > 1 AND FALSE)", "Show 1 TIME DIV 1 GT AND_LEFT yes_no0 AND\n"),
        ("SHOW(RANDOM(1, 6) > 3 OR TRUE)", "Show 1 6 RANDOM 3 GT OR_LEFT yes_no1 OR\n"),
        ("SHOW(NOT (1 / TIME > 1) AND FALSE)", "Show 1 TIME DIV 1 GT NOT AND_LEFT yes_no0 AND\n"),
        ("X = 1; SHOW(1 + 1 > X AND FALSE)", "Assign 0 1\nShow yes_no0\n"),
        # arms and loops that are never taken
        ("IF(1 < 2); S; ELSE; W(1); ENDIF", "Stop\n"),
        ("IF(FALSE); S; ELSEIF(TRUE); W(1); ELSE; W(2); ENDIF", "Move W 1\n"),
        ("LOOP(0.4); S; END_LOOP", ""),
        ("WHILE(FALSE); S; END_WHILE", ""),
        ("WHILE(TRUE); S; END_WHILE; W(1)", "Loop FOREVER\n  Stop\n"),
        ("LOOP(2); BREAK; S; END_LOOP", "Loop 2\n  Break\n"),
        ("DEF A; S; END_DEF; DEF B1; W(1); END_DEF; B1", "DEF B1\n  Move W 1\nCall 1\n"),
        # Readings stay, even if their users are removed.
        ("WHILE(DISTANCE > 1 AND FALSE); S; END_WHILE", "Read 2\n"),
        ("IF(FALSE); S; ELSEIF(DISTANCE > 1); W(1); ENDIF",
         "Read 2\nIf\n  arm () s2 1 GT\n    Move W 1\n  else\n"),
        ("IF(FALSE); S; ELSEIF(DISTANCE > 1); W(1); ELSEIF(TIME > 5); W(2); ENDIF",
         "Read 2\nIf\n  arm () s2 1 GT\n    Move W 1\n  arm () TIME 5 GT\n    Move W 2\n  else\n"),
        ("IF(TIME > 5); S; ELSEIF(DISTANCE > 1 OR TRUE); W(1); ELSE; W(2); ENDIF",
         "If\n  arm () TIME 5 GT\n    Stop\n  arm (2,) yes_no1\n    Move W 1\n  else\n"),
    ],
)  # fmt: skip
def test_the_optimizer_changes_each_form_as_expected(text: str, expected: str) -> None:
    assert short(text) == expected
