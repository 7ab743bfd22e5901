"""Motors that a program switches: one by one, `motorLeft.run(60)`, or on, and after a wait off.

An adjacent pair becomes one M with both powers, in either order. For a single motor, the message
says that M has both, since the other wheel's power is unknown. `forward(50); sleep(2); stop()` is
F(2, 50).
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import zip_longest
from typing import NamedTuple

from tiniscript.base.source import Edit, Source, Span
from tiniscript.base.words import MOVES, WORDS, foreign_word_hints, lexicon_concept, lexicon_meaning
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic, Repair
from tiniscript.recovery.meanings import meanings, number_text, plain
from tiniscript.recovery.writing import split_note

_MOTOR_CALL = re.compile(r"(?P<name>[^\W\d][\w.]*)[ \t]*\([ \t]*(?P<power>-?\d+)[ \t]*%?[ \t]*\)")
_SWITCH_CALL = re.compile(
    r"(?P<name>[^\W\d][\w.]*)[ \t]*"
    r"(?:\([ \t]*(?:(?P<number>\d+(?:\.\d+)?|\.\d+)[ \t]*(?:%[ \t]*)?)?\))?"
)
_DEF = re.compile(r"(?i)\bDEF\s+(\w+)")
_MIN_WAIT_MS = 100  # shortest wait in ms; a smaller number means seconds
_LIKELY_POWERS = range(10, 101)  # powers of a running motor; a smaller number means a time
_PIECE = re.compile(r"[^;{}|\n]+")
_WORD_PART = re.compile(r"[^\W\d_]+?(?=[A-Z](?:[a-z]|$)|[_.\d]|$)|[^\W\d_]+")
_SEPARATORS = " \t\r\n;"
_SIDE_OF_LETTER = {"L": "left", "R": "right"}
_STOP_WORDS = ("S", "STOP")


class _Motor(NamedTuple):
    """A motor setting: `side` is left or right."""

    side: str
    power: str
    name: str
    span: Span


class _Switch(NamedTuple):
    """A call with one number or none, and what it means: a move, W, or a stop."""

    word: str
    number: str
    name: str
    span: Span


def switch_diagnostics(source: Source) -> list[Diagnostic]:
    """Return the diagnostics for motors switched on and, after a wait, off or reversed.

    Each with its wait is one move, and the stop after the last one needs no word.
    """
    diagnostics: list[Diagnostic] = []
    text, calls = source.text, [*_switches(source.text)]
    k = 0
    while k < len(calls):
        end, moves = k, list[str]()
        while end + 1 < len(calls) and _switches_on(calls[end]) and _is_wait(calls[end + 1]):
            if moves and not _are_together(text, calls[end - 1], calls[end]):
                break
            if not _are_together(text, calls[end], calls[end + 1]):
                break
            seconds = _seconds_text(calls[end + 1].number)
            moves.append(f"{calls[end].word}({seconds}, {calls[end].number})")
            end += 2
        has_stop = moves and end < len(calls) and calls[end].word in _STOP_WORDS
        has_stop = has_stop and _are_together(text, calls[end - 1], calls[end])
        if has_stop or len(moves) > 1:
            whole_span = Span(calls[k].span.start, calls[end - (not has_stop)].span.end)
            fix = ";".join(moves)
            word, name = calls[k].word, calls[k].name
            values = {"found": name, "right": word, "takes": WORDS[word].usage, "fix": fix}
            code = codes.OTHER_LANGUAGE
            if plain(name) == word:
                values = {"word": word, "wanted": "2", "found": "1", "fix": fix}
                values["usage"] = WORDS[word].usage
                code = codes.ARGUMENT_COUNT
            repair = Repair((Edit(whole_span, fix),), False)
            diagnostics.append(Diagnostic(code, whole_span, values, whole_span, repair))
        k = max(k + 1, end)
    return diagnostics


def _switches_on(call: _Switch) -> bool:
    is_whole = call.number.isdecimal()
    return (
        call.word in MOVES and call.word != "W" and is_whole and int(call.number) in _LIKELY_POWERS
    )


def _is_wait(call: _Switch) -> bool:
    return call.word == "W" and bool(call.number.strip("."))


def _are_together(text: str, first: _Switch, second: _Switch) -> bool:
    return not text[first.span.end : second.span.start].strip(_SEPARATORS)


def _seconds_text(milliseconds_text: str) -> str:
    """Return the length of a wait in seconds: 500 means milliseconds."""
    return (
        number_text(float(milliseconds_text) / 1000)
        if float(milliseconds_text) >= _MIN_WAIT_MS
        else milliseconds_text
    )


def _switches(text: str) -> Iterator[_Switch]:
    line_start = 0
    def_names = {plain(match[1]) for match in _DEF.finditer(text)}
    for line in text.split("\n"):
        for instruction in _PIECE.finditer(split_note(line)[0]):
            match = _SWITCH_CALL.fullmatch(instruction[0].strip())
            if match:
                start = line_start + instruction.start() + instruction[0].index(match[0])
                word = plain(match["name"].rpartition(".")[2])
                concept = (
                    word
                    if word in WORDS
                    else next((meaning.concept for meaning in meanings(word)), "")
                )
                concept = "" if word in def_names else concept
                span = Span(start, start + len(match[0]))
                yield _Switch(concept, match["number"] or "", match["name"], span)
        line_start += len(line) + 1


def motor_diagnostics(source: Source) -> list[tuple[Diagnostic, Edit]]:
    """Return the diagnostics for motors set one by one, with the edits for further reading."""
    text, motor_instructions = source.text, [*_motors(source.text)]
    findings: list[tuple[Diagnostic, Edit]] = []
    used_spans: set[Span] = set()
    for motor, next_motor in zip_longest(motor_instructions, motor_instructions[1:]):
        if motor.span in used_spans:
            continue
        is_pair = next_motor and motor.side != next_motor.side
        if is_pair and not text[motor.span.end : next_motor.span.start].strip(_SEPARATORS):
            powers = {side_motor.side: side_motor.power for side_motor in (motor, next_motor)}
            fix = f"M({powers['left']}, {powers['right']})"
            whole_span = Span(motor.span.start, next_motor.span.end)
            edit = Edit(whole_span, fix)
            call_values = {"found": motor.name, "right": "M", "takes": WORDS["M"].usage, "fix": fix}
            repair = Repair((edit,), False)
            used_spans.add(next_motor.span)
            findings.append(
                (
                    Diagnostic(codes.OTHER_LANGUAGE, whole_span, call_values, whole_span, repair),
                    edit,
                )
            )
        else:
            values = {"found": motor.name, **foreign_word_hints("MOTOR")}
            name_span = Span(motor.span.start, motor.span.start + len(motor.name))
            blanking_edit = Edit(motor.span, " " * (motor.span.end - motor.span.start))
            findings.append((Diagnostic(codes.UNKNOWN_WORD, name_span, values), blanking_edit))
    return findings


def _motors(text: str) -> Iterator[_Motor]:
    line_start = 0
    for line in text.split("\n"):
        for instruction in _PIECE.finditer(split_note(line)[0]):
            match = _MOTOR_CALL.fullmatch(instruction[0].strip())
            side = _side_of(match["name"]) if match else ""
            if match and side and not re.search(rf"(?i)\bDEF\s+{match['name']}\b", text):
                start = line_start + instruction.start() + instruction[0].index(match[0])
                span = Span(start, start + len(match[0]))
                yield _Motor(side, match["power"], match["name"], span)
        line_start += len(line) + 1


def _side_of(name: str) -> str:
    """Return the side of the motor in a name, or "" if it has no motor or no side."""
    parts = [plain(part) for part in _WORD_PART.findall(name)]
    sides = {side for side in map(_side, parts) if side}
    is_motor = any(
        lexicon_concept(part) == "M" or lexicon_meaning(part, "engine") for part in parts
    )
    return sides.pop() if is_motor and len(sides) == 1 else ""


def _side(part: str) -> str:
    sides_meant = (side for side in _SIDE_OF_LETTER.values() if lexicon_meaning(part, side))
    return next(sides_meant, _SIDE_OF_LETTER.get(lexicon_concept(part) or part, ""))
