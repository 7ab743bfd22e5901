"""A comment in another language's style lasts to the end of its line and is not read."""

from __future__ import annotations

from itertools import product

import pytest

from tests.pupils.corpus import check
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.fixing import repair_program

SIGNS = ("# ", "#", "## ", "-- ", "<!-- ", "REM ", "rem ", "/* ")
NOTES = (
    "drive to the wall", "wall!", "turn 90 degrees, then (maybe) 3 more: 0,5 s", "si está cerca",
    "¡ojo!", "sensor < 10 => parar; e depois?", "while it goes, if it can", "for i in range", "a",
    '"hola"', "é o fim do LOOP", "don't",
)  # fmt: skip
PLACES = (
    "{}\nSI|F(2, 80)", "SI|{}\nF(2, 80)", "SI|F(2, 80) {}", "SI|F(2, 80); {}\nS",
    "SI|LOOP(3) {}\n  F(2, 80)\n  {}\nEND_LOOP {}", "SI|IF(DISTANCE < 10)\nS\nELSE {}\nW(1)\nENDIF",
    "SI|N = 3 {}\nW(N)\t{}", "SI|TASK\n{}\nBEEP(1, 440)\nEND_TASK\nF(2, 80)",
)  # fmt: skip


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("sign", SIGNS)
def test_a_comment_with_a_foreign_sign_is_reported_once(sign: str, place: str) -> None:
    for note in NOTES:
        wrong_text = place.replace("{}", sign + note)
        diagnostics = check(wrong_text)
        assert [diagnostic.code for diagnostic in diagnostics] == [codes.OTHER_NOTE] * len(
            diagnostics
        ), wrong_text
        right_text = place.replace("{}", f"// {note}")
        assert repair_program(wrong_text, check).text == right_text


@pytest.mark.parametrize("end", [" */", "*/", " -->", " **/"])
def test_the_closing_sign_of_a_comment_is_removed(end: str) -> None:
    opening = "<!-- " if ">" in end else "/* "
    wrong_text = f"SI|F(2, 80) {opening}go{end}\n{opening}wait 3{end}\nW(3)"
    assert repair_program(wrong_text, check).text == "SI|F(2, 80) // go\n// wait 3\nW(3)"


@pytest.mark.parametrize("sign", SIGNS)
@pytest.mark.parametrize("order", ["F(3, 60)", "IF(DISTANCE < 10);S;ENDIF", "avanza(3)"])
def test_a_possible_instruction_is_not_made_a_comment(sign: str, order: str) -> None:
    wrong_text = f"SI|F(2, 80) {sign}{order}"
    assert check(wrong_text)
    assert repair_program(wrong_text, check).text == wrong_text


@pytest.mark.parametrize("sign", ["#", "# ", "--"])
def test_a_sign_in_place_of_a_value_starts_no_comment(sign: str) -> None:
    values = ("F({}a, 80)", "F(2, {}a)", "X = {}a", "W(1 + {}a)", "IF(DISTANCE < {}a);S;ENDIF")
    for value, text_before in product(values, ("", "SI|", "S;")):
        assert codes.OTHER_NOTE not in [
            diagnostic.code for diagnostic in check(text_before + value.format(sign))
        ]
