"""Suggestions have the pupil's own values, each of them, in each place."""

from __future__ import annotations

import re
from itertools import product

import pytest

from tests.pupils.corpus import check
from tiniscript.base.source import Source, apply_edits
from tiniscript.diagnostics.fixing import edits_of, repair_program
from tiniscript.diagnostics.rendering import message

PLACES = (
    "SI|{}", "SI|W(3);{};S", "SI|W(3)\n{}\nS", "SI|LOOP(2);{};END_LOOP",
    "SI|DEF PASO;{};END_DEF;PASO", "SI|IF(DISTANCE < 9)\n{}\nELSE\nS\nENDIF",
)  # fmt: skip
TRAVELS = (("F", "CM"), ("B", "CM"), ("L", "DEG"), ("R", "DEG"))
CALL_FORMS = ("{w}({v}, {u}, {p})", "{w}({u}, {v}, {p})", "{w}({v}, {p}, {u})", "{w}({u} {v}, {p})")
THOUSANDS = ("1,000", "2,500", "12,000", "1,500")


@pytest.mark.parametrize("form", CALL_FORMS)
@pytest.mark.parametrize(("word", "unit"), TRAVELS)
@pytest.mark.parametrize(("value", "power"), [("40", "70"), ("7.5", "35"), ("V", "V"), ("V", "45")])
def test_a_unit_given_as_a_value_joins_its_value(
    form: str, word: str, unit: str, value: str, power: str
) -> None:
    declaration = "V = 12;" if "V" in (value, power) else ""
    for place in PLACES:
        wrong_text, right_text = (
            place.replace("SI|", f"SI|{declaration}").format(call)
            for call in (
                form.format(w=word, u=unit, v=value, p=power),
                f"{word}({value} {unit}, {power})",
            )
        )
        assert repair_program(wrong_text, check).text.replace("; ", ";") == right_text.replace(
            "; ", ";"
        )


@pytest.mark.parametrize("place", PLACES)
def test_a_comma_in_thousands_does_not_separate_values(place: str) -> None:
    for first, second in product(THOUSANDS, THOUSANDS):
        wrong_text = place.format(f"BEEP(1, {first});SHOW({second});BEEP(1, {second})")
        assert repair_program(wrong_text, check).text == re.sub(r",(?=\d{3})", "", wrong_text)


@pytest.mark.parametrize("text", ["W(1,500)", "BEEP(1,500, 440)", "F(1,500)", "MAX(1,500)"])
def test_a_comma_is_not_removed_where_it_may_be_decimal(text: str) -> None:
    assert not any("1500" in diagnostic.values.get("fix", "") for diagnostic in check(f"SI|{text}"))


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("time", ["3", "0.5", "12"])
@pytest.mark.parametrize(("left", "right"), [("50", "80"), ("-30", "30"), ("V", "V")])
def test_the_seconds_of_motors_are_those_of_a_wait(
    place: str, time: str, left: str, right: str
) -> None:
    wrong_text = place.replace("SI|", "SI|V = 12;").format(f"M({left}, {right}, {time})")
    (diagnostic,) = [diagnostic for diagnostic in check(wrong_text) if diagnostic.is_mistake]
    shown_text = f"M({left}, {right});W({time})" + ";S" * place.endswith("|{}")
    assert message(diagnostic, Source(wrong_text), "en").fix == shown_text
    repaired_text = apply_edits(wrong_text, edits_of(diagnostic) or [])
    assert repaired_text == wrong_text.replace(f"M({left}, {right}, {time})", shown_text)
    assert repair_program(wrong_text, check).text == wrong_text  # the word may also continue


@pytest.mark.parametrize(
    ("text", "first_reading", "second_reading"),
    [
        ("BEEP(250, 440)", "BEEP(0.25, 440)", "BEEP(0.44, 250)"),
        ("BEEP(440, 250)", "BEEP(0.25, 440)", "BEEP(0.44, 250)"),
        ("BEEP(262, 500)", "BEEP(0.5, 262)", "BEEP(0.262, 500)"),
    ],
)
def test_ambiguous_values_are_shown_in_both_readings(
    text: str, first_reading: str, second_reading: str
) -> None:
    (diagnostic,) = check(text)
    assert (diagnostic.values["fix"], diagnostic.values["rival"]) == (first_reading, second_reading)
