"""Ends of blocks with a sign or a name in them, dots for a body, and blocks with nothing inside."""

from __future__ import annotations

import pytest

from tests.pupils.corpus import check
from tiniscript.base.source import Source, applied
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.fixing import edits_of, fixed
from tiniscript.diagnostics.rendering import message


@pytest.mark.parametrize(
    ("end", "right"),
    [("END-LOOP", "END_LOOP"), ("END.LOOP", "END_LOOP"), ("End - Loop", "END_LOOP")],
)
def test_an_end_with_a_sign_in_it_is_one_word(end: str, right: str) -> None:
    program = f"LOOP(4)\nF(1, 60)\n{end}\nS"
    (found,) = check(program)
    assert found.code is codes.END_SPLIT and found.values["right"] == right
    assert fixed(program, check).text == f"LOOP(4)\nF(1, 60)\n{right}\nS"


def test_a_def_ends_with_its_name() -> None:
    assert fixed("DEF V\nS\nEND_V\nV", check).text == "DEF V\nS\nEND_DEF\nV"
    assert fixed("DEF V\nS\nEND_DEF V\nV", check).text == "DEF V\nS\nEND_DEF\nV"
    assert not check("DEF END_V\nS\nEND_DEF\nEND_V")  # a name as any other


@pytest.mark.parametrize(
    ("program", "part"),
    [
        ("LOOP(3) ... END_LOOP\nF(1, 60)\nS", "LOOP(3); F(1, 60); S; END_LOOP"),
        ("DEF V … END_DEF\nS\nV", "DEF V; S; END_DEF; V"),
        ("LOOP(3) ... END_LOOP", "en el lugar de los puntos"),
        ("LOOP(3)\n...\nEND_LOOP", "en el lugar de los puntos"),
        ("LOOP(3) ...\nS\nEND_LOOP", "Quita los ..."),
    ],
)
def test_dots_stand_for_what_goes_inside(program: str, part: str) -> None:
    (found,) = check(program)
    assert found.code is codes.DOTS
    assert part in message(found, Source(program), "es").fix
    assert fixed(program, check).text == program  # how much goes inside is not known


@pytest.mark.parametrize(
    ("program", "part"),
    [
        ("LOOP(4)\nEND_LOOP\nF(1, 60)\nS", "LOOP(4); F(1, 60); S; END_LOOP"),
        ("F(1, 60)\nS\nLOOP(4)\nEND_LOOP", "LOOP(4); F(1, 60); S; END_LOOP"),
        ("IF(DISTANCE < 9)\nENDIF\nS\nLOOP(2)\nS\nEND_LOOP", "IF(DISTANCE < 9); S; ENDIF"),
        ("LOOP(4)\nEND_LOOP\nIF(DISTANCE < 9)\nS\nENDIF\nS", ""),
    ],
)
def test_a_block_with_nothing_inside_is_named(program: str, part: str) -> None:
    found = [each for each in check(program) if each.code is codes.EMPTY_BLOCK]
    assert len(found) == bool(part)
    assert all(part in message(each, Source(program), "es").fix for each in found)


@pytest.mark.parametrize(
    "program",
    [
        "S\nLOOP(FOREVER)\nEND_LOOP",
        "WHILE(DISTANCE > 9)\nEND_WHILE\nS",
        "LOOP(4)\n// todo\nEND_LOOP\nS",
        "LOOP(4)\nEND_LOOP",
        "IF(DISTANCE < 9)\nELSE\nS\nENDIF\nS",
    ],
)
def test_a_block_that_waits_or_is_to_be_filled_is_not(program: str) -> None:
    assert not any(each.code is codes.EMPTY_BLOCK for each in check(program))


@pytest.mark.parametrize(
    ("program", "right"),
    [
        (
            "LOOP(5)\nIF(DISTANCE < 20)\nS\nEND_LOOP\nENDIF\nS",
            "LOOP(5)\nIF(DISTANCE < 20)\nS\nENDIF\nEND_LOOP\nS",
        ),
        (
            "LOOP(5);IF(DISTANCE < 20);S;END_LOOP;ENDIF",
            "LOOP(5);IF(DISTANCE < 20);S;ENDIF;END_LOOP",
        ),
    ],
)
def test_ends_the_wrong_way_round_are_swapped(program: str, right: str) -> None:
    (found,) = check(program)
    assert found.values["swapped"] == "ENDIF"
    assert applied(program, edits_of(found) or []) == right


def test_an_unknown_word_with_a_number_is_the_loop_that_ends_below() -> None:
    (found,) = check("Loco(4)\nF(1, 60)\nEnd_loop")
    assert (found.code, found.values["near"]) == (codes.UNKNOWN_WORD, "LOOP")
    assert len(check("Loco(4)\nF(1, 60)")) == 1
    assert not check("Loco(4)\nF(1, 60)")[0].values.get("near")


def test_how_much_of_a_line_is_repeated_is_asked() -> None:
    program = "SI|F(1.3, 60); L(0.39, 60) x4"
    (found,) = check(program)
    assert found.values["fix"] == "" and fixed(program, check).text == program
    assert found.values["all"] == "LOOP(4);F(1.3, 60);L(0.39, 60);END_LOOP"
    assert found.values["last"] == "LOOP(4);L(0.39, 60);END_LOOP"
    (found,) = check("LOOP(2); S; END_LOOP; F(1, 50) x3")
    assert found.values["fix"] == "LOOP(3);F(1, 50);END_LOOP"


def test_moves_without_values_get_one_message() -> None:
    (found,) = check("SI|F; R; F")
    assert found.values["words"] == "F, R" and found.values["fix"] == ""
    shown = message(found, Source("SI|F; R; F"), "es").fix
    assert shown == "Con tus números, como en F(2, 80); R(2, 80); F(2, 80)"


def test_a_function_of_python_is_shown_with_its_end() -> None:
    brackets, end = check("def v():\n  F(1, 50)\n\nv()\nv()")
    assert brackets.values["lines"] == "4, 5"
    assert end.values["whole"] == "DEF V; F(1, 50); END_DEF"


def test_dots_around_what_goes_inside_are_no_more_than_a_new_line() -> None:
    (found,) = check("LOOP(4) ... F(1, 60); S ... END_LOOP")
    assert found.values["fix"] == "LOOP(4);F(1, 60);S;END_LOOP"


def test_how_often_behind_all_of_it_names_all_of_it() -> None:
    (found,) = check("F(1, 50); R(1, 50); repetir 4 veces")
    assert found.code is codes.REPEATED
    assert found.values["all"] == "LOOP(4);F(1, 50);R(1, 50);END_LOOP"
    (found,) = check("F(1, 50)\nrepetir")
    assert found.code is codes.REPEATED and not found.values.get("all")  # how often is not said
    (found,) = check("F(1, 50)\nrepetir 4\nR(1, 50)")
    assert found.code is codes.OTHER_LANGUAGE


@pytest.mark.parametrize(
    ("program", "right"), [("M 50;-50", "M(50, -50)"), ("M -5; 3", "M(-5, 3)")]
)
def test_the_other_motor_behind_a_semicolon_keeps_its_power(program: str, right: str) -> None:
    assert fixed(program, check).text == right
