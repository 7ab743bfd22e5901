"""Calls whose values are all there, but in another form: each gets all of them where it has them.

`F(20, CM, 60)` has its unit as a value of its own, `BEEP(1, 1,000)` a comma between thousands, and
`M(50, 80, 3)` the seconds of a W.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from tiniscript.base.source import Edit, Source, Span
from tiniscript.base.words import UNIT_OF, WAYS, WORDS, Word
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic, Repair
from tiniscript.recovery.meanings import LONG_S, MOST_POWER
from tiniscript.recovery.writing import without_note

_VALUE = r"[^(),;{}\n]*(?:\([^()\n]*\)[^(),;{}\n]*)*"
_CALL = re.compile(rf"(?<!\w)([A-Za-z]+)[ \t]*\(({_VALUE}(?:,{_VALUE})*)\)")
_COMMA = re.compile(r",(?![^()]*\))")  # outside of inner brackets
_THOUSANDS = re.compile(r"([1-9]\d{0,2})((?:,\d{3})+)")
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
_UNIT = rf"(?P<unit>{'|'.join(WAYS)})"
_UNIT_BEFORE = re.compile(rf"(?i){_UNIT}[ \t]+(?P<value>[\w.]+)")


class _Call(NamedTuple):
    """A call of a word, its values as they are written, and where the text has it."""

    word: Word
    values: Sequence[str]
    span: Span
    text: str

    def with_values(self, values: Sequence[str]) -> str:
        return f"{self.text.partition('(')[0]}({', '.join(values)})"


def misplaced_values(source: Source) -> list[Diagnostic]:
    """Return what is told of calls whose values are in another form."""
    told = []
    start = 0
    for line in source.text.split("\n"):
        for call in _calls(without_note(line)[0], start):
            laws = (_unit_apart(call), _thousands(call), _seconds_of_motors(call))
            told += [found for found in laws if found][:1]
        start += len(line) + 1
    return told


def _calls(body: str, start: int) -> Iterator[_Call]:
    for match in _CALL.finditer(body):
        word = WORDS.get(match[1].upper())
        if word is not None and word.arguments:
            span = Span(start + match.start(), start + match.end())
            yield _Call(word, _parted(match[2]), span, match[0])


def _parted(values: str) -> list[str]:
    return [each.strip() for each in _COMMA.split(values)]


def _told(call: _Call, code: codes.Code, fix: str, is_sure: bool, **values: str) -> Diagnostic:
    repair = Repair((Edit(call.span, fix),), is_sure)
    return Diagnostic(code, call.span, {**values, "fix": fix}, call.span, repair)


def _unit_apart(call: _Call) -> Diagnostic | None:
    """`F(20, CM, 60)`, `F(CM, 20, 60)`, `F(20, 60, CM)`, `F(CM SIDE, 60)`."""
    unit = UNIT_OF.get(call.word.text, "")
    values = [each for each in call.values if each.upper() != unit]
    before = _UNIT_BEFORE.fullmatch(values[0]) if values else None
    if before and before["unit"].upper() == unit and len(values) == len(call.values):
        values[0] = before["value"]
    elif len(values) != len(call.values) - 1:
        return None
    if not unit or len(values) != len(call.word.arguments) or not all(values):
        return None
    first, second = (word for word, its in UNIT_OF.items() if its == unit)
    fix = call.with_values([f"{values[0]} {unit}", *values[1:]])
    return _told(call, codes.UNIT_PLACE, fix, True, found=unit, first=first, second=second)


def _thousands(call: _Call) -> Diagnostic | None:
    """`BEEP(1, 1,000)`: a comma parts thousands, where nothing that has decimals goes."""
    wanted, found = call.word.arguments, _THOUSANDS.search(call.text)
    if found is None or len(call.values) <= len(wanted):
        return None
    joined = _THOUSANDS.sub(lambda it: it[0].replace(",", ""), call.text)
    inside = joined.partition("(")[2].rpartition(")")[0]
    values = _parted(inside)
    is_of_time = any(
        argument.unit == "s" and value not in call.values
        for argument, value in zip(wanted, values, strict=False)
    )
    if len(values) != len(wanted) or is_of_time:
        return None
    fix = call.with_values(values)
    return _told(call, codes.BAD_NUMBER, fix, True, found=found[0])


def _seconds_of_motors(call: _Call) -> Diagnostic | None:
    """`M(50, 80, 3)`: how long the motors run is said by a W after them."""
    if call.word.text != "M" or len(call.values) != len(call.word.arguments) + 1:
        return None
    *powers, time = call.values
    is_time = bool(_NUMBER.fullmatch(time)) and 0 < float(time) < LONG_S
    are_powers = all(not _NUMBER.fullmatch(it) or abs(float(it)) <= MOST_POWER for it in powers)
    if not is_time or not are_powers:
        return None
    fix = f"{call.with_values(powers)};W({time})"
    values = {"word": "M", "usage": call.word.usage, "wanted": "2", "found": "3", "number": ""}
    return _told(call, codes.ARGUMENT_COUNT, fix, False, **values)
