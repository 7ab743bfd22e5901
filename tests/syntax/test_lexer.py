"""The lexer: which tokens a text has, and where they stand."""

from __future__ import annotations

import random

import pytest

from tests.oracle.interpreter import PAPER_KIT
from tests.oracle.programs import break_text, program
from tiniscript.syntax.lexer import END, NEWLINE, NUMBER, UNKNOWN_SIGN, WORD, scan

SIGNS = ("<=", ">=", "<>", "+", "-", "*", "/", "%", "=", "<", ">", "(", ")", ",", ";", "|")


def list_tokens(text: str) -> list[str]:
    """Return each token as `kind text`, and a sign, whose kind is its text, once."""
    tokens = scan(text).tokens
    assert tokens[-1] == (END, "", len(text), len(text))
    return [
        token.kind if token.kind == token.text else f"{token.kind} {token.text!r}"
        for token in tokens[:-1]
    ]


# -- right texts ----------------------------------------------------------------------------------


def test_words_are_in_capitals_and_names_may_have_digits_and_underscores() -> None:
    assert list_tokens("if Light_R x2") == ["word 'IF'", "word 'LIGHT_R'", "word 'X2'"]


@pytest.mark.parametrize("number", ["0", "5", "007", "0.5", ".5", "2147483648.999", "1.23456"])
def test_numbers_are_digits_with_at_most_one_point(number: str) -> None:
    assert list_tokens(number) == [f"number {number!r}"]
    assert scan(number).diagnostics == ()


@pytest.mark.parametrize("sign", SIGNS)
def test_a_sign_is_a_token_of_its_own_kind(sign: str) -> None:
    assert list_tokens(f"A{sign}B") == ["word 'A'", sign, "word 'B'"]


def test_the_longest_sign_is_taken() -> None:
    assert list_tokens("<=<>>=<") == ["<=", "<>", ">=", "<"]


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_every_line_end_is_one_token(end: str) -> None:
    assert list_tokens(f"S{end}S") == ["word 'S'", r"newline '\n'", "word 'S'"]
    assert scan(f"S{end}S").tokens[1].span == (1, 1 + len(end))


@pytest.mark.parametrize("space", [" ", "\t", "\u00a0", "\u2009", "\u200b", "\u3000", "\ufeff"])
def test_spaces_of_all_kinds_only_separate_tokens(space: str) -> None:
    assert list_tokens(f"{space}S{space}{space}S{space}") == ["word 'S'", "word 'S'"]
    assert scan(f"S{space}S").diagnostics == ()


@pytest.mark.parametrize("dash", ["\u2010", "\u2013", "\u2014", "\u2212"])
def test_dashes_typed_on_phones_are_a_minus(dash: str) -> None:
    assert list_tokens(f"{dash}5") == ["-", "number '5'"]
    assert scan(f"{dash}5").diagnostics == ()


def test_comments_are_not_tokens_and_end_with_their_line() -> None:
    scanned = scan("S // stop; now\r\nS//")
    assert [(comment.text, comment.start) for comment in scanned.comments] == [
        ("// stop; now", 2),
        ("//", 17),
    ]
    assert list_tokens("S // stop; now\r\nS//") == ["word 'S'", r"newline '\n'", "word 'S'"]


def test_spans_index_the_text() -> None:
    tokens = scan("SI|F(2, .5)").tokens
    assert [token.span for token in tokens] == [
        (0, 2), (2, 3), (3, 4), (4, 5), (5, 6), (6, 7), (8, 10), (10, 11), (11, 11),
    ]  # fmt: skip


def test_an_empty_text_has_only_its_end() -> None:
    assert scan("").tokens == [(END, "", 0, 0)]


# -- signs outside the language --------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "tokens"),
    [
        ("a == b", ["word 'A'", "=", "=", "word 'B'"]),
        ("a ≤ b", ["word 'A'", "odd '≤'", "word 'B'"]),
        ("{}", ["odd '{'", "odd '}'"]),
        ("1.2.3 5. 10mm", ["odd '1.2.3'", "odd '5.'", "odd '10mm'"]),
        ("10cms 5°C 5ºC", ["odd '10cms'", "number '5'", "odd '°'", "word 'C'", "odd '5ºC'"]),
        ("año _paso", ["odd 'año'", "odd '_paso'"]),
        ('"5"', ["odd '\"'", "number '5'", "odd '\"'"]),
        ("S # stop", ["word 'S'", "odd '#'", "word 'STOP'"]),
        ("S~12", ["word 'S'", "odd '~12'"]),
    ],
)
def test_unknown_characters_are_odd_tokens(text: str, tokens: list[str]) -> None:
    assert list_tokens(text) == tokens


@pytest.mark.parametrize("text", ["10cm", "10 Cm", "10\u00a0CM"])
def test_a_unit_is_a_word_of_its_own(text: str) -> None:
    assert list_tokens(text) == ["number '10'", "word 'CM'"]


@pytest.mark.parametrize("text", ["90°", "90º", "90 º", "90deg", "90 Deg"])
def test_a_degree_sign_is_the_word_for_degrees(text: str) -> None:
    assert list_tokens(text) == ["number '90'", "word 'DEG'"]
    assert list_tokens(f"X{text.lstrip('90')}")[0] != "word 'X90'"


# -- any text -------------------------------------------------------------------------------------


def texts() -> list[str]:
    rng = random.Random(7)
    signs = "\n\r;,|()[]{}<>=!&+-*/%.\"'`#°ñé5aS_ \t\u00a0\u2013（）\x07\U0001f600"
    noise = ["".join(rng.choices(signs, k=rng.randrange(40))) for _ in range(1500)]
    return noise + [break_text(rng, program(rng, PAPER_KIT)) for _ in range(300)]


def test_tokens_and_comments_of_any_text_follow_one_another() -> None:
    for text in texts():
        scanned = scan(text)
        position = 0
        for token in sorted((*scanned.tokens, *scanned.comments), key=lambda token: token.start):
            assert position <= token.start <= token.end <= len(text), text
            position = token.end
        assert position == len(text)


def test_everything_but_spaces_becomes_tokens_as_written() -> None:
    for text in texts():
        scanned = scan(text)
        for token in (*scanned.tokens, *scanned.comments):
            written_text = text[token.start : token.end]
            if token.kind in (WORD, NUMBER, *SIGNS):
                assert token.text == {"\u2013": "-", "°": "DEG"}.get(
                    written_text, written_text.upper()
                )
            assert token.kind in (WORD, NUMBER, NEWLINE, END, UNKNOWN_SIGN, "comment", *SIGNS)
