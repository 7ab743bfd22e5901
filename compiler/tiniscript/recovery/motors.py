"""Motors that a program sets one by one, `motorLeft.run(60)`: one M sets both.

A pair that stands together is one M with both powers, in whichever order. Of one alone it is said
that M has both, since nobody knows what the other wheel does.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import zip_longest
from typing import NamedTuple

from tiniscript.base.source import Edit, Source, Span
from tiniscript.base.words import WORDS, foreign_word_hints, lexicon_concept, lexicon_meaning
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic, Repair
from tiniscript.recovery.meanings import plain
from tiniscript.recovery.writing import without_note

_SET = re.compile(r"(?P<name>[^\W\d][\w.]*)[ \t]*\([ \t]*(?P<power>-?\d+)[ \t]*%?[ \t]*\)")
_PIECE = re.compile(r"[^;{}|\n]+")
_PART = re.compile(r"[^\W\d_]+?(?=[A-Z](?:[a-z]|$)|[_.\d]|$)|[^\W\d_]+")
_SEPARATORS = " \t\r\n;"
_SIDES = {"L": "left", "R": "right"}


class _Motor(NamedTuple):
    """One motor that is set: `side` is left or right."""

    side: str
    power: str
    name: str
    span: Span


def one_by_one(source: Source) -> list[tuple[Diagnostic, Edit]]:
    """Return what is told of motors that are set one by one, and how the rest is read."""
    text, found = source.text, [*_motors(source.text)]
    result: list[tuple[Diagnostic, Edit]] = []
    passed: set[Span] = set()
    for one, other in zip_longest(found, found[1:]):
        if one.span in passed:
            continue
        is_pair = other and one.side != other.side
        if is_pair and not text[one.span.end : other.span.start].strip(_SEPARATORS):
            powers = {it.side: it.power for it in (one, other)}
            fix = f"M({powers['left']}, {powers['right']})"
            whole = Span(one.span.start, other.span.end)
            edit = Edit(whole, fix)
            said = {"found": one.name, "right": "M", "takes": WORDS["M"].usage, "fix": fix}
            repair = Repair((edit,), False)
            passed.add(other.span)
            result.append((Diagnostic(codes.OTHER_LANGUAGE, whole, said, whole, repair), edit))
        else:
            values = {"found": one.name, **foreign_word_hints("MOTOR")}
            name = Span(one.span.start, one.span.start + len(one.name))
            blank = Edit(one.span, " " * (one.span.end - one.span.start))
            result.append((Diagnostic(codes.UNKNOWN_WORD, name, values), blank))
    return result


def _motors(text: str) -> Iterator[_Motor]:
    start = 0
    for line in text.split("\n"):
        for piece in _PIECE.finditer(without_note(line)[0]):
            match = _SET.fullmatch(piece[0].strip())
            side = _side_of(match["name"]) if match else ""
            if match and side and not re.search(rf"(?i)\bDEF\s+{match['name']}\b", text):
                begin = start + piece.start() + piece[0].index(match[0])
                span = Span(begin, begin + len(match[0]))
                yield _Motor(side, match["power"], match["name"], span)
        start += len(line) + 1


def _side_of(name: str) -> str:
    """Return the side of the motor that a name says, "" where it says no motor or no side."""
    parts = [plain(part) for part in _PART.findall(name)]
    sides = {side for side in map(_side, parts) if side}
    is_motor = any(
        lexicon_concept(part) == "M" or lexicon_meaning(part, "engine") for part in parts
    )
    return sides.pop() if is_motor and len(sides) == 1 else ""


def _side(part: str) -> str:
    said = (side for side in _SIDES.values() if lexicon_meaning(part, side))
    return next(said, _SIDES.get(lexicon_concept(part) or part, ""))
