"""A DEF whose name has a space or a `-`, and other lines that got half a repair before."""

from __future__ import annotations

import pytest

from tests.pupils.corpus import check
from tiniscript.base.source import Source
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.fixing import fixed
from tiniscript.diagnostics.rendering import message


@pytest.mark.parametrize(
    ("program", "right"),
    [
        ("DEF PASO_UNO;S;END_DEF;PASO UNO", "DEF PASO_UNO;S;END_DEF;PASO_UNO"),
        ("DEF PASO-UNO;S;END_DEF;PASO-UNO", "DEF PASO_UNO;S;END_DEF;PASO_UNO"),
        ("DEF PASO-1;S;END_DEF;PASO-1", "DEF PASO_1;S;END_DEF;PASO_1"),
        ("DEF PARAR S\nEND_DEF;PARAR", "DEF PARAR;S\nEND_DEF;PARAR"),  # S does something
        ("F(1, 80) cuatro veces", "F(1, 80) cuatro veces"),  # a number in words is left to look at
    ],
)
def test_a_name_in_two_parts_is_one(program: str, right: str) -> None:
    assert fixed(program, check).text == right


def test_what_a_repair_says_of_the_whole_instruction() -> None:
    (found,) = check("UNTIL(DISTANCE < 10) F(2, 60)")
    assert found.values["fix"] == "F(2, 60) UNTIL(DISTANCE < 10)"
    (found,) = check("F(1, 80) cuatro veces")
    assert found.values["fix"] == "LOOP(4);F(1, 80);END_LOOP"
    program = "UNTIL(DISTANCE < 10) SHOW(TIME)"
    assert fixed(program, check).text == program


@pytest.mark.parametrize(("lang", "part"), [("es", "una y otra vez"), ("en", "again and again")])
def test_a_clock_of_another_language_is_explained(lang: str, part: str) -> None:
    program = "CADA 2 segundos\nF(1, 50)"
    (found,) = check(program)
    shown = message(found, Source(program), lang)
    assert part in shown.fix
    assert "LOOP(FOREVER)" in shown.fix


def test_the_set_up_of_a_port_is_no_start() -> None:
    (found,) = check("Serial.begin(9600);\nF(1, 50)")
    assert found.code is codes.UNKNOWN_WORD
    assert found.values["found"] == "Serial.begin"


@pytest.mark.parametrize(
    ("program", "right"),
    [
        ("DEF MEDIA VUELTA;R(1, 50);END_DEF;MEDIA VUELTA", "MEDIA_VUELTA"),  # no turn is meant
        ("DEF GIRAR DERECHA;R(1, 50);END_DEF;GIRAR DERECHA", "GIRAR_DERECHA"),
        ("DEF MI BAILE LOCO;S;END_DEF;MI BAILE LOCO", "MI_BAILE_LOCO"),
        ("DEF PASO 2;S;END_DEF;PASO 2", "PASO_2"),
        ("DEF 2PASOS;S;END_DEF;2PASOS", "PASOS2"),
    ],
)
def test_a_name_of_several_words_gets_one_message_for_all_its_places(
    program: str, right: str
) -> None:
    (found,) = check(program)
    assert message(found, Source(program), "es").fix == f"{right}, las 2 veces"
    assert fixed(program, check).text.count(right) == 2
    assert check(fixed(program, check).text) == []


def test_lines_of_other_places_are_named() -> None:
    program = "mi vel = 50\nF(2, mi vel)\nB(2, mi vel)"
    (found,) = check(program)
    assert message(found, Source(program), "en").fix == "MI_VEL, and so in lines 2, 3"
    assert found.repair is not None and len(found.repair.edits) == 3


def test_a_word_of_a_name_is_the_name() -> None:
    assert check("MI_VEL = 5\nF(2, VEL)")[0].values["near"] == "MI_VEL"
    assert check("MI_VEL = 5;TU_VEL = 6\nF(2, VEL)\nSHOW(MI_VEL + TU_VEL)")[0].values["near"] == ""
