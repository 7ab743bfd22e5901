"""The place of a diagnostic: that of the text its message names, if it is in the line."""

from __future__ import annotations

import re
from functools import lru_cache

from tiniscript.base.source import Source, Span
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.diagnostics.rendering import found_names
from tiniscript.recovery.meanings import plain

# They found a calculated number.
_COUNTING_CODES = (codes.ARGUMENT_COUNT, codes.CALL_VALUES, codes.OUT_OF_RANGE)
_CODES_WITHOUT_PLACE = (
    codes.QUESTION_AFTER,
    codes.NOT_CALLABLE,
)  # without a place, they request no change


def point_at_found(diagnostic: Diagnostic, source: Source) -> Diagnostic:
    """Return a diagnostic that points at what it names, and keeps its old place for the thing to
    try."""
    code, span, place = diagnostic.code, diagnostic.span, diagnostic.place
    found_text = diagnostic.values.get("found", "").strip()
    if not found_text or code in _COUNTING_CODES or not found_names(diagnostic):
        return diagnostic
    if _normalize(source[span]) == _normalize(found_text):
        return diagnostic
    found_span = _nearest_span(found_text, span, source)
    if found_span is None:
        return diagnostic
    if place is None and code not in _CODES_WITHOUT_PLACE:
        place = span
    return diagnostic._replace(span=found_span, place=place)


def _normalize(text: str) -> str:
    return " ".join(plain(text).split())


def _nearest_span(found_text: str, span: Span, source: Source) -> Span | None:
    """Return the span of `found_text` in or nearest to a place."""
    text = source.text
    line_start = max(text.rfind("\n", 0, span.start), text.rfind("\r", 0, span.start)) + 1
    line_end = re.compile(r"[\r\n]|\Z").search(text, max(span.start, span.end))
    assert line_end is not None  # each text has an end
    line_part = _remove_accents(text[line_start : line_end.start()])
    words = r"\s*".join(map(re.escape, _remove_accents(found_text).split()))
    head = (
        r"(?<!\w)" if found_text[0].isdigit() else r"(?<![^\W\d])" * found_text[0].isalpha()
    )  # V of 2V
    tail = r"(?!\w)" * found_text[-1].isalnum()
    word_matches = [*re.finditer(f"{head}{words}{tail}", line_part)] or [
        *re.finditer(words, line_part)
    ]
    spans = (Span(line_start + match.start(), line_start + match.end()) for match in word_matches)
    return min(spans, key=lambda found_span: _distance(found_span, span), default=None)


def _distance(span: Span, other_span: Span) -> tuple[int, int]:
    """Return the distance between two spans, or 0 if one contains the other."""
    gap = max(0, other_span.start - span.end, span.start - other_span.end)
    return gap, abs(span.start - other_span.start)


@lru_cache(16)
def _remove_accents(text: str) -> str:
    """Return a text in capitals without accents, each character in its place."""
    return "".join(
        short if len(short := plain(character)) == 1 else character for character in text
    )
