"""Words behind a whole instruction: a note where they ask for nothing, and never an order."""

from __future__ import annotations

import pytest

from tests.pupils.corpus import check
from tiniscript.base.source import Source, applied
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.fixing import edits_of
from tiniscript.diagnostics.rendering import message

DANCE = "DEF DANCE;S;END_DEF;"


@pytest.mark.parametrize(
    "program",
    [
        "F(1, 80) voy a la bodega",
        "F(1, 80) adelante",
        "F(2, 80) = 60 cm",
        "F(2, 80) ok? :)",
        "L(0.39, 60) 90 grados",
        "LOOP(3) tres veces\nS\nEND_LOOP fin",
        "W(2) wait for bread",
        "F(5, 60) UNTIL(DISTANCE < 20) hasta la pared",
    ],
)
def test_a_note_keeps_all_and_changes_nothing(program: str) -> None:
    text = program
    while found := check(text):
        assert found[0].code is codes.WORDS_BEHIND
        edits = edits_of(found[0])
        assert edits
        text = applied(text, edits)
    lines = [line.partition("//") for line in text.split("\n")]
    said = [f"{head.rstrip()} {note.strip()}".rstrip() for head, _, note in lines]
    assert said == program.split("\n")


@pytest.mark.parametrize(
    "words",
    [
        "otra vez", "de nuevo", "again", "sin parar", "siempre", "hasta la mesa", "despacio",
        "retrocede", "gira", "y gira a la derecha", "B", "S", "STPO", "DANCE", "y DANCE",
        "B(1, 80)", "DANZA", "si no hay pared", "cuando choque", "mientras no haya pared",
        "AND", "prende la luz", "dos veces", "x3", "X = 5", "tres segundos", "espera 2 segundos",
        "para", "vuelve",
    ],
)  # fmt: skip
def test_what_asks_for_something_is_no_note(words: str) -> None:
    program = f"{DANCE}F(2, 80) {words}"
    found = check(program)
    assert found
    assert all("//" not in each.values.get("fix", "") for each in found)


@pytest.mark.parametrize(
    ("program", "es", "en"),
    [
        ("F(2, 80) otra vez", "LOOP(2);F(2, 80);END_LOOP", "LOOP(2);F(2, 80);END_LOOP"),
        (
            "F(2, 80) sin parar",
            "sin fin, escribe LOOP(FOREVER);F(2, 80);END_LOOP",
            "write LOOP(FOREVER);F(2, 80);END_LOOP",
        ),
        ("F(2, 80) despacio", "segundo número de F(2, 80)", "second number of F(2, 80)"),
        ("F(2, 80) voy; S", "al final de la línea", "at the end of the line"),
    ],
)
def test_how_it_is_written_is_said(program: str, es: str, en: str) -> None:
    found = check(program)[0]
    assert es in message(found, Source(program), "es").fix
    assert en in message(found, Source(program), "en").fix


def test_a_variable_may_be_called_so() -> None:
    assert check("S1 = DISTANCE = 3\nSHOW(S1)") == []
    assert check("SL = ABS(3)\nSHOW(SL)") == []
