"""A program as one line for a robot that reads text, and the plain code that the robot makes of it.

Knows where a space is needed. Works on tokens, so that numbers and brackets stay as they are
written, and so does the order of everything. It is made for texts in which nothing is wrong.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from tiniscript.base.source import Source, Span
from tiniscript.base.words import ALIASES, WORDS
from tiniscript.bytecode.opcodes import op_at
from tiniscript.codegen.lower import lower
from tiniscript.semantics.ir import Program
from tiniscript.syntax.checksums import with_checksum
from tiniscript.syntax.lexer import END, NEWLINE, NUMBER, WORD, Token, scan

EMPTY_PROGRAM = "SI|"  # a program that does nothing: an empty line would be none


def spell_out(tokens: Iterable[Token]) -> Iterator[Token]:
    """Yield tokens; in place of a word that stands for instructions those of them."""
    rest = iter(tokens)
    for token in rest:
        word = WORDS.get(token.text)
        if word is None or not word.stands_for:
            yield token
            continue
        values = _values(rest) if word.arguments else []
        value_of = dict(zip([part.name.upper() for part in word.arguments], values, strict=True))
        expansion = []
        for part in scan(word.stands_for).tokens[:-1]:
            expansion += value_of.get(part.text, [part._replace(start=token.start, end=token.end)])
        yield from spell_out(expansion)


def _values(tokens: Iterator[Token]) -> list[list[Token]]:
    """Take the brackets of a call; return the tokens of each value in them."""
    values: list[list[Token]] = [[]]
    depth = 0
    for token in tokens:
        depth += (token.kind == "(") - (token.kind == ")")
        if depth == 0:
            break
        if token.kind == "," and depth == 1:
            values.append([])
        elif token.kind != "(" or depth > 1:
            values[-1].append(token)
    return values


def line_of(source: Source) -> str:
    """Return a program's text as one line, without its end: the same instructions."""
    parts: list[str] = []
    brackets = 0
    before = ""  # the kind of the last token, or nothing at the beginning
    has_ended = False  # whether an instruction has ended since then
    for token in spell_out(scan(source.text).tokens):
        kind = token.kind
        if kind is END:
            break
        if kind is NEWLINE or kind == ";":
            has_ended = has_ended or not brackets
            continue
        if has_ended and before not in ("", "|"):
            parts.append(";")
        elif before in (WORD, NUMBER) and kind in (WORD, NUMBER):
            parts.append(" ")
        parts.append(ALIASES.get(token.text, token.text))
        brackets += (kind == "(") - (kind == ")")
        before, has_ended = kind, False
    return with_checksum("".join(parts) or EMPTY_PROGRAM)


class PlainPlace(NamedTuple):
    """What `span` of the text says makes the code from `offset` on."""

    offset: int
    span: Span


class PlainCode(NamedTuple):
    """`length` is that with short jumps; it is the code's own where the code fits a level.

    The offsets of `places` count so, too.
    """

    code: bytes
    length: int
    places: tuple[PlainPlace, ...]


def plain_code(program: Program) -> PlainCode:
    """Return the plain code of a checked program, as it is written."""
    code, its_places = lower(program, plain=True)
    short = _short_offsets(code)
    places = tuple(PlainPlace(short[place.offset], place.span) for place in its_places)
    return PlainCode(code, short[len(code)], places)


def _short_offsets(code: bytes) -> dict[int, int]:
    """Return where each instruction, and the end, would be if no jump were a far one."""
    short_offsets, at, excess_bytes = {0: 0}, 0, 0
    while at < len(code):
        op = op_at(code, at)
        assert op is not None
        at += op.size
        excess_bytes += op.name.endswith("_FAR")
        short_offsets[at] = at - excess_bytes
    return short_offsets
