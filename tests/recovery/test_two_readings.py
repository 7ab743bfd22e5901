"""Two readings are two offers, and the one that changes no movement comes first."""

from __future__ import annotations

import re

import pytest

from tests.pupils.corpus import check
from tiniscript.base.source import Source
from tiniscript.diagnostics.fixing import edits_of, repair_program
from tiniscript.diagnostics.rendering import message

LAST_PLACES = (
    "{}", "SI|{}", "W(1);{}", "W(1)\n{}\nW(1)", "IF(DISTANCE < 9)\n{}\nENDIF",
    "DEF A1\n{}\nEND_DEF\nA1", "TASK\n{}\nEND_TASK",
)  # fmt: skip
EARLIER_PLACES = ("{};W(1)", "SI|W(1);{};S", "IF(DISTANCE < 9);{};ENDIF")
# Text that may be a note, and its other meaning.
PROGRAM_BY_NOTE = {
    "avanza otra vez": "LOOP(2);F(3, 50);END_LOOP", "again": "LOOP(2);F(3, 50);END_LOOP",
    "siempre": "LOOP(FOREVER);F(3, 50);END_LOOP", "al reves": "B(3, 50)",
    "gira a la derecha": "F(3, 50);R(2, 50)", "turn right": "F(3, 50);R(2, 50)",
    "vira para a direita": "F(3, 50);R(2, 50)",
}  # fmt: skip
IFS = (
    ("DISTANCE < 20", "DISTANCE > 20"), ("DISTANCE < 20", "DISTANCE >= 20"),
    ("DISTANCE > 35", "DISTANCE < 35"), ("LIGHT_L = 5", "LIGHT_L <> 5"), ("KEY_A", "NOT KEY_A"),
)  # fmt: skip
SURROUNDINGS = ("{}", "SI|W(1);{}", "{};S", "LOOP(3);{};END_LOOP", "DEF A1;{};END_DEF;A1")


@pytest.mark.parametrize("language", ["en", "es", "pt"])
@pytest.mark.parametrize("words", PROGRAM_BY_NOTE)
def test_possible_comments_are_read_as_comments_first(words: str, language: str) -> None:
    for place in (*LAST_PLACES, *EARLIER_PLACES):
        text = place.format(f"F(3, 50) {words}")
        diagnostic = next(
            diagnostic for diagnostic in check(text) if diagnostic.code.number in ("TS085", "TS074")
        )
        fix = message(diagnostic, Source(text), language).fix
        note = f"F(3, 50) // {words}" if place in LAST_PLACES else f"// {words}"
        assert 0 < fix.find(note) < fix.find(PROGRAM_BY_NOTE[words]), text
        assert repair_program(text, check).text == text


@pytest.mark.parametrize("separator", [";", "\n"])
@pytest.mark.parametrize("template", SURROUNDINGS)
@pytest.mark.parametrize(("condition_text", "else_condition"), IFS)
def test_an_else_with_the_opposite_condition_needs_none(
    condition_text: str, else_condition: str, template: str, separator: str
) -> None:
    body = separator.join(
        (f"IF({condition_text})", "B(1, 60)", f"ELSE({else_condition})", "F(1, 60)", "ENDIF")
    )
    wrong_text = template.format(body)
    diagnostic = next(
        diagnostic for diagnostic in check(wrong_text) if diagnostic.code.number == "TS039"
    )
    assert (diagnostic.values["fix"], diagnostic.values["rival"]) == (
        "ELSE",
        f"ELSEIF({else_condition})",
    ), wrong_text
    (edit,) = edits_of(diagnostic) or []
    assert wrong_text[slice(*edit.span)] == f"ELSE({else_condition})" and edit.text == "ELSE"


@pytest.mark.parametrize("template", SURROUNDINGS)
@pytest.mark.parametrize("else_condition", ["DISTANCE > 40", "LIGHT_L > 20", "DISTANCE < 10"])
def test_an_else_with_another_condition_becomes_elseif(template: str, else_condition: str) -> None:
    wrong_text = template.format(
        f"IF(DISTANCE < 20);B(1, 60);ELSE({else_condition});F(1, 60);ENDIF"
    )
    diagnostic = next(
        diagnostic for diagnostic in check(wrong_text) if diagnostic.code.number == "TS039"
    )
    assert diagnostic.values["fix"] == f"ELSEIF({else_condition})"


@pytest.mark.parametrize("first_body", ["F(3, 60)", "L(2, 40)"])
@pytest.mark.parametrize("second_body", ["B(3, 60)", "F(1, 30)"])
def test_tasks_that_drive_may_be_meant_sequentially(first_body: str, second_body: str) -> None:
    text = f"SI|TASK;{first_body};END_TASK;TASK;{second_body};END_TASK"
    (warning,) = check(text)
    assert re.search(rf"{re.escape(first_body)};{re.escape(second_body)}", warning.values["after"])
