"""Changes of a text.

Knows spans and texts. Knows no program.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from tiniscript.source import Span


class Edit(NamedTuple):
    """`text` takes the place of `span`; an empty span is where it is put."""

    span: Span
    text: str


def applied(text: str, edits: Iterable[Edit]) -> str:
    """Return the text with these changes. They must not overlap."""
    pieces, place = [], 0
    for span, new in sorted(edits):
        pieces += [text[place : span.start], new]
        place = span.end
    return "".join((*pieces, text[place:]))


def overlap(one: Iterable[Edit], other: Iterable[Edit]) -> bool:
    """Whether two changes touch the same place."""
    others = list(other)
    return any(
        a.span.start <= b.span.end and b.span.start <= a.span.end for a in one for b in others
    )
