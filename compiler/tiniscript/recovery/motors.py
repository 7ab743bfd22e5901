"""Motors that a program switches: one by one, `motorLeft.run(60)`, or on, and after a wait off.

A pair that stands together is one M with both powers, in whichever order. Of one alone it is said
that M has both, since nobody knows what the other wheel does. `forward(50); sleep(2); stop()` is
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
from tiniscript.recovery.writing import without_note

_MOTOR_CALL = re.compile(r"(?P<name>[^\W\d][\w.]*)[ \t]*\([ \t]*(?P<power>-?\d+)[ \t]*%?[ \t]*\)")
_SWITCH_CALL = re.compile(
    r"(?P<name>[^\W\d][\w.]*)[ \t]*"
    r"(?:\([ \t]*(?:(?P<number>\d+(?:\.\d+)?|\.\d+)[ \t]*(?:%[ \t]*)?)?\))?"
)
_DEF = re.compile(r"(?i)\bDEF\s+(\w+)")
_LEAST_WAIT_MS = 100  # of a wait: less are seconds
_LIKELY_POWERS = range(10, 101)  # of a motor that is switched on: less is rather a time
_PIECE = re.compile(r"[^;{}|\n]+")
_WORD_PART = re.compile(r"[^\W\d_]+?(?=[A-Z](?:[a-z]|$)|[_.\d]|$)|[^\W\d_]+")
_SEPARATORS = " \t\r\n;"
_SIDE_OF_LETTER = {"L": "left", "R": "right"}
_STOP_WORDS = ("S", "STOP")


class _Motor(NamedTuple):
    """One motor that is set: `side` is left or right."""

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


def switched(source: Source) -> list[Diagnostic]:
    """Return what is told of motors that are switched on, and off or to another way after a wait.

    Each with its wait is one move, and the stop after the last one needs no word.
    """
    result: list[Diagnostic] = []
    text, calls = source.text, [*_switches(source.text)]
    k = 0
    while k < len(calls):
        end, moves = k, list[str]()
        while end + 1 < len(calls) and _is_on(calls[end]) and _is_wait(calls[end + 1]):
            if moves and not _are_together(text, calls[end - 1], calls[end]):
                break
            if not _are_together(text, calls[end], calls[end + 1]):
                break
            seconds = _seconds(calls[end + 1].number)
            moves.append(f"{calls[end].word}({seconds}, {calls[end].number})")
            end += 2
        is_ended = moves and end < len(calls) and calls[end].word in _STOP_WORDS
        is_ended = is_ended and _are_together(text, calls[end - 1], calls[end])
        if is_ended or len(moves) > 1:
            whole_span = Span(calls[k].span.start, calls[end - (not is_ended)].span.end)
            fix = ";".join(moves)
            word, name = calls[k].word, calls[k].name
            values = {"found": name, "right": word, "takes": WORDS[word].usage, "fix": fix}
            code = codes.OTHER_LANGUAGE
            if plain(name) == word:
                values = {"word": word, "wanted": "2", "found": "1", "fix": fix}
                values["usage"] = WORDS[word].usage
                code = codes.ARGUMENT_COUNT
            repair = Repair((Edit(whole_span, fix),), False)
            result.append(Diagnostic(code, whole_span, values, whole_span, repair))
        k = max(k + 1, end)
    return result


def _is_on(call: _Switch) -> bool:
    is_whole = call.number.isdecimal()
    return (
        call.word in MOVES and call.word != "W" and is_whole and int(call.number) in _LIKELY_POWERS
    )


def _is_wait(call: _Switch) -> bool:
    return call.word == "W" and bool(call.number.strip("."))


def _are_together(text: str, one: _Switch, other: _Switch) -> bool:
    return not text[one.span.end : other.span.start].strip(_SEPARATORS)


def _seconds(number: str) -> str:
    """Return how long a wait lasts: 500 are milliseconds."""
    return number_text(float(number) / 1000) if float(number) >= _LEAST_WAIT_MS else number


def _switches(text: str) -> Iterator[_Switch]:
    start = 0
    def_names = {plain(match[1]) for match in _DEF.finditer(text)}
    for line in text.split("\n"):
        for piece in _PIECE.finditer(without_note(line)[0]):
            match = _SWITCH_CALL.fullmatch(piece[0].strip())
            if match:
                begin = start + piece.start() + piece[0].index(match[0])
                word = plain(match["name"].rpartition(".")[2])
                concept = word if word in WORDS else next((it.concept for it in meanings(word)), "")
                concept = "" if word in def_names else concept
                span = Span(begin, begin + len(match[0]))
                yield _Switch(concept, match["number"] or "", match["name"], span)
        start += len(line) + 1


def one_by_one(source: Source) -> list[tuple[Diagnostic, Edit]]:
    """Return what is told of motors that are set one by one, and how the rest is read."""
    text, motor_orders = source.text, [*_motors(source.text)]
    result: list[tuple[Diagnostic, Edit]] = []
    spans_used: set[Span] = set()
    for one, other in zip_longest(motor_orders, motor_orders[1:]):
        if one.span in spans_used:
            continue
        is_pair = other and one.side != other.side
        if is_pair and not text[one.span.end : other.span.start].strip(_SEPARATORS):
            powers = {it.side: it.power for it in (one, other)}
            fix = f"M({powers['left']}, {powers['right']})"
            whole_span = Span(one.span.start, other.span.end)
            edit = Edit(whole_span, fix)
            call_values = {"found": one.name, "right": "M", "takes": WORDS["M"].usage, "fix": fix}
            repair = Repair((edit,), False)
            spans_used.add(other.span)
            result.append(
                (
                    Diagnostic(codes.OTHER_LANGUAGE, whole_span, call_values, whole_span, repair),
                    edit,
                )
            )
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
            match = _MOTOR_CALL.fullmatch(piece[0].strip())
            side = _side_of(match["name"]) if match else ""
            if match and side and not re.search(rf"(?i)\bDEF\s+{match['name']}\b", text):
                begin = start + piece.start() + piece[0].index(match[0])
                span = Span(begin, begin + len(match[0]))
                yield _Motor(side, match["power"], match["name"], span)
        start += len(line) + 1


def _side_of(name: str) -> str:
    """Return the side of the motor that a name says, "" where it says no motor or no side."""
    parts = [plain(part) for part in _WORD_PART.findall(name)]
    sides = {side for side in map(_side, parts) if side}
    is_motor = any(
        lexicon_concept(part) == "M" or lexicon_meaning(part, "engine") for part in parts
    )
    return sides.pop() if is_motor and len(sides) == 1 else ""


def _side(part: str) -> str:
    sides_meant = (side for side in _SIDE_OF_LETTER.values() if lexicon_meaning(part, side))
    return next(sides_meant, _SIDE_OF_LETTER.get(lexicon_concept(part) or part, ""))
