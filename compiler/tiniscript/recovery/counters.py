"""Loops of other languages that count: `FOR I = 1 TO 5`, `for each i from 1 to 4`, `NEXT I`.

LOOP counts nothing: a counter that the body uses becomes a variable that grows there. What the
rows read is left to them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

from tiniscript.base.source import Edit, Source, Span
from tiniscript.base.words import WORDS, lexicon_concept, lexicon_meaning
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Code, Diagnostic, Repair
from tiniscript.recovery.meanings import Lexeme, lexemes
from tiniscript.recovery.trailing_tokens import width
from tiniscript.recovery.writing import without_note
from tiniscript.syntax.lexer import NUMBER, WORD

_INSTRUCTION_STARTS = (";", "{", "}", "|")
_IN_WORDS = ("IN", "EN", "EM")


class _Counter(NamedTuple):
    """A header: tokens `start` up to `end` count `loop_count` with `name`, from `first` on, by
    `step`.

    The words before `name_start` say that it is one: `for each`.
    """

    start: int
    name_start: int
    end: int
    name: str
    first: int
    loop_count: int
    step: int


def counters(source: Source) -> list[Diagnostic]:
    """Return what is told of headers with a counter that is used, and of the ends that name it."""
    diagnostics: list[Diagnostic] = []
    rows = [lexemes(without_note(line)[0]) for line in source.text.split("\n")]
    headers_by_row = [[*_headers(row)] for row in rows]
    names = {item.name for row in headers_by_row for item in row}
    if not names:
        return []
    words = Counter(token.text for row in rows for token in row)
    ends = Counter(b.text for row in rows for a, b in pairwise(row) if _is_end(a, b, b.text))
    start = 0
    for row, headers, line in zip(rows, headers_by_row, source.text.split("\n"), strict=True):
        spans = _counter_spans(row, start)
        for item in headers:
            uses_in_header = [it.text for it in row[item.start : item.end]].count(item.name)
            is_used = words[item.name] > uses_in_header + ends[item.name]
            header = row[item.start : item.end]
            is_of_c = any(it.text == ";" for it in header) and not row[item.end :]
            if is_used or is_of_c or any(lexicon_meaning(it.text, "each") for it in header):
                span = Span(spans[item.start].start, spans[item.end - 1].end)
                diagnostics.append(
                    _counter_diagnostic(
                        span,
                        _spans_text(source, spans[item.start : item.name_start]),
                        "LOOP",
                        _loop(item, is_used),
                    )
                )
        for k, (end, name) in enumerate(pairwise(row)):
            if name.text in names and _is_end(end, name, name.text):
                span = Span(spans[k].start, spans[k + 1].end)
                diagnostics.append(_counter_diagnostic(span, source[span], "END_LOOP", "END_LOOP"))
        start += len(line) + 1
    return diagnostics


def _counter_diagnostic(span: Span, found_text: str, right_word: str, fix: str) -> Diagnostic:
    code: Code = codes.OTHER_LANGUAGE
    values = {
        "found": found_text,
        "right": right_word,
        "fix": fix,
        "usage": WORDS[right_word].usage,
        "lost": "",
    }
    return Diagnostic(code, span, values, span, Repair((Edit(span, fix),), False))


def _spans_text(source: Source, spans: Sequence[Span]) -> str:
    return source[Span(spans[0].start, spans[-1].end)].partition("(")[0].strip()


def _loop(counter: _Counter, is_used: bool) -> str:
    name, step, before = counter.name, counter.step, counter.first - counter.step
    loop = f"LOOP({counter.loop_count})"
    return f"{name} = {before};{loop};{name} = {name} + {step}" if is_used else loop


def _counter_spans(row: Sequence[Lexeme], start: int) -> list[Span]:
    spans = []
    for token in row:
        start += width(token)
        spans.append(Span(start - len(token.source or ""), start))
    return spans


def _is_end(end: Lexeme, name: Lexeme, counter: str) -> bool:
    return lexicon_concept(end.text) == "END_LOOP" and name.text == counter


def _headers(row: Sequence[Lexeme]) -> Iterator[_Counter]:
    for k in range(len(row)):
        is_begun = k == 0 or row[k - 1].text in _INSTRUCTION_STARTS
        if is_begun and (counter := _header(row, k)):
            yield counter


def _header(row: Sequence[Lexeme], start: int) -> _Counter | None:
    """Return what a header counts that begins at a token."""
    if not lexicon_meaning(row[start].text, "count") and lexicon_concept(row[start].text) != "LOOP":
        return None
    rest = _Rest(row, start + 1)
    has_bracket = rest.take("(")
    while rest.means("each", "every", "declare"):
        rest.k += 1
    name_start, name = rest.k, rest.text()
    if name in WORDS or not name.isidentifier() or lexicon_concept(name):
        return None
    rest.k += 1
    step: int | None = 1
    if rest.text() in _IN_WORDS and rest.text(1) == "RANGE" and rest.text(2) == "(":
        rest.k += 3
        numbers = [rest.number()]
        numbers += [rest.number()] if rest.take(",") else []
        step = rest.number() if rest.take(",") else step
        first, bound = (0, *numbers)[-2:]
        is_complete = rest.take(")")
    elif rest.take("=", ":=") or rest.means("from", "to"):
        rest.k += rest.means("from", "to")
        first = rest.number()
        if rest.take(";"):
            is_complete = rest.take(name)
            is_closed = rest.text() == "<="
            is_complete &= rest.take("<", "<=")
            bound = _plus(rest.number(), int(is_closed))
            is_complete &= rest.take(";") and rest.take(name)
            is_increment = rest.text() == "+" and rest.text(1) == "="
            rest.k += 2 * is_increment
            step = rest.number() if is_increment or rest.take("+=") else step
            is_complete &= is_increment or step != 1 or rest.take("++")
        else:
            is_complete = rest.means("to", "until")
            while rest.means("to", "until"):
                rest.k += 1
            bound = _plus(rest.number(), 1)
            if rest.unit() == "steps":
                rest.k += 1
                step = rest.number()
    else:
        return None
    is_complete = is_complete and (not has_bracket or rest.take(")"))
    rest.k += rest.text() == ":" or rest.means("do")
    if not is_complete or first is None or bound is None or bound <= first or not step:
        return None
    return _Counter(start, name_start, rest.k, name, first, -((first - bound) // step), step)


def _plus(number: int | None, increment: int) -> int | None:
    return None if number is None else number + increment


class _Rest:
    """What follows in a row of tokens, from `k` on."""

    def __init__(self, row: Sequence[Lexeme], k: int) -> None:
        self.row = row
        self.k = k

    def text(self, offset: int = 0) -> str:
        return self.row[self.k + offset].text if self.k + offset < len(self.row) else ""

    def means(self, *kinds: str) -> bool:
        is_word = self.k < len(self.row) and self.row[self.k].kind is WORD
        return is_word and bool(lexicon_meaning(self.text(), *kinds))

    def take(self, *signs: str) -> bool:
        """Pass one of these signs, or say that there is none."""
        is_there = self.text() in signs
        self.k += is_there
        return is_there

    def unit(self) -> str:
        """Return the unit that a word is, "" for none."""
        return (*lexicon_meaning(self.text(), "unit")[:1], "")[0]

    def number(self) -> int | None:
        """Pass a whole number, None for anything else: an amount with a unit is no count."""
        is_there = self.k < len(self.row) and self.row[self.k].kind is NUMBER
        result = int(self.text()) if is_there and self.text().isdecimal() else None
        self.k += is_there
        return result if self.unit() in ("", "steps") else None
