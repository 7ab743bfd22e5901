"""Ends of blocks with a sign or a name in them, dots for a body, and blocks with nothing inside."""

from __future__ import annotations

import pytest

from tests.pupils.corpus import check
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.rendering import message
from tiniscript.repairs.fixing import fixed
from tiniscript.source import Source


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
