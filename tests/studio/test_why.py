"""Why a program was at an instruction: the conditions around it, with their readings."""

from __future__ import annotations

import json
import random
import re
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from tests.support.node import in_node
from tiniscript.studio.checking import check

SCRIPT = Path(__file__).with_name("why_in_node.mjs")
VALUES = {"DISTANCE": "12.3", "N": "4", "KEY_UP": "TRUE"}
IF_PROGRAM = "IF(DISTANCE < 10)\nB(1, 10)\nELSEIF(N > 3)\nF(1, 20)\nELSE\nF(1, 30)\nENDIF"
DISTANCE, N = ["DISTANCE", "12.3"], ["N", "4"]
FIRST_CONDITION, SECOND_CONDITION = [1, "DISTANCE < 10", [DISTANCE]], [3, "N > 3", [N]]


def explanations(*cases: tuple[str, str]) -> list[Any]:
    """Return the explanations of programs, each at the first instruction with a text."""
    rows = []
    for text, expected_text in cases:
        program = check(text.encode(), "tinibot", "en")
        assert program.image, text
        lines = text.split("\n")
        places = [list(place) for place in program.places]
        index = next(
            place[0]
            for place in places
            if lines[place[1] - 1][place[2] - 1 :].startswith(expected_text)
        )
        rows.append({"text": text, "places": places, "at": index, "values": VALUES})
    return [json.loads(row) for row in in_node(SCRIPT, json.dumps(rows))]


@pytest.mark.parametrize(
    ("text", "expected_text", "values"),
    [
        (IF_PROGRAM, "B(1, 10)", [[1, "DISTANCE < 10", [], True]]),  # the sensor was read again
        (IF_PROGRAM, "F(1, 20)", [[*FIRST_CONDITION, False], [*SECOND_CONDITION, True]]),
        (IF_PROGRAM, "F(1, 30)", [[*FIRST_CONDITION, False], [3, "N > 3", [], False]]),
        (IF_PROGRAM, "IF", [[*FIRST_CONDITION, False]]),
        (IF_PROGRAM + "\nB(1, 40)", "B(1, 40)", []),
        ("// IF(N > 1)\nW(1)", "W(1)", []),
        ("WHILE(MIN(N, 2) < 3)\nN = N + 1\nF(9, 50) UNTIL(DISTANCE < 15)\nEND_WHILE", "F(9",
         [[1, "MIN(N, 2) < 3", [N], True], [3, "DISTANCE < 15", [DISTANCE], True]]),
        ("F(9, 50) UNTIL(KEY_UP AND NOT (N > 5 OR DISTANCE > N))", "F(9",
         [[1, "KEY_UP AND NOT (N > 5 OR DISTANCE > N)", [["KEY_UP", "TRUE"], N, DISTANCE], False]]),
        ("F(9, 50) UNTIL(RANDOM(1, 6) > N)", "F(9", [[1, "RANDOM(1, 6) > N", [N], None]]),
        ("F(9, 50) UNTIL(N - 3.7 = 0.3)", "F(9", [[1, "N - 3.7 = 0.3", [N], True]]),
        ("F(9, 50) UNTIL(N / 3 * 3 = N)", "F(9", [[1, "N / 3 * 3 = N", [N], None]]),
        ("F(9, 50) UNTIL(N = 4 OR RANDOM(1, 6) > 3)", "F(9",
         [[1, "N = 4 OR RANDOM(1, 6) > 3", [N], True]]),
        ("DEF GO;IF(DISTANCE > 3);S;ENDIF;END_DEF\nGO", "GO", []),
    ],
)  # fmt: skip
def test_enclosing_conditions_are_explained_with_their_values(
    text: str, expected_text: str, values: list[Any]
) -> None:
    assert explanations((f"N = 0;{text}", expected_text))[0]["told"] == values


def test_any_nesting_is_explained_from_the_outside() -> None:
    for seed in range(12):
        rng = random.Random(seed)
        text, expected_texts = "W(0.5)", list[Any]()
        for depth in range(rng.randint(1, 5)):
            head, end = rng.choice((("IF", "ENDIF"), ("WHILE", "END_WHILE")))
            choice_before = rng.choice(
                (
                    "",
                    "IF(DISTANCE > 1);S;ENDIF\n",
                    "WHILE(DISTANCE > 2);S;END_WHILE\n",
                    "S // IF(DISTANCE > 3) (and more\n",
                )
            )
            is_else = head == "IF" and rng.random() < 0.5
            body = f"S\nELSE\n{text}" if is_else else text
            text = f"{choice_before}{head}(DISTANCE < {depth})\n{body}\n{end}"
            expected_texts.insert(0, [f"DISTANCE < {depth}", not is_else])
        assert [
            [row[1], row[3]] for row in explanations((text, "W(0.5)"))[0]["told"]
        ] == expected_texts, text


def expression(rng: random.Random, depth: int, *, is_question: bool) -> str:
    """Return one in brackets as few as can be, of numbers or of yes and no."""
    if is_question:
        if not depth:
            return rng.choice(("KEY_UP", "TRUE", "FALSE"))
        form = rng.choice(("{q} AND {q}", "{q} OR {q}", "NOT {q}", "({q})", *["{n} {c} {n}"] * 4))
    elif not depth:
        return rng.choice(("N", "DISTANCE", "2", "0.1", "0.2", "-3"))
    else:
        form = rng.choice(("{n} + {n}", "{n} - {n}", "({n})", "-{n}", "MIN({n}, {n})", "ABS({n})"))
    while hole := next((hole for hole in ("{q}", "{n}", "{c}") if hole in form), ""):
        filling = (
            rng.choice(("<", "<=", ">", ">=", "=", "<>"))
            if hole == "{c}"
            else expression(rng, rng.randrange(depth), is_question=hole == "{q}")
        )
        form = form.replace(hole, filling, 1)
    return form


def test_the_explained_result_follows_from_the_values() -> None:
    rng = random.Random(3)
    words = {"AND": "and", "OR": "or", "NOT": "not", "=": "==", "<>": "!=", "TRUE": "1 == 1"}
    words |= {"FALSE": "1 == 2", "KEY_UP": "1 == 1", "ABS": "abs", "MIN": "min", **{
        name: value for name, value in VALUES.items() if name != "KEY_UP"}}  # fmt: skip
    conditions = [expression(rng, 3, is_question=True) for _ in range(120)]
    rows = explanations(
        *((f"N = 0;F(9, 50) UNTIL({condition})", "F(9") for condition in conditions)
    )
    for condition, row in zip(conditions, rows, strict=True):
        python = re.sub(r"[A-Z_]+|<>|(?<![<>])=", lambda match: words[match[0]], condition)
        exact = re.sub(r"\d+(?:\.\d+)?", r"Fraction('\g<0>')", python)
        assert row["told"][0][3] == eval(exact, {"Fraction": Fraction}), condition


def test_the_explanation_names_the_task_of_an_instruction() -> None:
    text = "W(1)\nTASK\nF(1, 20)\nEND_TASK\nWHEN(DISTANCE < 4)\nS\nEND_WHEN"
    rows = explanations((text, "W(1)"), (text, "F(1, 20)"), (text, "S"), (text, "WHEN"))
    assert [row["tasks"] for row in rows] == [[], [2], [5], [5]]
    assert [row["bodies"] for row in rows] == [[], [2], [5], []], "a WHEN that waits has not begun"
