"""A missing number is taken from the program, or marked as an example."""

from __future__ import annotations

import pytest

from tests.pupils.corpus import check
from tiniscript.base.source import Source
from tiniscript.diagnostics.rendering import message

PLACES = (
    "SI|F(3, {p}); {}; F(3, {p})", "F(3, {p});{}", "{};F(3, {p})", "F(3, {p})\n{}\nB(1, {p})",
    "F(3, {p});IF(DISTANCE < 9);{};ENDIF", "DEF A1;{};END_DEF;A1;F(3, {p})",
    "TASK;{};END_TASK;W(1);F(3, {p})",
)  # fmt: skip
SURROUNDINGS = (
    "SI|{}",
    "{}",
    "W(3);{}",
    "{};W(3)",
    "IF(DISTANCE < 9);{};ENDIF",
    "DEF A1;{};END_DEF;A1",
)
SAID = {"en": "is an example", "es": "es solo un ejemplo", "pt": "é só um exemplo"}


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("word", ["F", "B", "L", "R"])
def test_a_missing_power_is_copied_from_other_moves(word: str, place: str) -> None:
    for power in ("50", "35"):
        wrong_text = place.format(f"{word}(1)", p=power)
        diagnostic = next(diagnostic for diagnostic in check(wrong_text) if diagnostic.is_mistake)
        assert diagnostic.values["fix"] == f"{word}(1, {power})", wrong_text
        assert not diagnostic.values.get("sample"), wrong_text


@pytest.mark.parametrize("place", PLACES)
def test_with_several_other_powers_an_example_is_used(place: str) -> None:
    wrong_text = place.format("R(1)", p="50") + ";L(1, 30)"
    diagnostic = next(diagnostic for diagnostic in check(wrong_text) if diagnostic.is_mistake)
    assert (diagnostic.values["fix"], diagnostic.values["sample"]) == ("R(1, 80)", "80 %"), (
        wrong_text
    )


@pytest.mark.parametrize("place", SURROUNDINGS)
@pytest.mark.parametrize("language", SAID)
def test_an_example_is_called_an_example(place: str, language: str) -> None:
    for call, fix, sample in (("R(1)", "R(1, 80)", "80 %"), ("BEEP(1)", "BEEP(1, 440)", "440 Hz")):
        text = place.format(call)
        diagnostic = next(diagnostic for diagnostic in check(text) if diagnostic.is_mistake)
        full_message = message(diagnostic, Source(text), language)
        assert full_message.fix == fix, text  # the fix can be copied unchanged
        assert f"{sample} {SAID[language]}" in full_message.message, text


@pytest.mark.parametrize("text", ["F(2, 8O)", "F(dos, ochenta)", "W(uno)", "F(2 seg 80)"])
def test_a_number_written_in_another_form_is_not_an_example(text: str) -> None:
    assert not any(diagnostic.values.get("sample") for diagnostic in check(text))
