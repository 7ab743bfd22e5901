"""Keys and lights in a pupil's own words lead to the readings that they are, in each place."""

from __future__ import annotations

from itertools import product

import pytest

from tests.pupils.corpus import check
from tiniscript.base.source import Source, apply_edits
from tiniscript.diagnostics.fixing import edits_of, repair_program
from tiniscript.diagnostics.rendering import message
from tiniscript.recovery.keys import KEYS

SIDES = {
    "UP": ("UP", "ARRIBA", "CIMA"), "DOWN": ("DOWN", "ABAJO", "BAIXO"),
    "LEFT": ("LEFT", "IZQUIERDA", "ESQUERDA"), "RIGHT": ("RIGHT", "DERECHA", "DIREITA"),
    "A": ("A",), "B": ("B",),
}  # fmt: skip
OF_KEYS = ("KEY", "tecla", "botón", "SETA")
SIDE_LAST_FORMS = ("{k}_{s}", "{k} {s}", "{k} = {s}", '{k} == "{s}"', "{k}({s})",
                   "{k} {s} pressed", "pulso {k} {s}", "{k}{s}")  # fmt: skip
SIDE_FIRST_FORMS = ("{s}_{k}", "{s} {k}", "{s}{k}")
CASES = [
    (form.format(k=key, s=word), side)
    for side, words in SIDES.items()
    for key, word in product(OF_KEYS, words)
    for form in (*SIDE_LAST_FORMS, *(SIDE_FIRST_FORMS if len(side) > 1 else ()))
    if not (len(side) == 1 and form == "{k}{s}" and key == "botón")
]
PLACES = (
    "SI|W(1);WHEN({});F(1, 60);END_WHEN", "SI|W(1)\nWHILE({})\nS\nEND_WHILE",
    "SI|F(FOREVER, 60) UNTIL({});S", "SI|IF(DISTANCE < 9 AND {});W(1);ELSEIF({});S;ENDIF",
)  # fmt: skip
ORDERS = ("F(1, 60)", "S")


@pytest.mark.sampled("key_text", "side", keep=100)
@pytest.mark.parametrize(("key_text", "side"), CASES)
def test_a_paraphrased_key_becomes_its_reading_in_any_condition(key_text: str, side: str) -> None:
    for place in PLACES:
        assert repair_program(place.replace("{}", key_text), check).text == place.replace(
            "{}", f"KEY_{side}"
        ), place


@pytest.mark.parametrize("key", ["KEY", "TECLA", "FLECHA", "SETA"])
@pytest.mark.parametrize("suffix", [" = SPACE", "", " = 1", " == ENTER", "_ESPACIO", " = Z"])
def test_an_unknown_key_is_reported_with_all_keys(key: str, suffix: str) -> None:
    for place in PLACES:
        text = place.replace("{}", key + suffix, 1).replace("{}", "KEY_A")
        (diagnostic,) = check(text)
        key_text = message(diagnostic, Source(text), "en").message
        assert diagnostic.code.number == "TS103" and all(key in key_text for key in KEYS), text
        assert repair_program(text, check).text == text


@pytest.mark.parametrize("sign", [" = ", ": ", " -> "])
@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("side", SIDES)
def test_an_instruction_for_a_key_gets_its_condition(side: str, order: str, sign: str) -> None:
    for key, word in product((*OF_KEYS, "KEY_"), SIDES[side]):
        text = f"KEY_{side}" if key == "KEY_" else f"{key} {word}"
        wrong_text = f"SI|{text}{sign}{order}\nW(3)"
        (diagnostic,) = check(wrong_text)
        right_text = f"SI|WHEN(KEY_{side});{order};END_WHEN\nW(3)"
        assert apply_edits(wrong_text, edits_of(diagnostic) or []) == right_text
        inside = f"SI|LOOP(FOREVER);{text}{sign}{order};END_LOOP"
        (diagnostic,) = check(inside)
        assert diagnostic.values["fix"] == f"IF(KEY_{side});{order};ENDIF"


