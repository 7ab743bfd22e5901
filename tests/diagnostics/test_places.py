"""The places of messages: each caret is right, in any text."""

from __future__ import annotations

import random
import re

import pytest

from tests.support.texts import LANGUAGES, gap_names
from tiniscript import Compilation, check_text, robots
from tiniscript.base.source import Source, Span
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Code, Diagnostic
from tiniscript.diagnostics.rendering import Message, as_text, message

KIT = robots.load("grabber").kit


def message_at(text: str, start: int, end: int, code: Code = codes.EXTRA_CLOSE) -> Message:
    """Return the message of a diagnostic that is put at a place by hand."""
    return message(Diagnostic(code, Span(start, end)), Source(text), "en")


def picture(text: str, start: int, end: int) -> list[str]:
    """Return the line and the carets for a place in a text."""
    return as_text(message_at(text, start, end), Source(text), "en").split("\n")[:2]


# -- places ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "start", "end", "place"),
    [
        ("abc", 0, 1, (1, 1, 1, 2)),
        ("abc", 1, 3, (1, 2, 1, 4)),
        ("a\nbc\nd", 2, 4, (2, 1, 2, 3)),
        ("a\r\nbc\r\nd", 3, 5, (2, 1, 2, 3)),
        ("a\rbc", 2, 3, (2, 1, 2, 2)),
        ("ñandú;x", 6, 7, (1, 7, 1, 8)),
        ("🤖;x", 2, 3, (1, 3, 1, 4)),
        ("ab\ncd", 1, 4, (1, 2, 2, 2)),  # over two lines
        ("ab\r\ncd\r\n", 0, 4, (1, 1, 1, 3)),  # the line end is left out
        ("ab\n", 2, 3, (1, 3, 1, 4)),  # only a line end
        ("ab", 2, 2, (1, 2, 1, 3)),  # the end of the text: its last character
        ("ab;  \n\n", 7, 7, (1, 3, 1, 4)),
        ("ab\ncd", 2, 2, (1, 2, 1, 3)),  # an empty place at a line's end
        ("ab\ncd", 3, 3, (2, 1, 2, 2)),  # at the beginning of a line
        ("\n\n", 2, 2, (1, 1, 1, 2)),
        ("", 0, 0, (1, 1, 1, 1)),
        ("ab", 5, 9, (1, 2, 1, 3)),  # outside
    ],
)
def test_a_place_has_its_line_and_column(
    text: str, start: int, end: int, place: tuple[int, int, int, int]
) -> None:
    assert message_at(text, start, end)[2:6] == place


def test_carets_stand_under_the_place() -> None:
    assert picture("F(2 80)", 2, 6) == ["line 1:  F(2 80)", "           ^^^^"]
    assert picture("S\nS\n\n)", 5, 6) == ["line 4:  )", "         ^"]


def test_a_tab_is_four_columns() -> None:
    assert picture("\tF\t)", 3, 4) == ["line 1:      F    )", "                  ^"]
    assert picture("F\t)", 1, 2) == ["line 1:  F    )", "          ^^^^"]


def test_wide_characters_take_two_columns_and_combining_marks_none() -> None:
    assert picture("机器人)", 3, 4) == ["line 1:  机器人)", "               ^"]
    assert picture("机器人)", 1, 2) == ["line 1:  机器人)", "           ^^"]
    assert picture("🤖)", 1, 2) == ["line 1:  🤖)", "           ^"]
    assert picture("e\u0301)", 2, 3) == ["line 1:  e\u0301)", "          ^"]
    assert picture("\u3000)", 1, 2) == ["line 1:    )", "           ^"]


def test_invisible_characters_are_replaced() -> None:
    assert picture("\x00\x1b[31m\x7f\u202e\udc80)", 9, 10) == [
        "line 1:  ␀␛[31m␡\ufffd\ufffd)",
        "                  ^",
    ]


def test_a_place_over_several_lines_is_marked_to_the_end_of_the_first() -> None:
    assert picture("SHOW(1,\n2,\n3)", 4, 13) == ["line 1:  SHOW(1,", "             ^^^"]
    assert picture("SHOW(1,\r\n2)", 4, 11) == ["line 1:  SHOW(1,", "             ^^^"]


def test_a_place_at_a_line_end_is_marked_after_the_line() -> None:
    assert picture("SHOW(\n", 5, 6) == ["line 1:  SHOW(", "              ^"]
    assert picture("\n\n", 0, 1) == ["line 1:", "         ^"]


def test_a_long_line_is_shown_in_part() -> None:
    text = "F(1, 50);" * 1000
    line, carets = picture(text, 4500, 4508)
    assert line == "line 1:  …" + text[4460:4560] + "…"
    assert carets == " " * 50 + "^" * 8
    line, carets = picture(text, 0, 9000)
    assert line == "line 1:  " + text[:100] + "…"
    assert carets == " " * 9 + "^" * 100
    line, carets = picture(text, 8999, 9000)
    assert line == "line 1:  …" + text[8959:]
    assert carets == " " * 50 + "^"
    exact = "x" * 99 + ")"
    assert picture(exact, 99, 100)[0] == "line 1:  " + exact


