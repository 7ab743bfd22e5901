"""A word gets the warnings of its row: one with the row of BEEP gets those of BEEP."""

from __future__ import annotations

import re
from itertools import product

import pytest

from tests.support.advised_programs import ADVISED_PROGRAMS
from tests.support.casefile import all_cases
from tests.support.new_word import CHEEP, TOOT
from tests.support.rows import each_row
from tiniscript import robots
from tiniscript.base.languages import FOLDER
from tiniscript.base.words import WORDS
from tiniscript.library.compiling import analyze

KIT = robots.load("tinibot").kit
# Places of a sound; `{}` is the sound.
PLACES = (
    "{}", "{};F(2, 80)", "M(50, 50);{}", "M(50, 50);{};S", "LOOP(FOREVER);{};END_LOOP",
    "IF(DISTANCE < 10);S;{};ENDIF;F(5, 60)", "IF(DISTANCE < 10);{};ENDIF;F(9, 60)",
    "WHILE(DISTANCE > 20);{};F(5, 60);END_WHILE", "WHILE(TIME < 9);{};END_WHILE",
    "{};WHILE(TIME < 5);F(1, 60);END_WHILE", "IF(KEY_UP);{};ENDIF", "{};IF(KEY_UP);S;ENDIF",
    "TASK;{};END_TASK;F(2, 80)", "TASK;F(5, 50);{};END_TASK", "TASK;{};F(5, 50);END_TASK",
    "TASK;{};W(1);END_TASK;F(2, 80)", "{} UNTIL(DISTANCE < 10)",
    "TASK;LOOP(FOREVER);M(50, 50);{};END_LOOP;END_TASK;LOOP(FOREVER);F(1, 60);END_LOOP",
    "WHEN(DISTANCE < 10);S;{};END_WHEN;LOOP(FOREVER);F(2, 60);END_LOOP",
)  # fmt: skip
TIMES = ("0", "-1", "0.2", "6", "20", "100", "440", "X")
TONES = ("440", "440-660", "20", "1.000", "X", "1000")


@pytest.fixture(autouse=True)
def _new_words(monkeypatch: pytest.MonkeyPatch) -> None:
    for word in (TOOT, CHEEP):
        monkeypatch.setitem(WORDS, word.text, word)


def codes_in(text: str) -> list[str]:
    return [
        repr(diagnostic).replace(TOOT.text, "BEEP") for diagnostic in analyze(text, KIT).diagnostics
    ]


def codes_of(text: str) -> set[str]:
    return {diagnostic.code.number for diagnostic in analyze(text, KIT).diagnostics}


def texts_with_beep() -> list[str]:
    catalogue = (FOLDER / "en" / "messages.toml").read_text("utf-8")
    texts = re.findall(r'(?m)^"TS\d+/(?:wrong|right)".* = "(.*)"$', catalogue)
    texts += [case.parts["tiniscript"] for case in all_cases() if "tiniscript" in case.parts]
    texts += [text for text, _ in ADVISED_PROGRAMS]
    return [text for text in texts if re.search(r"\bBEEP\b", text)]


def test_another_word_with_the_row_of_beep_is_checked_alike() -> None:
    calls = [f"BEEP({time}, {tone})" for time, tone in product(TIMES, TONES)]
    calls += ["BEEP(4)", "BEEP(3, 440, 5)", "BEEP", "BEEP(TRUE, 440)"]
    texts = texts_with_beep()
    assert len(texts) > 20
    texts += ["SI|X = DISTANCE;" + place.format(call) for place, call in product(PLACES, calls)]
    codes = set()
    for text in texts:
        beep_codes = codes_in(text)
        assert codes_in(re.sub(r"\bBEEP\b", TOOT.text, text)) == beep_codes, text
        codes |= codes_of(text)
    assert len(codes) > 15, codes


@each_row(
    "text, codes",
    [
        ("CHEEP(0, 440)", {"TS803"}),
        ("CHEEP(0.2, 440-660)", {"TS841"}),
        ("CHEEP(440, 1000)", {"TS811"}),
        ("LOOP(FOREVER);CHEEP(1, 440);END_LOOP", set()),
        ("M(50, 50);CHEEP(1, 440)", {"TS826"}),  # BEEP would wait
        ("M(50, 50);BEEP(1, 440)", set()),
        ("CHEEP(6, 440);WHILE(TIME < 5);F(1, 60);END_WHILE", set()),
        ("BEEP(6, 440);WHILE(TIME < 5);F(1, 60);END_WHILE", {"TS827"}),
        ("WHEN(DISTANCE < 10);S;CHEEP(1, 440);END_WHEN;LOOP(FOREVER);F(2, 60);END_LOOP",
         {"TS834"}),
    ],
)  # fmt: skip
def test_a_sound_of_zero_length_is_not_waited_for(text: str, codes: set[str]) -> None:
    assert codes_of(f"SI|{text}") == codes
