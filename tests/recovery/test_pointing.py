"""The caret points at the text that the message names, in all programs of pupils."""

from __future__ import annotations

import pytest

from tests.pupils.corpus import check, entries
from tests.support.rows import each_row
from tiniscript.base.source import Source
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.rendering import found_names, message
from tiniscript.recovery.meanings import plain

# Findings that are counted, calculated, a sign for words, or a note's text.
OTHERS = (
    codes.ARGUMENT_COUNT, codes.CALL_VALUES, codes.OUT_OF_RANGE, codes.MISSING_VALUE,
    codes.IN_A_NOTE,
)  # fmt: skip


def without_spaces(text: str) -> str:
    return "".join(plain(text).split())


@pytest.mark.sampled("part")
@pytest.mark.parametrize("part", range(4))
def test_the_caret_points_at_the_text_that_the_message_names(part: int) -> None:
    count = 0
    for entry in entries()[part::4]:
        source = Source(entry.program)
        for diagnostic in check(entry.program):
            named_text = without_spaces(diagnostic.values.get("found", ""))
            shown_message = message(diagnostic, source, "en")
            line = source.line_text(shown_message.line)
            if not named_text or diagnostic.code in OTHERS or not found_names(diagnostic):
                continue
            if named_text in without_spaces(line):
                count += 1
                end = (
                    shown_message.end_column - 1
                    if shown_message.end_line == shown_message.line
                    else len(line)
                )
                assert without_spaces(line[shown_message.column - 1 : end]) == named_text, (
                    entry.program,
                    diagnostic,
                )
    assert count > 200


@each_row(
    "program, piece",
    [
        ("DISTÂNCIA := 5", ":="),
        ("TAMAÑO := 5", ":="),
        ("LADO := 5", ":="),
        ("IF(DISTANCE == 10);S;ENDIF", "=="),
        ("F(2, 80)&B(2, 80)", "&"),
        ("if(no DISTANCE < 10);S;ENDIF", "no"),
        ("se NÃO(DISTANCE < 10);S;FIM", "se"),
    ],
)
def test_a_message_names_only_the_sign(program: str, piece: str) -> None:
    diagnostic = check(program)[0]
    assert diagnostic.values["found"].lower() == program[slice(*diagnostic.span)] == piece


@each_row(
    "program, fix",
    [
        ("“F(2, 80); R(90 DEG, 60)”", "F(2, 80); R(90 DEG, 60)"),
        ("“SI|F(2, 80); S”", "SI|F(2, 80); S"),
        ("«F(2, 80); S»", "F(2, 80); S"),
        ("S\n  „F(2, 80); S“", "F(2, 80); S"),
        ("‘F(2, 80); S’\nS", "F(2, 80); S"),
    ],
)
def test_a_quoted_line_is_reported_once(program: str, fix: str) -> None:
    (diagnostic,) = check(program)
    assert (
        diagnostic.code is codes.QUOTE
        and diagnostic.repair is not None
        and diagnostic.repair.is_sure
    )
    assert message(diagnostic, Source(program), "en").fix == fix
    assert program[slice(*diagnostic.span)].startswith(tuple("“«„‘"))
