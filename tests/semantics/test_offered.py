"""Offers of warnings are right: the repaired program has no mistake and no new warning."""

from __future__ import annotations

import re
from collections import Counter

import pytest

from tests.pupils.corpus import check, entries
from tests.support.advised_programs import ADVISED_PROGRAMS
from tiniscript.base.source import Source
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.diagnostics.rendering import message

WARNING_LINE = re.compile(r"[0-9]+ TS8")
PROGRAMS = [text for text, _ in ADVISED_PROGRAMS]
PROGRAMS += [entry.program for entry in entries() if any(map(WARNING_LINE.match, entry.messages))]
PROGRAMS += [
    program.format(move=move, q=question, d=question.replace("DISTANCE", "D"))
    for program in (
        "{move};IF({q});S;ENDIF",
        "LOOP(3);IF({q});S;ENDIF;{move};END_LOOP",
        "LOOP(3);{move};IF({q});R(1, 60);ENDIF;END_LOOP",
        "WHILE({q});{move};END_WHILE",
        "{move} UNTIL({q})",
        "D = DISTANCE;{move} UNTIL({d})",
        "D = DISTANCE;WHILE({d});{move};END_WHILE",
        "D = DISTANCE;LOOP(3);{move};IF({d});S;ENDIF;END_LOOP",
    )
    for move in ("F(5, 60)", "B(5, 60)")
    for question in (
        *(f"DISTANCE {sign} {n}" for sign in ("<", ">=", "=", "!=") for n in (0, 20, 400)),
        "20 > DISTANCE",
        "NOT (DISTANCE < 20)",
        "DISTANCE - 5 < 20",
        "DISTANCE < 20 AND LIGHT_L > 3",
        "DISTANCE > 20 OR DISTANCE = 5",
    )
]
# A question of no use becomes one of use, which is looked at then; its variable is left over.
CODES_UNCOVERED = {
    codes.FROZEN_UNTIL: {codes.UNUSED_VARIABLE},
    codes.FROZEN_WHILE: {codes.UNUSED_VARIABLE, codes.LATE_CHECK, codes.IDLE_STOP},
}


def repair(text: str, warning: Diagnostic) -> str:
    """Return a program with the repair of a warning in its place; "" if it offers none."""
    fix = warning.values.get("fix", "")
    start, end = warning.place or warning.span
    if not fix:
        return ""
    if warning.code is codes.IDLE_STOP:
        move, text_after = warning.values["move"], warning.values["next"]
        start = text.rfind(move, 0, start) if move else text.index(text_after, end)
        end = start + len(move or text_after)
    elif warning.code is codes.FROZEN_WHILE:
        brackets = re.compile(r"\w+\((?:[^()]|\([^()]*\))*\)").match(text, start)
        end = brackets.end() if brackets else end
    return f"{text[:start]}{fix}{text[end:]}"


def repairs_with_new_messages(text: str) -> list[tuple[str, str]]:
    """Return the repairs of a program's warnings that make a new warning or mistake, with those."""
    diagnostics = check(text)
    counter_before = Counter(diagnostic.code for diagnostic in diagnostics)
    wrong_repairs = []
    for diagnostic in diagnostics:
        text_after = "" if diagnostic.is_mistake else repair(text, diagnostic)
        new_codes = (
            Counter(diagnostic.code for diagnostic in check(text_after)) - counter_before
            if text_after
            else Counter()
        )
        new_codes -= Counter(CODES_UNCOVERED.get(diagnostic.code, ()))
        wrong_repairs += [(text_after, code.number) for code in new_codes]
    return wrong_repairs


def test_no_repair_of_a_warning_makes_a_new_one() -> None:
    offered = [(text, repair) for text in PROGRAMS for repair in repairs_with_new_messages(text)]
    assert not offered, f"{len(offered)}, the first: {offered[0]}"


@pytest.mark.parametrize(
    ("text", "fix"),
    [
        ("B(5, 60);IF(DISTANCE > 20);S;ENDIF", "After B(5, 60), the robot is standing still"),
        ("F(5, 60);IF(DISTANCE = 20);S;ENDIF", "After F(5, 60), the robot is standing still"),
        ("IF(DISTANCE > 20);S;ENDIF;F(5, 60)", "put F(5, 60) after an ELSE."),
        ("F(5, 60);IF(DISTANCE < 20);S;ENDIF", "F(5, 60) UNTIL(DISTANCE < 20)"),
        ("D = DISTANCE;B(5, 60) UNTIL(D < 20)",
            "Check a sensor in UNTIL, as in UNTIL(DISTANCE > 2"),
        ("D = DISTANCE;B(5, 60) UNTIL(D > 20)", "B(5, 60) UNTIL(DISTANCE > 20)"),
        ("F(5, 60) UNTIL(DISTANCE > 0)", "Use a time to end the move"),
        ("F(5, 60);IF(NOT (DISTANCE < 20));S;ENDIF", "After F(5, 60), the robot is standing still"),
        ("D = 2;LOOP(3);F(5, 60);IF(DISTANCE < D);S;ENDIF;END_LOOP", "F(5, 60) UNTIL(DISTANCE < D"),
        ("D = DISTANCE;F(5, 60) UNTIL(NOT (D < 20))", "Check a sensor in UNTIL"),
        ("F(007, 60)", "Write 7, or write the seconds with a decimal point."),
        ("LOOP(VECES);S;END_LOOP", "give it a value first: VECES = 5"),
        ("BEEP(1, NOTA)", "Which number is NOTA?"),
    ],
)  # fmt: skip
def test_the_expected_fix_is_offered(text: str, fix: str) -> None:
    offers = [message(diagnostic, Source(text), "en").fix for diagnostic in check(text)]
    assert fix in offers[-1]


@pytest.mark.parametrize(
    ("text", "rows"),
    [
        ("F(1, 80) // voy; W(2) // compro; B(2, 80) // regreso", ["W(2)", "B(2, 80)"]),
        ("F(1, 80) // voy; W(2); compro; STOP", ["W(2)", "STOP"]),
    ],
)
def test_all_instructions_in_a_comment_are_offered(text: str, rows: list[str]) -> None:
    (warning,) = check(text)
    assert warning.values["rest"] == "; ".join(rows)
    assert check("\n".join(["F(1, 80) // voy", *rows])) == []
