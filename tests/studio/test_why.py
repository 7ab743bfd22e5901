"""Why a program was at an instruction: the conditions around it, with what was read."""

from __future__ import annotations

import json
import random
from pathlib import Path
from typing import Any

import pytest

from tests.support.node import in_node
from tiniscript.studio.checking import check

SCRIPT = Path(__file__).with_name("why_in_node.mjs")
VALUES = {"DISTANCE": "12.3", "N": "4"}
ARMS = "IF(DISTANCE < 10)\nB(1, 10)\nELSEIF(N > 3)\nF(1, 20)\nELSE\nF(1, 30)\nENDIF"
ONE, TWO = [1, "DISTANCE < 10", "12.3 < 10"], [3, "N > 3", "4 > 3"]


def explanations(*cases: tuple[str, str]) -> list[Any]:
    """Return what is told of programs, each at the first instruction with a text."""
    rows = []
    for text, wanted in cases:
        program = check(text.encode(), "tinibot", "en")
        assert program.image, text
        lines = text.split("\n")
        places = [list(place) for place in program.places]
        at = next(
            place[0] for place in places if lines[place[1] - 1][place[2] - 1 :].startswith(wanted)
        )
        rows.append({"text": text, "places": places, "at": at, "values": VALUES})
    return [json.loads(row) for row in in_node(SCRIPT, json.dumps(rows))]


@pytest.mark.parametrize(
    ("text", "wanted", "found"),
    [
        (ARMS, "B(1, 10)", [[*ONE, True]]),
        (ARMS, "F(1, 20)", [[*ONE, False], [*TWO, True]]),
        (ARMS, "F(1, 30)", [[*ONE, False], [*TWO, False]]),
        (ARMS, "IF", [[*ONE, None]]),
        (ARMS + "\nB(1, 40)", "B(1, 40)", []),
        ("// IF(N > 1)\nW(1)", "W(1)", []),
        ("WHILE(MIN(N, 2) < 3)\nN = N + 1\nF(9, 50) UNTIL(DISTANCE < 15)\nEND_WHILE", "F(9",
         [[1, "MIN(N, 2) < 3", "MIN(4, 2) < 3", True], [3, "DISTANCE < 15", "12.3 < 15", None]]),
        ("DEF GO;IF(DISTANCE > 3);S;ENDIF;END_DEF\nGO", "GO", []),
    ],
)  # fmt: skip
def test_the_conditions_around_an_instruction_are_told_with_their_values(
    text: str, wanted: str, found: list[Any]
) -> None:
    assert explanations((f"N = 0;{text}", wanted))[0]["told"] == found


def test_any_nesting_is_told_from_the_outside() -> None:
    for seed in range(12):
        rng = random.Random(seed)
        text, wanted = "W(0.5)", list[Any]()
        for depth in range(rng.randint(1, 5)):
            head, end = rng.choice((("IF", "ENDIF"), ("WHILE", "END_WHILE")))
            before = rng.choice(
                ("", "IF(DISTANCE > 1);S;ENDIF\n", "WHILE(DISTANCE > 2);S;END_WHILE\n")
            )
            is_else = head == "IF" and rng.random() < 0.5
            body = f"S\nELSE\n{text}" if is_else else text
            text = f"{before}{head}(DISTANCE < {depth})\n{body}\n{end}"
            wanted.insert(0, [f"DISTANCE < {depth}", not is_else])
        assert [[row[1], row[3]] for row in explanations((text, "W(0.5)"))[0]["told"]] == wanted, (
            text
        )


def test_the_task_is_told_that_an_instruction_is_in() -> None:
    text = "W(1)\nTASK\nF(1, 20)\nEND_TASK\nWHEN(DISTANCE < 4)\nS\nEND_WHEN"
    rows = explanations((text, "W(1)"), (text, "F(1, 20)"), (text, "S"))
    assert [row["tasks"] for row in rows] == [[], [2], [5]]
