"""A redundant plus, and increments and decrements, are read in the same way in every place."""

from __future__ import annotations

import pytest

from tests.pupils.corpus import check
from tests.studio.programs import programs
from tiniscript.base.source import Source, apply_edits
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.fixing import edits_of, repair_program
from tiniscript.diagnostics.rendering import message
from tiniscript.syntax.lexer import NEWLINE, NUMBER, scan

PROGRAM_TEXTS = [program.text for program in programs()
                 if program.robot == "tinibot" and "~" not in program.text]  # fmt: skip
STEPS = ("{}++", "{}--", "{} ++", "{} --")
STATEMENT_STARTS = (";", "|", NEWLINE)  # signs before an assigned name
FRAMES = (
    "{}",
    "SI|{}",
    "LOOP(3);{};END_LOOP",
    "IF(DISTANCE < 10);{};ENDIF",
    "{};S",
    "TASK;{};END_TASK",
)


@pytest.mark.sampled("part")
@pytest.mark.parametrize("part", range(3))
def test_a_plus_before_a_number_is_removed(part: int) -> None:
    """This holds for every number of every right program, except in `X = +1`, perhaps `X += 1`."""
    count = 0
    for text in PROGRAM_TEXTS[part::3]:
        if check(text):
            continue
        tokens = scan(text).tokens
        for k, token in enumerate(tokens):
            is_set = tokens[k - 1].kind == "=" and (k < 3 or tokens[k - 3].kind in STATEMENT_STARTS)
            if tokens[k - 1].kind == "-":  # the number would lose its sign: it is only shown
                continue
            if token.kind is not NUMBER or is_set:
                continue
            wrong_text = f"{text[: token.start]}+{text[token.start :]}"
            diagnostics = check(wrong_text)
            assert [(diagnostic.code, diagnostic.span.start) for diagnostic in diagnostics] == [
                (codes.EXTRA_WORD, token.start)
            ], wrong_text
            assert (
                apply_edits(wrong_text, edits_of(diagnostics[0]) or [])
                == repair_program(wrong_text, check).text
                == text
            )
            count += 1
    assert count > 100


@pytest.mark.parametrize("text", ["X = 1;X = +5", "X = 1;W(X);X =+ 5", "X = 1\nX = +5"])
def test_a_plus_after_an_assignment_may_be_an_increment(text: str) -> None:
    diagnostics = check(f"{text};SHOW(X)")
    assert "X = X + 5" in message(diagnostics[0], Source(text), "en").fix
    assert repair_program(f"{text};SHOW(X)", check).text == f"{text};SHOW(X)"


@pytest.mark.parametrize("frame", FRAMES)
@pytest.mark.parametrize("step", STEPS)
def test_increments_and_decrements_are_recognized_everywhere(step: str, frame: str) -> None:
    text = frame.format("SPEED = 60;" + step.format("SPEED") + ";F(1, SPEED)")
    sign = step.strip("{} ")[0]
    mended_text = repair_program(text, check).text
    assert f"SPEED = SPEED {sign}" in mended_text and mended_text.count("SPEED") == 4
    assert not [diagnostic for diagnostic in check(mended_text) if diagnostic.code.is_mistake]


@pytest.mark.parametrize("word", ["AND", "OR"])
@pytest.mark.parametrize(
    "frame", ["F(5, 60) UNTIL{}", "IF{};S;ENDIF", "WHILE{};F(1, 50);END_WHILE", "WHEN{};S;END_WHEN",
              "IF(DISTANCE < 5);S;ELSEIF{};S;ENDIF", "W(5) UNTIL{}"],
)  # fmt: skip
def test_bracketed_conditions_are_one_condition(frame: str, word: str) -> None:
    text = frame.format(f"(DISTANCE < 10) {word} (LIGHT_L < 20)")
    mended_text = repair_program(text, check).text
    assert not [diagnostic for diagnostic in check(mended_text) if diagnostic.code.is_mistake]
    assert mended_text.replace(" ", "") == frame.format(
        f"((DISTANCE < 10) {word}(LIGHT_L < 20))"
    ).replace(" ", "")
