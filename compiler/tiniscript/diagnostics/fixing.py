"""Makes the sure repairs of a program.

A repair is sure where the message leaves no choice: it drops or invents no number, it does not
guess a name, and with it the program has fewer mistakes. All others are left to the reader.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
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
    **dict.fromkeys((codes.MISSING_OPEN, codes.OUT_OF_RANGE, codes.UNIT_PAIR, codes.OTHER_LANGUAGE,
                     codes.QUESTION_BEHIND, codes.NOT_CALLABLE), ("fix",)),
    codes.EMPTY_BRACKETS: ("word",),
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


# Codes of headers: how a block ends is not looked at before its header is right.
_HEADERS = frozenset((
    codes.SPANISH_IF, codes.OTHER_LANGUAGE, codes.MISSING_OPEN, codes.HEADER_SEPARATOR,
    codes.BRACES, codes.ASKED_BEHIND, codes.NEEDLESS_FRAME, codes.CASES, codes.PASTED,
))  # fmt: skip
MANY = 100  # diagnostics after which a program is not read on
CHECKS = 400  # of one program, fewer of a long one
CHECKED_CHARACTERS = 600_000


OFFERS = 20  # repairs of one text that are tried


class Fixed(NamedTuple):
    """`text` is the program with its sure repairs, `left` what it still has."""

    text: str
    repairs: int
    left: list[Diagnostic]


_Step = tuple[str, list[Diagnostic], int]
Check = Callable[[str], list[Diagnostic]]


class _Allowed:
    """Counts how often a text is checked: a long program takes long, and has many mistakes."""

    def __init__(self, check: Check, left: int) -> None:
        self._check = check
        self.left = left

    def check(self, text: str) -> list[Diagnostic]:
        self.left -= 1
        return self._check(text)


class _Repair(NamedTuple):
    code: Code
    edits: list[Edit]


def fixed(text: str, check: Check) -> Fixed:
    """Return a program with its sure repairs. `check` finds the diagnostics of a text."""
    allowed = _Allowed(check, min(CHECKS, 20 + CHECKED_CHARACTERS // (len(text) + 1)))
    check = allowed.check
    found = check(text)
    count = 0
    while allowed.left > 0:
        repairs = _sure(found, text)
        step = _all_of(repairs, text, found, check) or _one_of(repairs, text, found, check)
        if step is None:
            break
        text, found, made = step
        count += made
    return Fixed(text, count, found)


def offers(text: str, found: list[Diagnostic], check: Check) -> list[list[Edit]]:
    """Return for each diagnostic the changes that a reader may choose to make, or none.

    With them the program has fewer mistakes. They may be a guess: somebody looks at them.
    """
    source, tried = Source(text), 0
    offered: list[list[Edit]] = []
    for diagnostic in found:
        edits = edits_of(diagnostic) if diagnostic.is_mistake else None
        if not edits or tried >= OFFERS or any(_is_sealed(edit, source) for edit in edits):
            offered.append([])
            continue
        tried += 1
        after = check(applied(text, edits))
        offered.append(edits if is_better(after, found, diagnostic.code, edits) else [])
    return offered


def _all_of(
    repairs: list[_Repair], text: str, found: list[Diagnostic], check: Check
) -> _Step | None:
    """Make all repairs at once that do not touch, if each of them counts."""
    chosen: list[_Repair] = []
    for repair in repairs:
        if not any(overlap(repair.edits, other.edits) for other in chosen):
            chosen.append(repair)
    if len(chosen) < 2:
        return None
    changed = applied(text, [edit for repair in chosen for edit in repair.edits])
    after = check(changed)
    # The reader stops at so many, of which several may be one here: what comes after it comes now.
    is_cut = len(found) > MANY // 4
    if is_cut and _mistakes(after) <= _mistakes(found) and _first(after) > _first(found):
        return changed, after, len(chosen)
    if _mistakes(after) > _mistakes(found) - len(chosen):
        return None
    return changed, after, len(chosen)


def _one_of(
    repairs: list[_Repair], text: str, found: list[Diagnostic], check: Check
) -> _Step | None:
    """Make the first repair that leaves fewer mistakes."""
    for repair in repairs:
        changed = applied(text, repair.edits)
        after = check(changed)
        if is_better(after, found, repair.code, repair.edits):
            return changed, after, 1
    return None


def is_better(
    after: list[Diagnostic], found: list[Diagnostic], code: Code, edits: list[Edit]
) -> bool:
    """Whether a repair leaves fewer mistakes.

    Or as many, where it has uncovered one elsewhere: how a block ends is not looked at before its
    header is right, and of several signs that are missing on a line the first one is reported.
    """
    if _mistakes(after) != _mistakes(found):
        return _mistakes(after) < _mistakes(found)
    if code not in _HEADERS and not any(each.code is code for each in after):
        return False
    shift = 0
    for span, new in sorted(edits):
        start = span.start + shift
        end = start + len(new)
        shift += len(new) - (span.end - span.start)
        if any(each.is_mistake and start <= each.span.start < end for each in after):
            return False
    return True


def _sure(found: list[Diagnostic], text: str) -> list[_Repair]:
    return [
        _Repair(each.code, [*each.repair.edits])
        for each in found[:MANY]  # the others come when these are made
        if each.repair is not None and each.repair.is_sure
    ]


def _is_sealed(edit: Edit, source: Source) -> bool:
    """Whether a change is in a line that has a checksum: it is to be copied again."""
    return "~" in source.line_text(source.position(edit.span.start)[0])


def _first(found: list[Diagnostic]) -> int:
    """Return where the first mistake is in the text."""
    return min((each.span.start for each in found if each.is_mistake), default=sys.maxsize)


def _mistakes(found: list[Diagnostic]) -> int:
    return sum(each.is_mistake for each in found)
