"""Makes the sure repairs of a program.

A repair is sure where the message leaves no choice: it drops or invents no number, it does not
guess a name, and with it the program has fewer mistakes. All others are left to the reader.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from tiniscript.base.source import Edit, Source, applied, overlap
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Code, Diagnostic

# The gap of a message that is to be written. What is only an example (`F(2, 80)` for F alone), or
# names two ways, is no change.
_WRITTEN = ("fix", "right", "near")  # the first of them that a diagnostic has
_GAPS: dict[Code, tuple[str, ...]] = {
    **dict.fromkeys((codes.UNKNOWN_WORD, codes.UNKNOWN_NAME, codes.WANTS_CONDITION,
                     codes.MIXED_COMPARE, codes.NAMED_ARGUMENT, codes.NAME_WITH_SPACE,
                     codes.WORDS_BEHIND, codes.SEVERAL_ORDERS, codes.REPEATED), _WRITTEN),
    **dict.fromkeys((codes.MISSING_OPEN, codes.UNIT_PAIR, codes.OTHER_LANGUAGE,
                     codes.QUESTION_BEHIND, codes.NOT_CALLABLE, codes.SWAPPED, codes.ZERO_BEFORE,
                     codes.LATE_CHECK, codes.FROZEN_UNTIL, codes.FROZEN_WHILE, codes.TURNED_ROUND,
                     codes.EXACT, codes.UNUSED_READING), ("fix",)),
    codes.EMPTY_BRACKETS: ("word",), codes.OUT_OF_RANGE: ("fix", "most"),
    codes.LONG_TIME: ("fix", "way"),
}  # fmt: skip
_ELSEWHERE = (codes.QUESTION_BEHIND, codes.NOT_CALLABLE)  # without a place they show a way


def edits_of(diagnostic: Diagnostic) -> list[Edit] | None:
    """Return the changes that the thing to try asks for; None where it is no change of the text."""
    if diagnostic.repair is not None:
        return [*diagnostic.repair.edits] or None
    values, place = diagnostic.values, diagnostic.place
    new = next((values[gap] for gap in _GAPS.get(diagnostic.code, ()) if gap in values), "")
    if not new or (place is None and diagnostic.code in _ELSEWHERE):
        return None
    return [Edit(place or diagnostic.span, new)]


MANY = 100  # diagnostics after which a program is not read on
CHECKS = 400  # of one program, fewer of a long one
CHECKED_CHARACTERS = 600_000
OFFERS = 20  # repairs of one text that are tried


class Fixed(NamedTuple):
    """`text` is the program with its sure repairs, `left` what it still has."""

    text: str
    repairs: int
    left: list[Diagnostic]


Check = Callable[[str], list[Diagnostic]]


def fixed(text: str, check: Check) -> Fixed:
    """Return a program with its sure repairs. `check` finds the diagnostics of a text.

    A long program takes long, and has many mistakes: it is not checked so often.
    """
    left = min(CHECKS, 20 + CHECKED_CHARACTERS // (len(text) + 1)) - 1
    found = check(text)
    count = 0
    steps = _steps(found)
    while left > 0 and (repairs := next(steps, None)):
        edits = [edit for each in repairs for edit in each]
        changed = applied(text, edits)
        after = check(changed)
        left -= 1
        if is_better(after, found, edits):
            text, found, count, steps = changed, after, count + len(repairs), _steps(after)
    return Fixed(text, count, found)


def _steps(found: list[Diagnostic]) -> Iterator[list[tuple[Edit, ...]]]:
    """Give the sure repairs that do not touch, and then each one alone."""
    sure = [it.repair.edits for it in found[:MANY] if it.repair and it.repair.is_sure]
    together: list[tuple[Edit, ...]] = []
    for edits in sure:
        if not any(overlap(edits, other) for other in together):
            together.append(edits)
    if len(together) > 1:
        yield together
    yield from ([edits] for edits in sure)


def offers(text: str, found: list[Diagnostic], check: Check) -> list[list[Edit]]:
    """Return for each diagnostic the changes that a reader may choose to make, or none.

    With them the program has fewer mistakes, or for a warning no more of them and the warning is
    gone. They may be a guess, and change what the program does: somebody looks at them.
    """
    source, tried = Source(text), 0
    offered: list[list[Edit]] = []
    for diagnostic in found:
        edits = edits_of(diagnostic) or [] if tried < OFFERS else []
        lines = (source.line_text(source.position(edit.span.start)[0]) for edit in edits)
        is_tried = bool(edits) and not any("~" in line for line in lines)  # else it is copied again
        tried += is_tried
        after = check(applied(text, edits)) if is_tried else []
        is_chosen = is_tried and (
            is_better(after, found, edits)
            if diagnostic.is_mistake
            else _lacks(after, diagnostic.code, found)
        )
        offered.append(edits if is_chosen else [])
    return offered


def _lacks(after: Sequence[Diagnostic], code: Code, found: Sequence[Diagnostic]) -> bool:
    """Whether there is one warning fewer of this kind, and no mistake more."""
    before, left = (sum(each.code is code for each in every) for every in (found, after))
    return left < before and _mistakes(after) <= _mistakes(found)


def is_better(
    after: Sequence[Diagnostic], found: Sequence[Diagnostic], edits: Sequence[Edit]
) -> bool:
    """Whether a repair leaves fewer mistakes.

    Or as many, where it has uncovered one elsewhere: how a block ends is not looked at before its
    header is right, and of several signs that are missing on a line the first one is reported.
    """
    if _mistakes(after) != _mistakes(found):
        return _mistakes(after) < _mistakes(found)
    shift = 0
    for span, new in sorted(edits):
        start = span.start + shift
        end = start + len(new)
        shift += len(new) - (span.end - span.start)
        if any(each.is_mistake and start <= each.span.start < end for each in after):
            return False
    return True


def _mistakes(found: Sequence[Diagnostic]) -> int:
    return sum(each.is_mistake for each in found)
