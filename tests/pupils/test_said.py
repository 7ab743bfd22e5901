"""Details that the pins in `*.txt` omit: optional edits, and values in a message."""

from __future__ import annotations

import re

import pytest

from tests.pupils.corpus import check
from tiniscript.base.source import Source, apply_edits
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.fixing import edits_of, repair_program
from tiniscript.diagnostics.rendering import message
from tiniscript.semantics import unknown_words
from tiniscript.syntax.lexer import Scan, scan


@pytest.mark.parametrize(
    "program",
    [
        "F(1, 80) voy a la bodega",
        "F(2, 80) = 60 cm",
        "LOOP(3) tres veces\nS\nEND_LOOP fin",
        "F(5, 60) UNTIL(DISTANCE < 20) hasta la pared",
    ],
)
def test_a_note_keeps_all_and_changes_nothing(program: str) -> None:
    text = program
    assert check(text)
    while diagnostics := check(text):
        assert diagnostics[0].code is codes.WORDS_AFTER
        edits = edits_of(diagnostics[0])
        assert edits
        text = apply_edits(text, edits)
    lines = [line.partition("//") for line in text.split("\n")]
    notes = [f"{head.rstrip()} {note.strip()}".rstrip() for head, _, note in lines]
    assert notes == program.split("\n")


@pytest.mark.parametrize(
    ("program", "orders", "example"),
    [
        ("avanza 2 segundos y luego para", "F(2, 80);S", "80 %"),
        ("avanza 2 s al 50% y despu\u00e9s retrocede 1 s al 30%", "F(2, 50);B(1, 30)", ""),
        (
            "pita 3 veces y para 1 segundo",
            "LOOP(3);BEEP(1, 440);W(1);END_LOOP;S;W(1)",
            "1 s, 440 Hz",
        ),
        (
            "avanza hasta la pared y gira 1 segundo a la derecha",
            "F(FOREVER, 80) UNTIL(DISTANCE < 10);R(1, 80)",
            "10 cm, 80 %",
        ),
    ],
)
def test_each_order_of_a_sentence_is_written(program: str, orders: str, example: str) -> None:
    (diagnostic,) = check(program)
    assert diagnostic.code is codes.SEVERAL_INSTRUCTIONS
    assert (diagnostic.values["fix"], diagnostic.values["example"]) == (orders, example)
    assert not check(apply_edits(program, edits_of(diagnostic) or []))
    assert repair_program(program, check).text == program or not example, "an example is a guess"
    for language in ("es", "en"):
        assert example in message(diagnostic, Source(program), language).message


def test_the_set_up_of_a_port_is_not_a_start() -> None:
    (diagnostic,) = check("Serial.begin(9600);\nF(1, 50)")
    assert (diagnostic.code, diagnostic.values["found"]) == (codes.UNKNOWN_WORD, "Serial.begin")


def test_the_body_of_a_def_is_read_once_for_all_its_calls(monkeypatch: pytest.MonkeyPatch) -> None:
    read_texts: list[str] = []

    def record_scan(text: str) -> Scan:
        read_texts.append(text)
        return scan(text)

    monkeypatch.setattr(unknown_words, "scan", record_scan)
    diagnostics = check("DEF V;F(X CM, 60);END_DEF\n" + "V(20)\n" * 50)
    assert [diagnostic.values["head"] for diagnostic in diagnostics[1:]] == ["DEF V(X)"] * 50
    assert set(read_texts) == {";F(X CM, 60);"}
    assert len(read_texts) <= 5  # scans of the program and its offers, not of each call


@pytest.mark.parametrize("language", ["en", "es"])
@pytest.mark.parametrize("program", ["gira", "da una vuelta a la derecha", "F(20 pasos, 80)"])
def test_a_copied_call_is_never_taken_for_another_program(program: str, language: str) -> None:
    """In English, `time` is the sensor TIME: F(time, 80) would be read."""
    text = f"SI|{program}"
    first, *_ = check(text)
    calls = re.findall(r"[FBLR]\([^()]*\)", message(first, Source(text), language).fix)
    assert calls
    for call in calls:
        assert any(diagnostic.is_mistake for diagnostic in check(f"SI|{call}")), call


@pytest.mark.parametrize("program", ["F(1, 80) forever", "W(1) siempre"])
def test_an_endless_suggestion_is_a_program(program: str) -> None:
    [diagnostic] = check(f"SI|{program}")
    assert not any(
        diagnostic.is_mistake for diagnostic in check(f"SI|{diagnostic.values['endless']}")
    )
