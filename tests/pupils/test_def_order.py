"""A DEF whose block or end stands in the wrong place, and how often a DEF is called."""

from __future__ import annotations

import pytest

from tests.pupils.corpus import check
from tiniscript.base.source import Source, applied
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.fixing import edits_of, fixed
from tiniscript.diagnostics.rendering import message
from tiniscript.semantics import unknown_words
from tiniscript.syntax.lexer import Scan, scan


@pytest.mark.parametrize(
    ("program", "right"),
    [
        (
            "SI|DEF V\n  F(1, 50)\nV\nV\nEND_DEF",
            "SI|DEF V\n  F(1, 50)\nEND_DEF\nV\nV",
        ),
        ("DEF V;F(1, 50);V;END_DEF", "DEF V;F(1, 50);END_DEF;V"),
        (
            "DEF V\nS\nLOOP(3)\nV\nEND_LOOP\nEND_DEF",
            "DEF V\nS\nEND_DEF\nLOOP(3)\nV\nEND_LOOP",
        ),
        ("SI|V\nDEF V\nS // p\nEND_DEF", "SI|DEF V\nS // p\nEND_DEF\nV"),
        ("V;V;DEF V;S;END_DEF", "DEF V;S;END_DEF;V;V"),
        ("LOOP(3)\nDEF V\nS\nEND_DEF\nV\nEND_LOOP", "DEF V\nS\nEND_DEF\nLOOP(3)\nV\nEND_LOOP"),
    ],
)
def test_one_message_moves_the_block_or_its_end(program: str, right: str) -> None:
    (found,) = check(program)
    assert applied(program, edits_of(found) or []) == right
    assert not any(each.is_mistake for each in check(right))


def test_a_def_that_is_called_below_may_be_meant_to_begin_again() -> None:
    found = check("DEF V\nS\nV\nV\nEND_DEF\nV")
    assert [each.code for each in found] == [codes.CALLS_ITSELF]
    assert edits_of(found[0]) is None


def test_a_long_program_gets_its_lines_named() -> None:
    program = "V\n" + "F(1, 50)\n" * 30 + "DEF V\nS\nEND_DEF"
    (found,) = check(program)
    shown = message(found, Source(program), "en").fix
    assert shown == "Move DEF V with all of its block, lines 32 to 34, before line 1"


def test_a_def_goes_behind_the_values_that_it_needs() -> None:
    program = "X = 50\nV\nDEF V\nF(1, X)\nEND_DEF"
    assert fixed(program, check).text == "X = 50\nDEF V\nF(1, X)\nEND_DEF\nV"


def test_a_def_stays_where_moving_it_makes_another_mistake() -> None:
    (found, _) = check("V\nX = 50\nDEF V\nF(1, X)\nEND_DEF\nF(1; 50)")
    assert found.code is codes.CALL_BEFORE_DEF and "block" not in found.values


@pytest.mark.parametrize("call", ["V(3)", "3 V", "3 veces V", "V 3 veces", "V*3", "3x V", "V x3"])
def test_how_often_a_def_is_called_is_a_loop(call: str) -> None:
    program = f"DEF V;S;END_DEF\n{call}"
    (found,) = check(program)
    assert found.values["fix"] == "LOOP(3);V;END_LOOP"
    assert (fixed(program, check).text == program) == (call == "V(3)")  # which may mean a value


@pytest.mark.parametrize("call", ["V(2, 80)", "V(0.5)", "V(300)"])
def test_values_of_a_def_are_not_lost(call: str) -> None:
    program = f"DEF V;S;END_DEF\n{call}"
    (found,) = check(program)
    assert found.values["fix"] == "" and edits_of(found) is None


def test_the_body_of_a_def_is_read_once_for_all_its_calls(monkeypatch: pytest.MonkeyPatch) -> None:
    read: list[str] = []

    def scanned(text: str) -> Scan:
        read.append(text)
        return scan(text)

    monkeypatch.setattr(unknown_words, "scan", scanned)
    told = check("DEF V;F(X CM, 60);END_DEF\n" + "V(20)\n" * 50)
    assert [each.values["fix"] for each in told[1:]] == ["X = 20;V"] * 50
    assert read == [";F(X CM, 60);"]


def test_numbers_of_lines_are_not_how_often() -> None:
    program = "DEF V;S;END_DEF\n1 F(1, 50)\n2 V"
    assert "LOOP" not in fixed(program, check).text


@pytest.mark.parametrize(
    ("program", "name"),
    [("GIRITO\nGIRITO\nGIRITO", "GIRITO"), ("F(1, 50);PASO", "PASO"), ("hola", "")],
)
def test_a_word_that_no_def_teaches_gets_one_message(program: str, name: str) -> None:
    (found,) = check(program)
    assert (found.code is codes.UNTAUGHT) == bool(name)
    assert found.values.get("name", "") == name
