"""Calls whose values are all present, but in another form: each call gets all of them.

`F(20, CM, 60)` has its unit as a value of its own, `BEEP(1, 1,000)` a comma between thousands, and
`M(50, 80, 3)` the seconds of a W. In a row of calls, each is an instruction, even if its word is
unknown: `F(2, 80) I(1, 60)`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

from tiniscript.base.source import Edit, Source, Span
from tiniscript.base.words import (
    EXTENTS,
    POWER,
    UNIT_OF,
    WORDS,
    Word,
    expand_short,
    lexicon_concept,
    lexicon_meaning,
)
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic, Repair
from tiniscript.recovery.meanings import (
    ASKING_WORDS,
    CALL_WORDS,
    LONG_TIME_S,
    MAX_POWER,
    NEAR_COST,
    Names,
    homophone_of,
    plain,
)
from tiniscript.recovery.writing import split_note

_VALUE_PATTERN = r"[^(),;{}\n]*(?:\([^()\n]*\)[^(),;{}\n]*)*"
_CALL = re.compile(rf"(?<!\w)([A-Za-z]+)[ \t]*\(({_VALUE_PATTERN}(?:,{_VALUE_PATTERN})*)\)")
_COMMA = re.compile(r",(?![^()]*\))")  # outside of inner brackets
_THOUSANDS = re.compile(r"([1-9]\d{0,2})((?:,\d{3})+)")
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
_ANY_CALL = re.compile(rf"\w+[ \t]*\(({_VALUE_PATTERN}(?:,{_VALUE_PATTERN})*)\)")
_CALL_AFTER_BLANKS = re.compile(rf"[ \t]*(?P<call>{_ANY_CALL.pattern})")
_INSTRUCTION = re.compile(r"[^;{}|]+")
_DEF = re.compile(r"(?i)\bDEF\s+(\w+)")
_SPACED_POINT = re.compile(r"(?<=\d)[ \t]*\.[ \t]+(?=[-\d.])")
_PERCENT_AT_END = re.compile(r"[ \t]*%$")
_TIME_WITH_UNIT = re.compile(r"(\d+(?:\.\d+)?)[ \t]*([^\W\d]*)")
_MAX_ADDED_LETTERS = 3  # letters: a phone may have added some to one
_UNIT_PATTERN = rf"(?P<unit>{'|'.join(EXTENTS)})"
_UNIT_BEFORE_VALUE = re.compile(rf"(?i){_UNIT_PATTERN}[ \t]+(?P<value>[\w.]+)")
_STORED_WITH_UNIT = re.compile(rf"(?i)(\w+)[ \t]*=[ \t]*(-?[\d.]+)[ \t]*({'|'.join(EXTENTS)})")


class _Call(NamedTuple):
    """A call of a word, its values as they are written, and where the text has it."""

    word: Word
    values: Sequence[str]
    span: Span
    text: str

    def with_values(self, values: Sequence[str]) -> str:
        return f"{self.text.partition('(')[0]}({', '.join(values)})"


def misplaced_values(source: Source) -> list[Diagnostic]:
    """Return the diagnostics for calls with values in another form."""
    diagnostics = []
    line_start = 0
    def_names = {match[1].upper() for match in _DEF.finditer(source.text)}
    for line in source.text.split("\n"):
        for call in _calls(split_note(line)[0], line_start):
            if call.word.text in def_names:
                continue  # its values may be the DEF's parameters
            call_diagnostics = (
                _point_diagnostic(call),
                _unit_diagnostic(call),
                _thousands_diagnostic(call),
                _motor_time_diagnostic(call, source.text),
            )
            diagnostics += [diagnostic for diagnostic in call_diagnostics if diagnostic][:1]
        line_start += len(line) + 1
    return diagnostics


def run_on_calls(source: Source, names: Names) -> list[Diagnostic]:
    """Return the diagnostics for calls without a separator, one with an unknown word.

    If all are known, a search reads the line.
    """
    diagnostics = []
    line_start = 0
    for line in source.text.split("\n"):
        for piece in _INSTRUCTION.finditer(split_note(line)[0]):
            calls = _only_calls(piece[0])
            words = [plain(call["call"].partition("(")[0].strip()) for call in calls]
            words_meant = [
                word if names.is_name(word) else names.find_meaning(word) for word in words
            ]
            likely_words = {
                *words,
                *(names.find_meaning(word, NEAR_COST) for word in words),
            }  # `Antil(LINE_R)`
            are_calls = {*words_meant} <= {*CALL_WORDS, *words, ""} and not likely_words & {
                *ASKING_WORDS,
                "UNTIL",
            }
            if len(calls) > 1 and are_calls and not all(words_meant):
                instruction_start = line_start + piece.start()
                first_offset, end_offset = calls[0].start("call"), calls[-1].end()
                ends = [
                    (call.end(), next_call.start("call")) for call, next_call in pairwise(calls)
                ]
                edits = tuple(
                    Edit(Span(instruction_start + a, instruction_start + b), ";") for a, b in ends
                )
                values = {
                    "before": calls[0]["call"],
                    "fix": ";".join(call["call"] for call in calls),
                }
                whole_span = Span(instruction_start + first_offset, instruction_start + end_offset)
                span = Span(instruction_start + ends[0][0] - 1, instruction_start + ends[0][0])
                repair = Repair(edits, False)
                diagnostics.append(
                    Diagnostic(codes.MISSING_SEPARATOR, span, values, whole_span, repair)
                )
        line_start += len(line) + 1
    return diagnostics


def _only_calls(piece: str) -> list[re.Match[str]]:
    """Return the calls of a text that consists of calls, else nothing."""
    calls: list[re.Match[str]] = []
    offset = 0
    while call := _CALL_AFTER_BLANKS.match(piece, offset):
        calls.append(call)
        offset = call.end()
    return [] if piece[offset:].strip() else calls


def _calls(body: str, start: int) -> Iterator[_Call]:
    for match in _CALL.finditer(body):
        word = WORDS.get(match[1].upper())
        if word is not None and word.arguments:
            span = Span(start + match.start(), start + match.end())
            yield _Call(word, _split_values(match[2]), span, match[0])


def _split_values(values: str) -> list[str]:
    return [item.strip() for item in _COMMA.split(values)]


def _call_diagnostic(
    call: _Call, code: codes.Code, fix: str, is_sure: bool, **values: str
) -> Diagnostic:
    repair = Repair((Edit(call.span, fix),), is_sure)
    return Diagnostic(code, call.span, {**values, "fix": fix}, call.span, repair)


def _point_diagnostic(call: _Call) -> Diagnostic | None:
    """`BEEP(1. 440)`, of a phone: a point before a space is a comma."""
    arguments_text = call.text.partition("(")[2].rpartition(")")[0]
    values = _split_values(_SPACED_POINT.sub(",", arguments_text))
    is_whole = len(call.values) < len(call.word.arguments) == len(values)
    if not is_whole or not all(map(_NUMBER.fullmatch, values)):
        return None
    fix = call.with_values(values)
    return _call_diagnostic(call, codes.MISSING_COMMA, fix, True)


def _unit_diagnostic(call: _Call) -> Diagnostic | None:
    """`F(20, CM, 60)`, `F(CM, 20, 60)`, `F(20, 60, CM)`, `F(CM SIDE, 60)`."""
    unit = UNIT_OF.get(call.word.text, "")
    values = [value for value in call.values if value.upper() != unit]
    unit_match = _UNIT_BEFORE_VALUE.fullmatch(values[0]) if values else None
    if unit_match and unit_match["unit"].upper() == unit and len(values) == len(call.values):
        values[0] = unit_match["value"]
    elif len(values) != len(call.values) - 1:
        return None
    if not unit or len(values) != len(call.word.arguments) or not all(values):
        return None
    first_word, second_word = (
        word for word, unit_of_word in UNIT_OF.items() if unit_of_word == unit
    )
    fix = call.with_values([f"{values[0]} {unit}", *values[1:]])
    return _call_diagnostic(
        call, codes.UNIT_PLACE, fix, True, found=unit, first=first_word, second=second_word
    )


def _thousands_diagnostic(call: _Call) -> Diagnostic | None:
    """`BEEP(1, 1,000)`: a comma parts thousands, if nothing that has decimals goes."""
    arguments, number_match = call.word.arguments, _THOUSANDS.search(call.text)
    if number_match is None or len(call.values) <= len(arguments):
        return None
    joined_text = _THOUSANDS.sub(lambda match: match[0].replace(",", ""), call.text)
    arguments_text = joined_text.partition("(")[2].rpartition(")")[0]
    values = _split_values(arguments_text)
    is_time_joined = any(
        argument.unit == "s" and value not in call.values
        for argument, value in zip(arguments, values, strict=False)
    )
    if len(values) != len(arguments) or is_time_joined:
        return None
    fix = call.with_values(values)
    return _call_diagnostic(call, codes.BAD_NUMBER, fix, True, found=number_match[0])


def _motor_time_diagnostic(call: _Call, text: str) -> Diagnostic | None:
    """`M(50, 80, 3)`, `M(3, 50, 80)`: how long the motors run is said by a W after them."""
    if call.word.text != "M" or len(call.values) != len(call.word.arguments) + 1:
        return None
    values = [_PERCENT_AT_END.sub("", value) for value in call.values]
    splits = [(values[-1], values[:-1]), (values[0], values[1:])]
    candidates = [(_seconds_text(time), powers) for time, powers in splits if _are_powers(powers)]
    seconds_text, powers = next((candidate for candidate in candidates if candidate[0]), ("", []))
    if not seconds_text:
        return None
    fix = f"{call.with_values(powers)};W({seconds_text})"
    fix += "" if text[call.span.end :].strip(" ;\t\r\n") else ";S"
    gap_values = {"word": "M", "usage": call.word.usage, "wanted": "2", "found": "3", "number": ""}
    return _call_diagnostic(call, codes.ARGUMENT_COUNT, fix, False, **gap_values)


def _seconds_text(value: str) -> str:
    """Return the number of a value that says a time, "" for another one."""
    match = _TIME_WITH_UNIT.fullmatch(value)
    unit = lexicon_meaning(plain(match[2]), "unit") if match and match[2] else ("s", "1000")
    is_time = match is not None and unit == ("s", "1000") and 0 < float(match[1]) < LONG_TIME_S
    return match[1] if match and is_time else ""


def _are_powers(values: Sequence[str]) -> bool:
    return all(
        abs(float(value)) <= MAX_POWER if _NUMBER.fullmatch(value) else value.upper() not in WORDS
        for value in values
    )


# -- what is shown of a call that nothing reads ---------------------------------------------------


def own_example(text: str) -> str:
    """Return an instruction with a misplaced CM or DEG, rewritten with its own values."""
    if stored_match := _STORED_WITH_UNIT.fullmatch(text):
        name, number, unit = stored_match[1], stored_match[2], stored_match[3].upper()
        word = next(word for word, unit_of_word in UNIT_OF.items() if unit_of_word == unit)
        return f"{name} = {number}; {word}({name} {unit}, {POWER.sample})"
    call = next(_calls(text, 0), None)
    unit = UNIT_OF.get(call.word.text, "") if call else ""
    if call is None or not unit:
        return ""
    values = [re.sub(rf"(?i)\b{unit}\b", "", value).strip() for value in call.values]
    values = [re.sub(r"  +", " ", value) for value in values if value]
    has_all_values = len(values) == len(call.word.arguments)
    return call.with_values([f"{values[0]} {unit}", *values[1:]]) if has_all_values else ""


def likely_word(word: str, text: str) -> str:
    """Return the word of a call that an unknown one may be by its letters and its values."""
    call = _ANY_CALL.fullmatch(text)
    values = _split_values(call[1]) if call else []
    numbers = [number for number in map(_NUMBER.match, values) if number]
    if not values or len(numbers) != len(values):
        return ""
    is_frequency = len(values) > 1 and float(numbers[1][0]) > MAX_POWER
    expansions, similar_word = (
        expand_short(word),
        "" if lexicon_concept(word) else homophone_of(word) or "",
    )
    if similar_word in CALL_WORDS:
        guessed_word = similar_word
    elif is_frequency:
        guessed_word = "BEEP" if word[:1] == "B" or "BEEP" in expansions else ""
    elif len(expansions) == 1:
        guessed_word = expansions[0]
    else:
        guessed_word = word[:1] if len(word) <= _MAX_ADDED_LETTERS else ""
    return (
        guessed_word
        if guessed_word in WORDS and len(WORDS[guessed_word].arguments) == len(values)
        else ""
    )


def usage_of_number(word: str, number_text: str) -> str:
    """Return the call of a word with its only number, or "" if the number may be another value.

    A large number after a turn means degrees; after a move it may be a power.
    """
    word_row = WORDS.get(word)
    is_long_time = float(number_text) >= LONG_TIME_S
    if word_row is None or not word_row.is_call or (is_long_time and word not in ("L", "R")):
        return ""
    names = [argument.name for argument in word_row.arguments][1:]
    unit = f" {UNIT_OF[word]}" if is_long_time else ""
    return (
        f"{word}({', '.join((number_text + unit, *names))})" if word_row.role.has_duration else ""
    )
