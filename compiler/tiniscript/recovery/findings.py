"""What people are told of the codes that were handed over: typed values and edits.

Each finding is judged by what is left of the text's mistakes with its edits. All else is read as
if they were made, so that no consequence of a mistake is reported.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from tiniscript.diagnostics.codes import CODES, Diagnostic, Repair
from tiniscript.recovery import rows
from tiniscript.recovery.setup import setup
from tiniscript.source import Edit, Source, Span, applied

Check = Callable[[str], Sequence[Diagnostic]]


class NoBar(NamedTuple):
    """`sign` or a `letter` that looks like it stands behind `found` in the place of the bar."""

    found: str
    sign: str
    letter: str
    fix: str


def findings(source: Source, found: Sequence[Diagnostic], check: Check) -> list[Diagnostic]:
    """Return what is wrong with a text by the codes that were handed over.

    `found` is what the parser and the checker, which `check` asks, say of the text.
    """
    said = _no_bar(source)
    return [said] if said and said.repair and _is_better(source, found, said.repair, check) else []


def moved_back(found: Diagnostic, edits: Sequence[Edit]) -> Diagnostic:
    """Return a diagnostic of the text with these edits, as one of the text without them."""
    values = dict(found.values)
    if values.get("also"):
        spans = (each.split(":") for each in values["also"].split())
        moved = (_before(Span(int(start), int(end)), edits) for start, end in spans)
        values["also"] = " ".join(f"{start}:{end}" for start, end in moved)
    place = found.place and _before(found.place, edits)
    repair = found.repair
    if repair is not None:
        own = tuple(Edit(_before(each.span, edits), each.text) for each in repair.edits)
        repair = repair._replace(edits=own)
    return Diagnostic(found.code, _before(found.span, edits), values, place, repair)


def _before(span: Span, edits: Sequence[Edit]) -> Span:
    """Return where a span of the text with edits stood before them; all of one it begins in."""
    start = end = shift = 0
    for each in sorted(edits):
        begin = each.span.start + shift
        behind = begin + len(each.text)
        shift = behind - each.span.end
        if span.start >= behind:
            start = shift
        elif span.start > begin:
            start = span.start - each.span.start
        if span.end > begin:
            end = shift if span.end >= behind else span.end - each.span.end
    return Span(span.start - start, max(span.start - start, span.end - end))


def _no_bar(source: Source) -> Diagnostic | None:
    lines = source.text.split("\n")
    begun = setup(lines)
    if begun is None or "~" in lines[begun.line][begun.end :]:
        return None  # what has a checksum is copied again
    at = sum(len(line) + 1 for line in lines[: begun.line])
    span = Span(at + begun.start, at + begun.end)
    edits = [Edit(span, begun.right)]
    fix = begun.right
    if begun.close is not None:
        close = Span(at + begun.close, at + begun.close + 1)
        edits.append(Edit(close, ""))
        fix += source[Span(span.end, close.start)]
    sign = source[Span(span.start + len(begun.head), span.end)].strip()
    said = NoBar(begun.head, "" if sign.isalpha() else sign, sign if sign.isalpha() else "", fix)
    repair = Repair(tuple(edits), begun.is_sure)
    return Diagnostic(CODES[rows.SETUP_CODE], span, said._asdict(), None, repair)


def _is_better(source: Source, found: Sequence[Diagnostic], repair: Repair, check: Check) -> bool:
    """Whether fewer mistakes are left, or the first one comes behind what was repaired."""
    after = [each for each in check(applied(source.text, repair.edits)) if each.is_mistake]
    first = repair.edits[0]
    is_behind = all(each.span.start >= first.span.start + len(first.text) for each in after)
    return is_behind or len(after) < sum(each.is_mistake for each in found)
