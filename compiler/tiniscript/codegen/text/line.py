"""A program as one line for a robot that reads text, and the plain code that the robot makes of it.

Knows where a space is needed. Works on tokens, so that numbers and brackets stay as they are
written, and so does the order of everything. It is made for texts without mistakes.
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

EMPTY_PROGRAM = "SI|"  # a program that does nothing, because an empty line is not a program


def spell_out(tokens: Iterable[Token]) -> Iterator[Token]:
    """Yield tokens; in place of a word that stands for instructions those of them."""
    tokens_left = iter(tokens)
    for token in tokens_left:
        word = WORDS.get(token.text)
        if word is None or not word.expansion:
            yield token
            continue
        values = _values(tokens_left) if word.arguments else []
        value_of = dict(
            zip([parameter.name.upper() for parameter in word.arguments], values, strict=True)
        )
        expansion = []
        for token_of_expansion in scan(word.expansion).tokens[:-1]:
            expansion += value_of.get(
                token_of_expansion.text,
                [token_of_expansion._replace(start=token.start, end=token.end)],
            )
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
    open_brackets = 0
    previous_kind = ""  # the kind of the last token, or nothing at the beginning
    has_ended = False  # whether an instruction has ended since then
    for token in spell_out(scan(source.text).tokens):
        kind = token.kind
        if kind is END:
            break
        if kind is NEWLINE or kind == ";":
            has_ended = has_ended or not open_brackets
            continue
        if has_ended and previous_kind not in ("", "|"):
            parts.append(";")
        elif previous_kind in (WORD, NUMBER) and kind in (WORD, NUMBER):
            parts.append(" ")
        parts.append(ALIASES.get(token.text, token.text))
        open_brackets += (kind == "(") - (kind == ")")
        previous_kind, has_ended = kind, False
    return with_checksum("".join(parts) or EMPTY_PROGRAM)


class PlainLocation(NamedTuple):
    """The span of the text that the code from `offset` on comes from."""

    offset: int
    span: Span


class PlainCode(NamedTuple):
    """`short_length` is that with short jumps; it is the code's own where the code fits a level.

    The offsets of `locations` count so, too.
    """

    code: bytes
    short_length: int
    locations: tuple[PlainLocation, ...]


def plain_code(program: Program) -> PlainCode:
    """Return the plain code of a checked program, as written."""
    code, locations = lower(program, is_plain=True)
    short_offsets = _short_offsets(code)
    short_locations = tuple(
        PlainLocation(short_offsets[location.offset], location.span) for location in locations
    )
    return PlainCode(code, short_offsets[len(code)], short_locations)


def _short_offsets(code: bytes) -> dict[int, int]:
    """Return the offsets of all instructions, and of the end, if all jumps were short."""
    short_offsets, offset, excess_bytes = {0: 0}, 0, 0
    while offset < len(code):
        op = op_at(code, offset)
        assert op is not None
        offset += op.size
        excess_bytes += op.name.endswith("_FAR")
        short_offsets[offset] = offset - excess_bytes
    return short_offsets
