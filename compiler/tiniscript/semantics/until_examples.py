"""Writes examples of UNTIL with the pupil's own question and move."""

from __future__ import annotations

import re
from collections.abc import Sequence

from tiniscript.semantics import ir
from tiniscript.source import Source, Span
from tiniscript.words import WORDS, Word

_NEXT_QUESTION = re.compile(r"(?i)[\s;]{0,200}IF[ \t]*\(([^()\r\n;]{0,60}[<>=][^()\r\n;]{1,60})\)")


def asked_next(source: Source, span: Span) -> str:
    """Return the question of an IF that follows what is at `span`; an example where none does."""
    found = _NEXT_QUESTION.match(source.text, span.end)
    return found[1].strip() if found else "DISTANCE < 10"


def ended_by(
    source: Source, call: str, asked: str, word: Word | None, made: Sequence[ir.Statement]
) -> str:
    """Return how something is ended by a question: `F(5, 60); S UNTIL(c)`, `M(5, 5) UNTIL(c)`.

    `call` is what the UNTIL of `asked` stands behind, `made` what comes before that.
    """
    before = made[-1] if made else None
    if word is not None and word.role == "motors":
        return f"{call};W(FOREVER) {asked};S"
    is_stop = word is not None and word.role == "stop"
    if is_stop and isinstance(before, ir.Move) and before.until is None:
        return f"{source[before.span]} {asked}"
    return f"{WORDS['F'].example} {asked}"