STICK = {"UP": "PAD_Y > 0", "DOWN": "PAD_Y < 0", "LEFT": "PAD_X < 0", "RIGHT": "PAD_X > 0"}


@pytest.mark.parametrize("stick", ["PAD", "joystick", "palanca", "ALAVANCA"])
@pytest.mark.parametrize("side", STICK)
def test_a_side_of_the_stick_is_shown_as_its_number_and_as_an_arrow(stick: str, side: str) -> None:
    forms = ("{k} {s}", "{k}_{s}", "{k} = {s}", "{s} {k}", "{k}({s})", "{k} {s} = TRUE")
    for place, form, word in product(PLACES, forms, SIDES[side]):
        wrong_text = place.replace("{}", form.format(k=stick, s=word), 1).replace("{}", "KEY_A")
        (diagnostic,) = check(wrong_text)
        values = {"fix": STICK[side], "arrow": f"KEY_{side}"}
        assert {name: diagnostic.values.get(name) for name in values} == values, wrong_text
        assert repair_program(wrong_text, check).text == wrong_text


@pytest.mark.parametrize("side", STICK)
def test_an_axis_with_a_side_becomes_a_comparison(side: str) -> None:
    for place, form in product(PLACES, ("PAD_X {}", "PAD_X = {}", "STICK_X_{}", "PAD_Y == {}")):
        wrong_text = place.replace("{}", form.replace("{}", side), 1).replace("{}", "KEY_A")
        (diagnostic,) = check(wrong_text)
        assert (diagnostic.values["fix"], diagnostic.values["arrow"]) == (STICK[side], "")


@pytest.mark.parametrize("side", ["L", "R"])
def test_a_letter_for_a_sensor_is_shown_as_that_sensor(side: str) -> None:
    for text in (f"IF({side} > 500);S;ENDIF", f"SHOW({side})", f"W(2) UNTIL({side} < 9)"):
        for place in (
            "{}",
            "W(1);{}",
            "W(1)\n{}\nW(2)",
            "LOOP(2);{};END_LOOP",
            "DEF A1;{};END_DEF",
        ):
            (diagnostic,) = (
                diagnostic
                for diagnostic in check(place.replace("{}", text))
                if diagnostic.is_mistake
            )
            assert diagnostic.values["reading"] == f"LIGHT_{side}", place


@pytest.mark.parametrize("stem", ["LIGHT", "luz"])
@pytest.mark.parametrize(
    ("way", "side"), [(way, side) for side in ("LEFT", "RIGHT") for way in SIDES[side]]
)
def test_a_paraphrased_light_sensor_becomes_its_reading(stem: str, way: str, side: str) -> None:
    for form, place in product(
        ("{0}_{1}", "{1}_{0}", "{0}{1}", "{1}{0}", "{0}({1})", "{0} {1}"), PLACES
    ):
        condition_text = f"{form.format(stem, way)} > 300"
        assert repair_program(place.replace("{}", condition_text), check).text == place.replace(
            "{}", f"LIGHT_{side[0]} > 300"
        )


@pytest.mark.parametrize(
    "text",
    ["KEY = 3;IF(KEY > 2);F(1 60);ENDIF", "UP = 3;F(UP, 60);F(2 80)", "IF(KEY_A);F(1 60);ENDIF",
     "DEF TECLA(UP);F(UP, 60);END_DEF;TECLA(2);F(1 60)", "F(2 60) // press key A"],
)  # fmt: skip
def test_program_names_and_comments_are_not_keys(text: str) -> None:
    assert {diagnostic.code.number for diagnostic in check(f"SI|{text}")} == {"TS017"}


def test_the_button_of_a_robot_is_still_not_a_key() -> None:
    assert [diagnostic.code.number for diagnostic in check("SI|IF(BUTTON);F(1, 60);ENDIF")] == [
        "TS120"
    ]
