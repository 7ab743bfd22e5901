"""Source text and places in it; and text of others as a terminal may have it.

Knows how bytes become text and where a line begins. Knows nothing of the language.
Places are counted in characters from 0; people see lines and columns from 1.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterable
from typing import NamedTuple

LARGEST_SOURCE_BYTES = 1_000_000  # bytes
# Endings of file names; editors on Windows add .txt.
PROGRAM_SUFFIXES = (".ts", ".tini", ".ts.txt", ".tini.txt")
# The spaces of all keyboards and phones, as a set in a regular expression.
SPACES = r" \t\f\v\u00a0\u2000-\u200b\u202f\u3000\ufeff"

LINE_END = re.compile(r"\r\n|\n|\r")


class Span(NamedTuple):
    """The characters from `start` up to, not including, `end`."""

    start: int
    end: int


class Edit(NamedTuple):
    """`text` takes the place of `span`; an empty span is where it is put."""

    span: Span
    text: str


def apply_edits(text: str, edits: Iterable[Edit]) -> str:
    """Return the text with these changes. They must not overlap."""
    pieces, offset = [], 0
    for span, new_text in sorted(edits):
        pieces += [text[offset : span.start], new_text]
        offset = span.end
    return "".join((*pieces, text[offset:]))


def edits_overlap(edits: Iterable[Edit], other_edits: Iterable[Edit]) -> bool:
    """Whether two changes touch the same place."""
    other_list = list(other_edits)
    return any(
        a.span.start <= b.span.end and b.span.start <= a.span.end for a in edits for b in other_list
    )


class Source:
    """A program's text, and the name under which messages speak of it."""

    def __init__(self, text: str, name: str = "") -> None:
        self.text = text
        self.name = name
        self._line_starts: list[int] | None = None

    def position(self, offset: int) -> tuple[int, int]:
        """Return the line and the column, both from 1, of the character at `offset`."""
        starts = self._find_line_starts()
        line = bisect_right(starts, offset)
        return line, offset - starts[line - 1] + 1

    def line_text(self, line: int) -> str:
        """Return the text of a line, from 1, without its end."""
        starts = self._find_line_starts()
        end = starts[line] if line < len(starts) else len(self.text)
        return self.text[starts[line - 1] : end].rstrip("\r\n")

    def line_span(self, line: int) -> Span:
        """Return the span of a line, counted from 1, including its line end; the last line includes
        the line end before it.
        """
        starts = self._find_line_starts()
        if line < len(starts):
            return Span(starts[line - 1], starts[line])
        return Span(len(self.text[: starts[line - 1]].rstrip("\r\n")), len(self.text))

    def __getitem__(self, span: Span) -> str:
        return self.text[span.start : span.end]

    def _find_line_starts(self) -> list[int]:
        if self._line_starts is None:
            self._line_starts = [0, *(match.end() for match in LINE_END.finditer(self.text))]
        return self._line_starts


class Unreadable(Exception):
    """Bytes that are no text: `reason` is too_large, binary or encoding; `offset` in bytes."""

    def __init__(self, reason: str, offset: int = 0) -> None:
        super().__init__(reason)
        self.reason = reason
        self.offset = offset


def decode(data: bytes) -> str:
    """Return the text of a file: UTF-8, with or without a byte order mark.

    Raises Unreadable if it is too large, holds NUL bytes or is no UTF-8. UTF-16 with its mark,
    which Windows calls Unicode, is text in another encoding, in spite of its NUL bytes.
    """
    if len(data) > LARGEST_SOURCE_BYTES:
        raise Unreadable("too_large", LARGEST_SOURCE_BYTES)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        is_utf16 = data.startswith((b"\xff\xfe", b"\xfe\xff"))
        nul = -1 if is_utf16 else data.find(b"\0", 0, 4096)
        raise Unreadable("encoding" if nul < 0 else "binary", error.start) from None
    nul = text.find("\0")
    if nul >= 0:
        raise Unreadable("binary", len(text[:nul].encode()))
    return text


REPLACEMENT_SIGN = "?"  # replaces a character that is not printable


def printable(text: str, most_characters: int | None = None) -> str:
    """Return a text without control characters, line ends and marks of direction.

    Text longer than `most_characters` characters is cut visibly.
    """
    shown_text = text if most_characters is None else text[:most_characters]
    if not shown_text.isprintable():
        shown_text = "".join(
            character if character.isprintable() else REPLACEMENT_SIGN for character in shown_text
        )
    return shown_text + "…" if len(shown_text) < len(text) else shown_text
