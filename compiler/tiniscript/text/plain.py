"""Plain code: what a robot makes of the text of a program, as `docs/text.md` has it.

`codegen` makes it. This knows how long it is on a robot, where all jumps are short.
"""

from __future__ import annotations

from typing import NamedTuple

from tiniscript.bytecode.opcodes import BY_CODE
from tiniscript.codegen.lower import lower
from tiniscript.semantics.ir import Program
from tiniscript.source import Span


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
    found, at, far = {0: 0}, 0, 0
    while at < len(code):
        op = BY_CODE[code[at]]
        assert op is not None
        at += op.size
        far += op.name.endswith("_FAR")
        found[at] = at - far
    return found
