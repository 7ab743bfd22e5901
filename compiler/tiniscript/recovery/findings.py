"""What people are told of a text that is read wholly and surely: typed values and edits.

Each finding is judged by what is left of the text's mistakes with its edits. All else is read as
if they were made, so that no consequence of a mistake is reported.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Sequence
from typing import NamedTuple

from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import CODES, Diagnostic, Repair
from tiniscript.kit import Kit
from tiniscript.recovery import rows
from tiniscript.recovery.advice import advised
from tiniscript.recovery.concepts import lexemes
from tiniscript.recovery.explanation import explained
from tiniscript.recovery.search import Candidate, Mistakes, candidate
from tiniscript.recovery.setup import setup
from tiniscript.recovery.writing import without_note
from tiniscript.source import Edit, Source, Span, applied, overlap
from tiniscript.words import WORDS

LONGEST = 4_000  # characters of a text that is read as a whole
Check = Callable[[str], Sequence[Diagnostic]]


class NoBar(NamedTuple):
    """`sign` or a `letter` that looks like it stands behind `found` in the place of the bar."""

    found: str
    sign: str
    letter: str
    fix: str


class Findings(NamedTuple):
    """What is told of a text, and the edits with which the rest of it is read."""

    told: list[Diagnostic]
    edits: list[Edit]


def findings(source: Source, found: Sequence[Diagnostic], check: Check, kit: Kit) -> Findings:
    """Return what is wrong with a text that can be read, or with words behind its instructions.

    `found` is what the parser and the checker, which `check` asks, say of the text.
    """
    said = _no_bar(source)
    if said and said.repair and _is_better(source, found, said.repair, check):
        return Findings([said], [*said.repair.edits])
    repaired = _meant(source, found, check, kit)
    if repaired:
        edits = [edit for each in repaired if each.repair for edit in each.repair.edits]
        return Findings(repaired, edits)
    told = advised(source.text, kit)
    return Findings([each.diagnostic for each in told], [each.passed for each in told])


def _meant(source: Source, found: Sequence[Diagnostic], check: Check, kit: Kit) -> list[Diagnostic]:
    """Return what is wrong with a text that is read wholly and surely, else nothing."""
    text = source.text.replace("\r\n", "\n")
    said = {text: _mistakes(found)}

    def mistakes(program: str) -> Sequence[str]:
        if program not in said:
            said[program] = _mistakes(check(program))
        return said[program]

    meant = sure(text, kit, mistakes)
    return [] if meant is None else [
        Diagnostic(CODES[each.code], each.span, each.slip._asdict(), each.place,
                   Repair(tuple(each.edits), True))
        for each in explained(source.text, meant)
    ]  # fmt: skip


def sure(text: str, kit: Kit, mistakes: Mistakes) -> Candidate | None:
    """Return the program that a text means wholly and surely, where all of its rewrites are told.

    Lines of the text end with a newline alone.
    """
    is_begun_otherwise = codes.SETUP_UNKNOWN.number in mistakes(text)
    if len(text) > LONGEST or "\r" in text or "~" in text or is_begun_otherwise:
        return None
    meant = candidate(text, kit, mistakes, is_whole=True)
    if meant is None or not (meant.is_whole and meant.is_applied):
        return None
    told = explained(text, meant)
    said_with = {each.code for each in told} | {step.code for _, step in meant.steps}
    has_all = all(each.slip.right for each in told) and _keeps(text, meant.text, said_with)
    return meant if told and has_all else None


def _keeps(text: str, new: str, said_with: set[str]) -> bool:
    """Whether all numbers of a text are used, and all names that it gives to variables and DEFs."""
    before, after = (Counter(each.text for each in lexemes(_bare(it))) for it in (text, new))
    names = {each.upper() for each in re.findall(r"(?i)(?<=\bDEF )\w+|\w+(?=\s*=)", new)} - {*WORDS}
    is_kept = all(after[name] >= before[name] for name in names)
    old, kept = (sorted(re.findall("[0-9]", _bare(it))) for it in (text, new))
    return is_kept and (old == kept or bool(said_with & rows.OTHER_NUMBERS))


def _bare(text: str) -> str:
    return "\n".join(without_note(line)[0] for line in text.split("\n"))


def _mistakes(found: Sequence[Diagnostic]) -> list[str]:
    return [each.code.number for each in found if each.is_mistake]


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
        passed = [each for each in edits if each.text.isspace()]  # words that nothing may drop
        repair = Repair((), False) if overlap(own, passed) else repair._replace(edits=own)
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
