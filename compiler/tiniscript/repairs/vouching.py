"""Lets a diagnostic offer a repair only where copying it does what was written.

Two things are asked of each repair, whichever rule has made it. It keeps what the text said: see
`accounting`. And with it the instruction that it is in has no mistake any more, so that nobody
copies a part of what they meant. A diagnostic whose repair fails says how to write it instead.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import NamedTuple

from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.repairs.accounting import lost, makes_up
from tiniscript.repairs.placing import edits_of
from tiniscript.repairs.whole_calls import with_whole_calls
from tiniscript.source import Edit, Source, applied, overlap
from tiniscript.syntax.call_suggestions import LONG_TIME_S
from tiniscript.words import usage_of

Check = Callable[[str], Sequence[Diagnostic]]
CHECKED_CHARACTERS = 60_000  # in which repairs are tried that touch another one
MANY = 100  # diagnostics of a text whose repairs are tried
# Mistakes of other places, or that no repair of an instruction can know.
_ELSEWHERE = frozenset((
    codes.NEVER_ENDS, codes.NOT_OPEN, codes.WRONG_END, codes.AFTER_ELSE, codes.BRACES,
    codes.BREAK_OUTSIDE, codes.NAME_TAKEN, codes.DEF_TWICE, codes.CALL_BEFORE_DEF,
    codes.CALLS_ITSELF, codes.DEF_NOT_TOP, codes.OTHER_ROBOT, codes.NO_BUTTON,
    codes.USED_BEFORE_SET, codes.SETUP_TWICE, codes.UNTIL_ALONE,
))  # fmt: skip
# Mistakes between two instructions, which are reported where the second one begins.
_BETWEEN = (codes.MISSING_SEPARATOR, codes.HEADER_SEPARATOR, codes.EXTRA_WORD)
# What says the power of a move that stands before it: `at 50 percent`.
_ITS_POWER = re.compile(
    r"(?i)[\s,]*(at|with|con|al|a|en|by|de|potencia|power|speed|velocidad)\b[^();]*[0-9]"
)
_TIME = re.compile(r"[FBLR]\(([0-9]{1,9}(?:\.[0-9]+)?)\s*,")
_REST = re.compile(r"[^;\r\n{}]*")


class _Offer(NamedTuple):
    place: int  # of its diagnostic among all
    edits: list[Edit]


def vouched(found: Sequence[Diagnostic], source: Source, check: Check) -> list[Diagnostic]:
    """Return diagnostics of which none offers a repair that loses something or is only a part.

    `check` finds the diagnostics of another text.
    """
    kept = list(found)
    offers = []
    for k, diagnostic in enumerate(found[:MANY]):
        edits = edits_of(diagnostic, source) if diagnostic.is_mistake else None
        if not edits:
            continue
        before = " ".join(source[edit.span] for edit in edits)
        after = " ".join(edit.text for edit in edits)
        is_long = diagnostic.code is codes.OTHER_LANGUAGE and _takes_long(before, after)
        if is_long or (diagnostic.values.get("fix") and lost(before, after, diagnostic.code)):
            kept[k] = _without(diagnostic)
        else:
            offers.append(_Offer(k, edits))
    groups = _apart(offers)
    tried = 1 + CHECKED_CHARACTERS // (len(source.text) + 1)
    for group in groups[:tried]:
        for k in _partial(group, source.text, found, check):
            kept[k] = _without(kept[k])
    for offer in (each for group in groups[tried:] for each in group):
        if found[offer.place].values.get("fix"):
            kept[offer.place] = _without(kept[offer.place])
    return with_whole_calls(kept, source, check)


def _apart(offers: Sequence[_Offer]) -> list[list[_Offer]]:
    """Return groups of repairs that do not touch one another."""
    groups: list[list[_Offer]] = []
    for offer in offers:
        for group in groups:
            if not any(overlap(offer.edits, other.edits) for other in group):
                group.append(offer)
                break
        else:
            groups.append([offer])
    return groups


def _takes_long(before: str, after: str) -> bool:
    """Whether `move(50, 50)` would become a move of 50 s: powers or steps are meant."""
    time = _TIME.match(after)
    is_same = time is not None and re.search(rf"\(\s*{re.escape(time[1])}\s*[,)]", before)
    return time is not None and bool(is_same) and float(time[1]) >= LONG_TIME_S


def _without(diagnostic: Diagnostic) -> Diagnostic:
    """Return a diagnostic that says how it is written, and offers no repair."""
    said = diagnostic.values
    usage = said.get("usage") or usage_of(said.get("right") or said.get("word", ""))
    values = {**said, "fix": "", "usage": usage}
    return diagnostic._replace(values=values, place=None)


def _speaks_against(diagnostic: Diagnostic) -> bool:
    """Whether a diagnostic says that the instruction it is in is not meant as it stands."""
    if not diagnostic.is_mistake:
        is_a_drive = "drive" in diagnostic.values  # `avanza 1 minuto y 30 segundos`
        return diagnostic.code in (codes.SWAPPED, codes.LONG_TIME) and not is_a_drive
    if diagnostic.code is codes.OUT_OF_RANGE and diagnostic.values.get("fix"):
        return False  # `F -1 80`: the next message says B
    return diagnostic.code not in _ELSEWHERE


def _is_next_step(diagnostic: Diagnostic) -> bool:
    """Whether a mistake says by itself how all of its instruction goes on."""
    is_next = diagnostic.code in (codes.MISSING_SEPARATOR, codes.EXTRA_WORD)
    ends_a_move = diagnostic.values.get("word") == "UNTIL"  # which then needs no time
    return is_next or (bool(diagnostic.values.get("fix")) and not ends_a_move)


def _partial(
    offers: list[_Offer], text: str, found: Sequence[Diagnostic], check: Check
) -> list[int]:
    """Return the diagnostics whose repair leaves a mistake in its instruction."""
    if not any(found[offer.place].values.get("fix") for offer in offers):
        return []
    changed = applied(text, [edit for offer in offers for edit in offer.edits])
    after = [each for each in check(changed) if _speaks_against(each)]
    within = [each.span.start for each in after]
    behind = [each.span.start for each in after if not _is_next_step(each)]
    between = {each.span.start for each in after if each.code in _BETWEEN}
    partial = []
    edits = sorted((edit, offer.place) for offer in offers for edit in offer.edits)
    shift = 0
    for edit, k in edits:
        start = edit.span.start + shift
        end = start + len(edit.text)
        shift += len(edit.text) - (edit.span.end - edit.span.start)
        if not found[k].values.get("fix"):
            continue
        rest = _REST.match(changed, end)
        is_wrong = any(start + (start in between) <= at < end for at in within)
        is_part = rest is not None and any(end <= at < rest.end() for at in behind)
        has_power = rest is not None and _ITS_POWER.match(rest[0]) is not None
        before = text[slice(*edit.span)]
        is_made_up = (is_part or has_power) and makes_up(before, edit.text, is_strict=has_power)
        if is_wrong or is_made_up:
            partial.append(k)
    return partial
