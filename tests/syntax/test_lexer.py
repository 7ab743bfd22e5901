"""The lexer: which tokens a text has, where they stand, and what it goes on with."""

from __future__ import annotations

import random

import pytest

from tests.oracle.interpreter import PAPER_KIT
from tests.oracle.programs import broken, program
from tiniscript.syntax.lexer import END, NEWLINE, NUMBER, ODD, WORD
from tiniscript.syntax.lexer_recovery import scan_with_repairs
from tiniscript.syntax.parser import scan

SIGNS = ("<=", ">=", "<>", "+", "-", "*", "/", "%", "=", "<", ">", "(", ")", ",", ";", "|")


def lexed(text: str) -> list[str]:
    """Return each token as `kind text`, and a sign, whose kind is its text, once."""
    tokens = scan(text).tokens
    assert tokens[-1] == (END, "", len(text), len(text))
    return [
        token.kind if token.kind == token.text else f"{token.kind} {token.text!r}"
        for token in tokens[:-1]
    ]


def reported(text: str) -> list[tuple[str, str, str | None]]:
    """Return the code of each diagnostic, what it points at and what it suggests."""
    return [
        (each.code.number, text[each.span.start : each.span.end], each.values.get("right"))
        for each in scan(text).diagnostics
    ]


# -- right texts ----------------------------------------------------------------------------------


def test_words_are_in_capitals_and_names_may_have_digits_and_underscores() -> None:
    assert lexed("if Light_R x2") == ["word 'IF'", "word 'LIGHT_R'", "word 'X2'"]


@pytest.mark.parametrize("number", ["0", "5", "007", "0.5", ".5", "2147483648.999", "1.23456"])
def test_numbers_are_digits_with_at_most_one_point(number: str) -> None:
    assert lexed(number) == [f"number {number!r}"]
    assert reported(number) == []


@pytest.mark.parametrize("sign", SIGNS)
def test_a_sign_is_a_token_of_its_own_kind(sign: str) -> None:
    assert lexed(f"A{sign}B") == ["word 'A'", sign, "word 'B'"]


def test_the_longest_sign_is_taken() -> None:
    assert lexed("<=<>>=<") == ["<=", "<>", ">=", "<"]


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_each_kind_of_line_end_is_one_token(end: str) -> None:
    assert lexed(f"S{end}S") == ["word 'S'", r"newline '\n'", "word 'S'"]
    assert scan(f"S{end}S").tokens[1].span == (1, 1 + len(end))


@pytest.mark.parametrize("space", [" ", "\t", "\u00a0", "\u2009", "\u200b", "\u3000", "\ufeff"])
def test_spaces_of_all_kinds_only_part_tokens(space: str) -> None:
    assert lexed(f"{space}S{space}{space}S{space}") == ["word 'S'", "word 'S'"]
    assert reported(f"S{space}S") == []


@pytest.mark.parametrize("dash", ["\u2010", "\u2013", "\u2014", "\u2212"])
def test_the_dashes_of_phones_are_a_minus(dash: str) -> None:
    assert lexed(f"{dash}5") == ["-", "number '5'"]
    assert reported(f"{dash}5") == []


def test_comments_are_no_tokens_and_end_with_their_line() -> None:
    scanned = scan("S // stop; now\r\nS//")
    assert [(each.text, each.start) for each in scanned.comments] == [
        ("// stop; now", 2),
        ("//", 17),
    ]
    assert lexed("S // stop; now\r\nS//") == ["word 'S'", r"newline '\n'", "word 'S'"]


def test_spans_are_places_in_the_text() -> None:
    tokens = scan("SI|F(2, .5)").tokens
    assert [token.span for token in tokens] == [
        (0, 2), (2, 3), (3, 4), (4, 5), (5, 6), (6, 7), (8, 10), (10, 11), (11, 11),
    ]  # fmt: skip


def test_an_empty_text_has_only_its_end() -> None:
    assert scan("").tokens == [(END, "", 0, 0)]


# -- what is repaired -----------------------------------------------------------------------------

