"""Loops of other languages that count: `FOR I = 1 TO 5`, `for each i from 1 to 4`, `NEXT I`.

LOOP has no counter: a counter that the body uses becomes a variable that grows there. Text that the
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
from tiniscript.recovery.trailing_tokens import token_width
from tiniscript.recovery.writing import split_note
from tiniscript.syntax.lexer import NUMBER, WORD

_INSTRUCTION_STARTS = (";", "{", "}", "|")
_IN_WORDS = ("IN", "EN", "EM")


class _Counter(NamedTuple):
    """A header: tokens `start_index` to `end_index` count `loop_count` with `name`.

    It begins at `first_value`, and advances by `step`. The words before `name_index` say that it is
    one: `for each`.
    """

    start_index: int
    name_index: int
    end_index: int
    name: str
    first_value: int
    loop_count: int
    step: int


def counter_diagnostics(source: Source) -> list[Diagnostic]:
    """Return the diagnostics for headers with a used counter, and for ends that name it."""
    diagnostics: list[Diagnostic] = []
    rows = [lexemes(split_note(line)[0]) for line in source.text.split("\n")]
    headers_by_row = [[*_headers(row)] for row in rows]
    names = {counter.name for row in headers_by_row for counter in row}
    if not names:
        return []
    words = Counter(token.text for row in rows for token in row)
    ends = Counter(b.text for row in rows for a, b in pairwise(row) if _is_end(a, b, b.text))
    line_start = 0
    for row, headers, line in zip(rows, headers_by_row, source.text.split("\n"), strict=True):
        spans = _counter_spans(row, line_start)
        for counter in headers:
            uses_in_header = [
                token.text for token in row[counter.start_index : counter.end_index]
            ].count(counter.name)
            is_used = words[counter.name] > uses_in_header + ends[counter.name]
            header = row[counter.start_index : counter.end_index]
            is_c_loop = any(token.text == ";" for token in header) and not row[counter.end_index :]
            if is_used or is_c_loop or any(lexicon_meaning(token.text, "each") for token in header):
                span = Span(spans[counter.start_index].start, spans[counter.end_index - 1].end)
                diagnostics.append(
                    _counter_diagnostic(
                        span,
                        _spans_text(source, spans[counter.start_index : counter.name_index]),
                        "LOOP",
                        _loop_text(counter, is_used),
                    )
                )
        for k, (end, name) in enumerate(pairwise(row)):
            if name.text in names and _is_end(end, name, name.text):
                span = Span(spans[k].start, spans[k + 1].end)
                diagnostics.append(_counter_diagnostic(span, source[span], "END_LOOP", "END_LOOP"))
        line_start += len(line) + 1
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


def _loop_text(counter: _Counter, is_used: bool) -> str:
    name, step, initial_value = counter.name, counter.step, counter.first_value - counter.step
    loop = f"LOOP({counter.loop_count})"
    return f"{name} = {initial_value};{loop};{name} = {name} + {step}" if is_used else loop


def _counter_spans(row: Sequence[Lexeme], end: int) -> list[Span]:
    spans = []
    for token in row:
        end += token_width(token)
        spans.append(Span(end - len(token.source or ""), end))
    return spans


def _is_end(end: Lexeme, name: Lexeme, counter: str) -> bool:
    return lexicon_concept(end.text) == "END_LOOP" and name.text == counter


def _headers(row: Sequence[Lexeme]) -> Iterator[_Counter]:
    for k in range(len(row)):
        is_begun = k == 0 or row[k - 1].text in _INSTRUCTION_STARTS
        if is_begun and (counter := _header(row, k)):
            yield counter


def _header(tokens: Sequence[Lexeme], start_index: int) -> _Counter | None:
    """Return the counter of the header that begins at a token."""
    if (
        not lexicon_meaning(tokens[start_index].text, "count")
        and lexicon_concept(tokens[start_index].text) != "LOOP"
    ):
        return None
    reader = _TokenReader(tokens, start_index + 1)
    has_bracket = reader.try_take("(")
    while reader.means("each", "every", "declare"):
        reader.k += 1
    name_index, name = reader.k, reader.text()
    if name in WORDS or not name.isidentifier() or lexicon_concept(name):
        return None
    reader.k += 1
    step: int | None = 1
    if reader.text() in _IN_WORDS and reader.text(1) == "RANGE" and reader.text(2) == "(":
        reader.k += 3
        numbers = [reader.number()]
        numbers += [reader.number()] if reader.try_take(",") else []
        step = reader.number() if reader.try_take(",") else step
        first_value, bound = (0, *numbers)[-2:]
        is_complete = reader.try_take(")")
    elif reader.try_take("=", ":=") or reader.means("from", "to"):
        reader.k += reader.means("from", "to")
        first_value = reader.number()
        if reader.try_take(";"):
            is_complete = reader.try_take(name)
            is_closed = reader.text() == "<="
            is_complete &= reader.try_take("<", "<=")
            bound = _add(reader.number(), int(is_closed))
            is_complete &= reader.try_take(";") and reader.try_take(name)
            is_increment = reader.text() == "+" and reader.text(1) == "="
            reader.k += 2 * is_increment
            step = reader.number() if is_increment or reader.try_take("+=") else step
            is_complete &= is_increment or step != 1 or reader.try_take("++")
        else:
            is_complete = reader.means("to", "until")
            while reader.means("to", "until"):
                reader.k += 1
            bound = _add(reader.number(), 1)
            if reader.unit_text() == "steps":
                reader.k += 1
                step = reader.number()
    else:
        return None
    is_complete = is_complete and (not has_bracket or reader.try_take(")"))
    reader.k += reader.text() == ":" or reader.means("do")
    if not is_complete or first_value is None or bound is None or bound <= first_value or not step:
        return None
    return _Counter(
        start_index, name_index, reader.k, name, first_value, -((first_value - bound) // step), step
    )


def _add(number: int | None, increment: int) -> int | None:
    return None if number is None else number + increment


class _TokenReader:
    """A reader of the tokens from `k` on."""

    def __init__(self, tokens: Sequence[Lexeme], k: int) -> None:
        self.tokens = tokens
        self.k = k

    def text(self, offset: int = 0) -> str:
        return self.tokens[self.k + offset].text if self.k + offset < len(self.tokens) else ""

    def means(self, *kinds: str) -> bool:
        is_word = self.k < len(self.tokens) and self.tokens[self.k].kind is WORD
        return is_word and bool(lexicon_meaning(self.text(), *kinds))

    def try_take(self, *signs: str) -> bool:
        """Pass one of these signs; return whether there was one."""
        is_there = self.text() in signs
        self.k += is_there
        return is_there

    def unit_text(self) -> str:
        """Return the unit that a word is, "" for none."""
        return (*lexicon_meaning(self.text(), "unit")[:1], "")[0]

    def number(self) -> int | None:
        """Return a whole number, or None for anything else: an amount with a unit is no count."""
        is_there = self.k < len(self.tokens) and self.tokens[self.k].kind is NUMBER
        number = int(self.text()) if is_there and self.text().isdecimal() else None
        self.k += is_there
        return number if self.unit_text() in ("", "steps") else None
