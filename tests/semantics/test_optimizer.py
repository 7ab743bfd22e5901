"""The optimiser: what it makes shorter, and what it must leave alone.

That it never changes a trace or a fault, `test_agreement` shows on random programs.
"""

from __future__ import annotations

import pytest

from tiniscript import check_text, robots
from tiniscript.semantics.ir import program_text
from tiniscript.semantics.lint import advice
from tiniscript.semantics.optimizer import optimized

KIT = robots.load("tinibot").kit


def short(text: str) -> str:
    """Return the optimised program as text, without its start mode."""
    program = check_text(text, KIT).program
    assert program is not None
    return program_text(optimized(program)).split("\n", 1)[1]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("SHOW(1 + 2 * 3)", "Show 7\n"),
        ("SHOW(-(2 - 5) / 4)", "Show 0.75\n"),
        ("SHOW(ROUND(2.345, 1 + 1))", "Show 2.35\n"),
        ("SHOW(NOT 1 > 2)", "Show yes_no1\n"),
        ("X = 1; SHOW(X + 1 + 2)", "Assign 0 1\nShow v0 1 ADD 2 ADD\n"),
        # what faults is left to fault
        ("SHOW(1 / 0)", "Show 1 0 DIV\n"),
        ("SHOW(2147483 + 1)", "Show 2147483 1 ADD\n"),
        ("SHOW(0 * (1 / 0))", "Show 0 1 0 DIV MUL\n"),
        # AND and OR
        ("SHOW(FALSE AND 1 / 0 > 1)", "Show yes_no0\n"),
        ("SHOW(TRUE AND TIME > 1)", "Show TIME 1 GT\n"),
        ("X = TRUE; SHOW(X AND FALSE)", "Assign 0 yes_no1\nShow yes_no0\n"),
        ("SHOW(1 / TIME > 1 AND FALSE)", "Show 1 TIME DIV 1 GT AND_LEFT yes_no0 AND\n"),
        ("SHOW(RANDOM(1, 6) > 3 OR TRUE)", "Show 1 6 RANDOM 3 GT OR_LEFT yes_no1 OR\n"),
        # arms and loops that are never taken
        ("IF(1 > 2); S; ENDIF", ""),
        ("IF(1 < 2); S; ELSE; W(1); ENDIF", "Stop\n"),
        ("IF(FALSE); S; ELSEIF(TRUE); W(1); ELSE; W(2); ENDIF", "Move W 1\n"),
        ("LOOP(0.4); S; END_LOOP", ""),
        ("WHILE(FALSE); S; END_WHILE", ""),
        ("WHILE(TRUE); S; END_WHILE; W(1)", "Loop FOREVER\n  Stop\n"),
        ("LOOP(2); BREAK; S; END_LOOP", "Loop 2\n  Break\n"),
        ("DEF A; S; END_DEF; DEF B1; W(1); END_DEF; B1", "DEF B1\n  Move W 1\nCall 0\n"),
        # readings stay, whatever becomes of what needs them
        ("IF(DISTANCE > 1 AND FALSE); S; ENDIF", "Read 2\n"),
        ("WHILE(DISTANCE > 1 AND FALSE); S; END_WHILE", "Read 2\n"),
        ("IF(FALSE); S; ELSEIF(DISTANCE > 1); W(1); ENDIF",
         "Read 2\nIf\n  arm () s2 1 GT\n    Move W 1\n  else\n"),
    ],
)  # fmt: skip
def test_what_becomes_of_it(text: str, expected: str) -> None:
    assert short(text) == expected


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("LOOP(FOREVER);W(1);END_LOOP;S", "TS802"),
        ("LOOP(2);BREAK;S;END_LOOP", "TS802"),
        ("IF(DISTANCE < 5);LOOP(FOREVER);W(1);END_LOOP;ELSE;LOOP(FOREVER);W(1);END_LOOP;ENDIF;S",
         "TS802"),
        ("F(0, 80)", "TS803"),
        ("L(2 - 2, 80)", "TS803"),
        ("LOOP(FOREVER);X = DISTANCE;SHOW(X);END_LOOP", "TS804"),
        ("WHILE(TRUE);DISTANCE;END_WHILE", "TS804"),
        ("DEF A;SHOW(1);END_DEF;LOOP(FOREVER);A;END_LOOP", "TS804"),
        ("LOOP(3);F(1, 80);IF(DISTANCE < 10);S;ENDIF;END_LOOP", "TS805"),
        ("LOOP(3);B(0.5, 80);DISTANCE;IF(5 > DISTANCE);S;ENDIF;END_LOOP", "TS805"),
        ("X = 5", "TS806"),
        ("DEF A;S;END_DEF", "TS807"),
        ("SHOW(5 % (3 - 3))", "TS808"),
        ("IF(2147483 * 2 > DISTANCE);S;ENDIF", "TS808"),
    ],
)  # fmt: skip
def test_advice(text: str, code: str) -> None:
    found = check_text(text, KIT)
    assert found.is_right
    assert [problem.code.number for problem in found.problems] == [code]


@pytest.mark.parametrize(
    "text",
    [
        "LOOP(FOREVER);W(1);IF(DISTANCE < 5);BREAK;ENDIF;END_LOOP;S",
        "F(0, 80) UNTIL(DISTANCE < 5)",
        "LOOP(FOREVER);M(LIGHT_L / 10, LIGHT_R / 10);END_LOOP",
        "DEF A;W(1);END_DEF;LOOP(FOREVER);A;END_LOOP",
        "LOOP(3);F(0.4, 80);IF(DISTANCE < 10);S;ENDIF;END_LOOP",
        "LOOP(3);F(1, 80);IF(LIGHT_L < 10);S;ENDIF;END_LOOP",
        "LOOP(3);F(1, 80) UNTIL(DISTANCE < 10);IF(DISTANCE < 10);S;ENDIF;END_LOOP",
        "F(1, 80);IF(DISTANCE < 10);S;ENDIF",
        "X = 5;SHOW(X)",
        "N = 3;WHILE(N > 0);N = N - 1;END_WHILE",
        "X = 0;SHOW(X / X)",
        "SHOW(FALSE AND 1 / 0 > 2)",
    ],
)
def test_no_advice(text: str) -> None:
    assert check_text(text, KIT).problems == []


def test_advice_is_for_right_programs_alone() -> None:
    wrong = check_text("X = 5;S = 5", KIT)
    assert [problem.is_mistake for problem in wrong.problems] == [True]
    assert wrong.program is not None
    assert advice(wrong.program, KIT)