REPAIRS: dict[str, tuple[list[str], list[tuple[str, str, str | None]]]] = {
    "a == b": (["word 'A'", "=", "word 'B'"], [("TS010", "==", "=")]),
    "a != b": (["word 'A'", "<>", "word 'B'"], [("TS010", "!=", "<>")]),
    "a && !b": (
        ["word 'A'", "word 'AND'", "word 'NOT'", "word 'B'"],
        [("TS010", "&&", "AND"), ("TS010", "!", "NOT")],
    ),
    "a ≤ b": (["word 'A'", "<=", "word 'B'"], [("TS010", "≤", "<=")]),
    "f[2, 80]": (
        ["word 'F'", "(", "number '2'", ",", "number '80'", ")"],
        [("TS010", "[", "(")],  # once for the pair
    ),
    "f[2]]": (
        ["word 'F'", "(", "number '2'", ")", ")"],
        [("TS010", "[", "("), ("TS010", "]", ")")],
    ),
    "w（1）;w（2）": (
        ["word 'W'", "(", "number '1'", ")", ";", "word 'W'", "(", "number '2'", ")"],
        [("TS010", "（", "(")],  # once for the text
    ),
    "{}": (["{", "}"], [("TS047", "{", None)]),
    "5.": (["number '5'"], [("TS008", "5.", "5")]),
    "1.2.3": (["number '1.2'"], [("TS008", "1.2.3", "")]),
    "10cm": (["number '10'"], [("TS049", "10cm", "10")]),
    "2x": (["number '2'"], [("TS008", "2x", "")]),
    "año": (["word 'ANIO'"], [("TS009", "año", "anio")]),
    "_paso": (["word 'PASO'"], [("TS009", "_paso", "paso")]),
    '"5"': (["number '5'"], [("TS006", '"5"', "5")]),
    "“hola”": (["odd '“hola”'"], [("TS006", "“hola”", "")]),  # a sentence
    "“HOLA”": (["word 'HOLA'"], [("TS006", "“HOLA”", "HOLA")]),
    '"F(2)"': (["odd '\"F(2)\"'"], [("TS006", '"F(2)"', "F(2)")]),
    "S # stop": (["word 'S'"], [("TS007", "# stop", "// stop")]),
    "/* a\nb */S": (["word 'S'"], [("TS007", "/* a\nb */", "")]),
    "?¿S": (["odd '?'", "odd '¿'", "word 'S'"], [("TS005", "?¿", None)]),  # once for a run
}


@pytest.mark.parametrize("text", REPAIRS)
def test_what_is_not_read_is_reported_once_and_stands_for_what_is_meant(text: str) -> None:
    tokens, diagnostics = REPAIRS[text]
    assert lexed(text) == tokens
    assert reported(text) == diagnostics


# -- any text -------------------------------------------------------------------------------------


def texts() -> list[str]:
    rng = random.Random(7)
    signs = "\n\r;,|()[]{}<>=!&+-*/%.\"'`#°ñé5aS_ \t\u00a0\u2013（）\x07\U0001f600"
    noise = ["".join(rng.choices(signs, k=rng.randrange(40))) for _ in range(1500)]
    return noise + [broken(rng, program(rng, PAPER_KIT)) for _ in range(300)]


def test_tokens_and_comments_of_any_text_follow_one_another() -> None:
    for text in texts():
        scanned = scan(text)
        at = 0
        for token in sorted((*scanned.tokens, *scanned.comments), key=lambda each: each.start):
            assert at <= token.start <= token.end <= len(text), text
            at = token.end
        assert at == len(text)


def test_what_is_neither_space_nor_reported_is_a_token_as_it_is_written() -> None:
    for text in texts():
        scanned = scan(text)
        told = {k for each in scanned.diagnostics for k in range(*each.span)}
        dashes = {"\u2013": "-"}
        for token in (*scanned.tokens, *scanned.comments):
            written = text[token.start : token.end]
            is_own = token.kind in (WORD, NUMBER, "comment", *SIGNS) and token.start not in told
            if is_own and not written.startswith(("（", "）", "]", "[")):  # said once before
                assert token.text == dashes.get(written, written.upper()) or token.kind == "comment"
            assert token.kind in (WORD, NUMBER, NEWLINE, END, ODD, "comment", "{", "}", *SIGNS)


def test_a_text_has_the_same_tokens_in_both_lexers() -> None:
    """That of right texts reads nothing which the other one takes for something else."""
    rng = random.Random(11)
    pieces = [
        *"""F W X SI b br span u < > = / * % ( ) , ; | - + . 0 3 50 000 1.5 .5 O.5 : 1:30 [ ] '
        " # // /* */ \\n & ! Ñ é _ ½ ° − <b> </b> <br/> 50% ``` $""".split(),  # noqa: SIM905
        *"\n\r\t            ",
    ]
    told = ["X<3=)", "X < 3=)", "F(1,50 %)", "F(1 000,5)", "X<b>Y", "X <u >", "1<EM>5", "<!--X-->"]
    noise = ["".join(rng.choices(pieces, k=rng.randint(1, 7))) for _ in range(20_000)]
    right = [program(rng, PAPER_KIT) for _ in range(50)]
    plain = 0
    for text in (*texts(), *told, *noise, *right):
        scanned, whole = scan(text), scan_with_repairs(text)
        assert scanned == whole, text
        plain += not whole.diagnostics
    assert plain > 5_000
