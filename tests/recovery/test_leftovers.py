"""Superfluous text in an instruction gets its own name, in each place."""

from __future__ import annotations

import pytest

from tests.pupils.corpus import check
from tiniscript.base.source import Source, apply_edits
from tiniscript.diagnostics.fixing import edits_of, repair_program
from tiniscript.diagnostics.rendering import message

WORDS = ("OUT", "NOW", "here", "ahora", "aquí", "XYZ", "here now")
PLACES = (
    "SI|LOOP(2);W(1);{};END_LOOP", "SI|LOOP(2)\n  {}\nEND_LOOP", "SI|LOOP(2);{};F(1, 60);END_LOOP",
    "SI|LOOP(2);IF(DISTANCE < 9);{};ELSE;W(1);ENDIF;END_LOOP",
)  # fmt: skip


@pytest.mark.parametrize("words", WORDS)
@pytest.mark.parametrize("order", ["BREAK", "S", "STOP"])
@pytest.mark.parametrize("place", PLACES)
def test_words_after_a_command_without_values_are_removed(
    place: str, order: str, words: str
) -> None:
    wrong_text = place.format(f"{order} {words}")
    (diagnostic,) = [diagnostic for diagnostic in check(wrong_text) if diagnostic.is_mistake]
    assert message(diagnostic, Source(wrong_text), "en").fix == f"Remove {words}"
    assert apply_edits(wrong_text, edits_of(diagnostic) or []) == place.format(order)
    assert repair_program(wrong_text, check).text == wrong_text


@pytest.mark.parametrize("words", WORDS)
@pytest.mark.parametrize("end", ["END_LOOP", "END_WHILE"])
def test_words_after_an_end_are_removed(end: str, words: str) -> None:
    head = {"END_LOOP": "LOOP(2)", "END_WHILE": "WHILE(DISTANCE > 9)"}[end]
    for tail in ("", ";S", "\nW(1)"):
        wrong_text = f"SI|{head};F(1, 60);{end} {words}{tail}"
        (diagnostic,) = [diagnostic for diagnostic in check(wrong_text) if diagnostic.is_mistake]
        assert apply_edits(wrong_text, edits_of(diagnostic) or []) == wrong_text.replace(
            f" {words}", ""
        )


@pytest.mark.parametrize(
    "text",
    ["S F(1, 60)", "S vuelta", "S DISTANCE", "DEF PASO;W(1);END_DEF;S PASO", "S otra vez", "S 3",
     "V = 3;S V", "STOP UNTIL(DISTANCE > 9)", "S stop", "S // now"],
)  # fmt: skip
def test_a_possible_command_or_value_is_not_a_leftover(text: str) -> None:
    assert not any(diagnostic.values.get("needless") for diagnostic in check(f"SI|{text}"))


@pytest.mark.parametrize(
    "text_before", ["R(1, 60)", "S", "LOOP(2);W(1);END_LOOP", "SHOW(DISTANCE)"]
)
@pytest.mark.parametrize("sign", ["SI|", " SI|", "SI|  ", " si | "])
@pytest.mark.parametrize("text_after", ["B(2, 80)", "IF(DISTANCE < 9);S;ENDIF", "S"])
def test_a_second_start_behind_an_instruction_is_a_separator(
    text_before: str, sign: str, text_after: str
) -> None:
    if sign[0] != " " and not text_before.endswith(")"):
        return  # SSI is a single word
    text = f"SI|F(2, 80);{text_before}{sign}{text_after};W(1)"
    assert repair_program(text, check).text == f"SI|F(2, 80);{text_before}; {text_after};W(1)"


@pytest.mark.parametrize("separator", [";", "\n"])
def test_a_task_that_is_called_has_no_name_and_begins_by_itself(separator: str) -> None:
    wrong_text = separator.join(
        ("SI|TASK siren", "BEEP(1, 440)", "END_TASK", "START siren", "F(4, 70)")
    )
    fixes = [message(diagnostic, Source(wrong_text), "en").fix for diagnostic in check(wrong_text)]
    assert fixes == ["TASK", "Remove siren"]


@pytest.mark.parametrize("word", ["Fim", "FIM.", "Fin;", "end", "End."])
@pytest.mark.parametrize("above", ["F(2, 80)", "Espere(1)", "Br(2, 80)", "R(1 60);S"])
def test_a_final_end_is_superfluous_whatever_else_is_wrong(above: str, word: str) -> None:
    wrong_text = f"SI|W(1)\n{above}\n{word}"
    assert "TS044" in {diagnostic.code.number for diagnostic in check(wrong_text)}
    for head, end in (("LOOP(2)", "END_LOOP"), ("IF(DISTANCE < 9)", "ENDIF")):
        block = f"SI|{head}\nF(2, 80)\n{word.rstrip('.;')}"
        assert repair_program(block, check).text == f"SI|{head}\nF(2, 80)\n{end}"
