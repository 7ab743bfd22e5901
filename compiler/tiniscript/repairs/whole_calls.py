"""One message for a single instruction whose values are said in another way.

Where the repairs of its mistakes do not make the instruction right, and all that it says is one
call (`said_calls`), that call is offered in their place.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import NamedTuple

from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.repairs.placing import edits_of
from tiniscript.repairs.said_calls import LONGEST, Said, said_call
from tiniscript.repairs.shifted_keys import shifted_call
from tiniscript.source import Edit, Source, Span, applied
from tiniscript.syntax.lexer import NEWLINE
from tiniscript.syntax.parser import scan
from tiniscript.words import WORDS

Check = Callable[[str], Sequence[Diagnostic]]
MANY = 100  # diagnostics and instructions of a text that are read
_ENDS = re.compile(r"[;\r\n|{}]|//")
_CLOSES = re.compile(r"[^;\r\n|{}()]*\)")  # `F(2;80)`
# `F;2;80`: what stands behind the `;` is a number alone.
_IN_PIECES = re.compile(
    r"(?i)\b(?:[FBLRMW]|BEEP)(?:[ \t]*;|[ \t]+[0-9][0-9.]*;)[ \t]*[0-9]"
    r"[0-9. \t%;]{0,60}(?<![; \t])"
    r"(?=[ \t]*(?:[;\r\n]|//|\Z))"
)
_UNTIL = re.compile(r"(?i)\s*\bUNTIL\b")
_VARIABLE = re.compile(r"(?:^|[;|\r\n])[ \t]*([A-Za-z]\w*)\s*=(?!=)")
_TAUGHT = re.compile(r"(?i)(?:^|[;|\r\n])[ \t]*DEF\b[\s(]*([A-Z]\w*)")
_FIRST = re.compile(r"\w*")
# `R(media vuelta)`, `L 90`: how far, and not how long.
_TURN = re.compile(r"(?i)([LR])\b(?:.*\bvueltas?\b.*|[\s(]*(?:45|90|135|180|270|360)[\s)]*)")
_WAYS = {"L": "left", "R": "right"}
# Messages that are true of the whole instruction, too.
_KEPT = (codes.MISSING_OPEN, codes.OTHER_LANGUAGE)
# Mistakes of a block, and those that have more to say than how a call is written.
_OTHERS = frozenset((
    codes.NEVER_ENDS, codes.NOT_OPEN, codes.WRONG_END, codes.BRACES, codes.SETUP_TWICE,
    codes.OUT_OF_RANGE, codes.PLACEHOLDER, codes.WHICH_WAY, codes.REPEATED, codes.PASTED,
    codes.MISSING_VALUE, codes.BAR_BETWEEN, codes.WORDS_BEHIND,
))  # fmt: skip


class _Whole(NamedTuple):
    """The diagnostics `places` are in the instruction at `span`, which says `said`."""

    span: Span
    said: Said
    places: list[int]


def with_whole_calls(found: Sequence[Diagnostic], source: Source, check: Check) -> list[Diagnostic]:
    """Return the diagnostics with one for each instruction that is read as a whole."""
    text = source.text
    found = [*(_by_time(each, text) for each in found[:MANY]), *found[MANY:]]
    names = {match[1].upper() for match in _VARIABLE.finditer(text)}
    names |= {match[1].upper() for match in _TAUGHT.finditer(text)}
    wholes = [each for each in _instructions(found, text, names) if _is_better(each, found, source)]
    if not wholes:
        return list(found)
    changed = applied(text, [Edit(each.span, each.said.call) for each in wholes])
    after = [each.span.start for each in check(changed) if each.is_mistake]
    kept: list[Diagnostic | None] = list(found)
    shift = 0
    for each in wholes:
        start = each.span.start + shift
        end = start + len(each.said.call)
        shift += len(each.said.call) - (each.span.end - each.span.start)
        if not any(start <= place < end for place in after):
            for k in each.places:
                kept[k] = None
            kept[each.places[0]] = _of_the_whole(found[each.places[0]], each, text)
    return [each for each in kept if each is not None]


def _by_time(diagnostic: Diagnostic, text: str) -> Diagnostic:
    """Say of a turn by degrees or rounds that it takes a time."""
    if not diagnostic.is_mistake or diagnostic.code in _OTHERS:
        return diagnostic
    span = _around(text, diagnostic.span.start)
    turn = _TURN.fullmatch(text[slice(*span)]) if span.end - span.start <= LONGEST else None
    if turn is None:
        return diagnostic
    word = turn[1].upper()
    values = {"word": word, "way": _WAYS[word], "usage": WORDS[word].usage}
    return Diagnostic(codes.WHICH_WAY, span, values)


def _instructions(found: Sequence[Diagnostic], text: str, names: set[str]) -> list[_Whole]:
    """Return the instructions with mistakes of which all is read, in order."""
    groups: dict[Span, list[int]] = {}
    for k, diagnostic in enumerate(found):
        if diagnostic.is_mistake and len(groups) < MANY:
            groups.setdefault(_around(text, diagnostic.span.start), []).append(k)
    wholes = []
    for span, places in sorted(groups.items()):
        first = _FIRST.match(text, *span)
        if first is not None and first[0].upper() in names:
            continue  # `B1`, which a DEF teaches
        shifted = shifted_call(text[slice(*span)])
        if shifted is not None:
            if shifted.call:
                typed = Said(shifted.word, shifted.call, "", shifted.sign, shifted.digit)
                wholes.append(_Whole(span, typed, places))
            continue
        said = said_call(text[slice(*span)], names)
        if said is not None and not any(found[k].code in _OTHERS for k in places):
            wholes.append(_Whole(span, said, places))
    return wholes


def _around(text: str, place: int) -> Span:
    """Return the instruction at `place`, without what stands around it and its UNTIL.

    Of one that is longer than anybody reads a part is returned that is longer than `LONGEST`.
    """
    for match in _IN_PIECES.finditer(text, max(0, place - 60), place + 60):
        if match.start() <= place < match.end():
            return Span(*match.span())
    start = max(
        (match.end() for match in _ENDS.finditer(text, max(0, place - 200), place)), default=0
    )
    if start == 0 and place > 200:
        start = place - 200
    before = text[max(0, start - 40) : start - 1]
    if text[start - 1 : start] == ";" and _CLOSES.match(text, start):  # `F(2; 80 %)`
        inner = re.search(r"[A-Za-z]\w*\s*\([^;\r\n|{}()]*\Z", before)
        start = start - 1 - len(before) + inner.start() if inner else start
    farthest = min(len(text), place + LONGEST + 1)
    cut = _ENDS.search(text, start if text[start:place].count(";") else place, farthest)
    end = cut.start() if cut else farthest
    part = text[start:end]
    if cut and cut[0] in ";|" and part.count("(") > part.count(")"):
        closes = _CLOSES.match(text, cut.end())
        end = closes.end() if closes else end
        if closes is None and text[cut.end() :][:9].lstrip(" ")[:1].isdecimal():
            end = start  # `F(2;80`
    until = _UNTIL.search(text, start, end)
    if until and until.start() >= place:
        end = until.start()
    part = text[start:end]
    return Span(start + len(part) - len(part.lstrip()), end - len(part) + len(part.rstrip()))


def _is_better(whole: _Whole, found: Sequence[Diagnostic], source: Source) -> bool:
    """Whether the repairs of the mistakes are many, or do not give what the instruction says."""
    text = source.text
    edits = [edit for k in whole.places for edit in edits_of(found[k], source) or ()]
    is_crowded = len(whole.places) > 2
    if is_crowded or not all(edits_of(found[k], source) for k in whole.places):
        return True
    start, end = whole.span
    if len(edits) == 1 and edits[0].span.start <= start and end < edits[0].span.end:
        return False  # it mends what is behind the instruction, too: its UNTIL
    inside = [edit for edit in sorted(edits) if start <= edit.span.start and edit.span.end <= end]
    if len(inside) < len(edits) or any(
        one.span.end > other.span.start for one, other in pairwise(inside)
    ):
        return True
    moved = [Edit(Span(e.span.start - start, e.span.end - start), e.text) for e in inside]
    return _signs(applied(text[start:end], moved)) != _signs(whole.said.call)


def _signs(text: str) -> list[str]:
    return [token.text for token in scan(text).tokens if token.kind is not NEWLINE]


def _of_the_whole(first: Diagnostic, whole: _Whole, text: str) -> Diagnostic:
    said = whole.said
    has_bracket = "(" in text[slice(*whole.span)]
    if said.sign:
        values = {"word": said.word.text, "fix": said.call, "sign": said.sign, "digit": said.digit}
        return Diagnostic(codes.OTHER_CALL, whole.span, values)
    if first.code in _KEPT and not (first.code is codes.MISSING_OPEN and has_bracket):
        return first._replace(values={**first.values, "fix": said.call}, place=whole.span)
    values = {"word": said.word.text, "usage": said.word.usage, "fix": said.call}
    if said.example:
        values["example"] = said.example
    return Diagnostic(codes.OTHER_CALL, whole.span, values)