# -- arbitrary text -------------------------------------------------------------------------------

PIECES = """
    SI| SB| PING| | ; ; ; , ( ) ( ) = == < > + - * / % F B L R M S W F( W( M( BEEP SHOW SHOW( IF IF(
    ELSE ELSEIF ELSEIF( ENDIF LOOP LOOP( LOOP(FOREVER) END_LOOP END WHILE WHILE( END_WHILE BREAK DEF
    DANCE END_DEF UNTIL UNTIL( FOREVER TRUE FALSE NOT AND OR ABS( MIN( ROUND( RANDOM( TIME X Y X= Y=
    DISTANCE LIGHT_R BUTTON GRIPPER GRIPPER( LED LED( 0 1 2 80 1.5 1,5 0.12345 99999999999 2s 1.2.3
    THEN Y O FORWARD ADELANTE PARAR SI( REPEAT año círculo _X [ ] { } {found} @ @number # // " ' ‘ ”
    机器 🤖 é é $ ! && || ≠ – TASK WHEN check_connection START
    （ ） ， += ++ -- := <- /* */ REPEAT REPEAT( FOR END_REPEAT FIN SINO ELIF( MIENTRAS(
    FUNCTION SIEMPRE HASTA( AZAR( TIEMPO TURN LEFT NO IS LESS THAN cm s 80% 90° F2 W1 LET CALL
    REM t=2 "80" “F(1,5)”
"""
BLANKS = ("", "", " ", " ", "\t", "\n", "\n", "\r\n", "\r", "\u00a0", "\0", "\x1b", "\u2028")


def some_text(rng: random.Random) -> str:
    count, pieces = rng.choice((1, 3, 10, 40)), PIECES.split()
    return "".join(rng.choice(pieces) + rng.choice(BLANKS) for _ in range(count))


def some_characters(rng: random.Random) -> str:
    ranges = ((0, 127), (0, 0x2FF), (0x2000, 0x20FF), (0, 0x10FFFF))
    return "".join(chr(rng.randint(*rng.choice(ranges))) for _ in range(rng.choice((1, 5, 300))))


def check_messages(compilation: Compilation) -> None:
    """Check all that is true of the messages for any text."""
    text, source = compilation.source.text, compilation.source
    for diagnostic in compilation.diagnostics:
        assert gap_names(diagnostic.code.number) <= set(diagnostic.values)
        for lang in LANGUAGES:
            full_message = message(diagnostic, source, lang)
            assert full_message.severity == ("mistake" if diagnostic.is_mistake else "warning")
            assert (full_message.line, full_message.column) < (
                full_message.end_line,
                full_message.end_column,
            ) or not text
            assert full_message.column <= len(source.line_text(full_message.line)) + 1
            assert full_message.message.isprintable()
            assert full_message.fix.isprintable()
            rows = as_text(full_message, source, lang).split("\n")
            assert len(rows) in (3, 4)
            assert all(row.isprintable() for row in rows)
            assert re.fullmatch(r" +\^+", rows[1])
            assert len(rows[1]) < 130
            assert rows[-1].endswith(f"[{diagnostic.code.number}]")


@pytest.mark.sampled("seed")
@pytest.mark.parametrize("seed", range(20))
def test_any_text_gets_well_formed_messages(seed: int) -> None:
    rng = random.Random(seed)
    for _ in range(50):
        check_messages(check_text(some_text(rng), KIT))
        check_messages(check_text(some_characters(rng), KIT))


@pytest.mark.parametrize(
    "text",
    ["BREAK F2", "BREAK;\nF2\nS", "S\nhello", "SI|F(1,80)\nhello there", "F(1,80) SI|S\nFin",
     "IF(TRUE)\nS\nF(1 80)\nEND", "LOOP(2)\nF(1,80)\nLOOP(3)\nfoo\nEND_LOOP"],
)  # fmt: skip
def test_each_kind_of_line_end_ends_a_line(text: str) -> None:
    compilation = check_text(text, KIT)
    check_messages(compilation)
    assert check_text(text.replace("\n", "\r"), KIT).diagnostics == compilation.diagnostics


def test_foreign_letters_in_place_of_a_number_get_well_formed_messages() -> None:
    check_messages(check_text("X=é", KIT))


def test_endless_combining_marks_are_shown_in_part() -> None:
    rows = picture("e" + "\u0301" * 100_000 + ")", 100_001, 100_002)
    assert len(rows[0]) < 250
    rows = picture("(" * 500_000, 250_000, 250_001)
    assert len(rows[0]) < 120
