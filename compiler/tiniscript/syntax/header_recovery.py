"""Recovery of headers that were meant to be another one: `LOOP UNTIL(c)`, `LOOP x4`, `IF NOT S`.

Knows how the header that was meant is written, and opens its block.
"""

from __future__ import annotations

from typing import NoReturn

from tiniscript.diagnostics import codes
from tiniscript.source import Span
from tiniscript.syntax.blocks import ENDS, Blocks
from tiniscript.syntax.call_suggestions import written
from tiniscript.syntax.cursor import AT_END, Cursor
from tiniscript.syntax.lexer import NUMBER, ODD, WORD, Token
from tiniscript.syntax.near import near_at
from tiniscript.syntax.operators import COMPARISONS
from tiniscript.syntax.phrases import AFTER_HEADER, TIMES
from tiniscript.syntax.reporter import Failed, Reporter, Resumed
from tiniscript.syntax.suggestions import (
    after_bracket,
    body_begins,
    counted,
    end_of_values,
    head_in,
    inside,
    opposite,
    shortened,
    with_signs,
)
from tiniscript.syntax.vocabulary import Vocabulary
from tiniscript.words import BLOCK_ENDS, WORDS, meant_by

_BESIDE_TIMES = frozenset(("X", "POR", "BY", "*", "=", "->", ">", *AFTER_HEADER))


class HeaderRecovery:
    def __init__(
        self, cursor: Cursor, reporter: Reporter, blocks: Blocks, known: Vocabulary
    ) -> None:
        self.cursor = cursor
        self.reporter = reporter
        self.blocks = blocks
        self.known = known

    def bare_header(self, word: Token) -> None:
        """`LOOP` alone behind the body of a LOOP: its end is meant, if no other comes."""
        block = self.blocks.innermost
        if block is None or block.word != word.text or not block.here:
            return
        rest = self.cursor.tokens[self.cursor.i :]
        if any(ENDS.get(each.text) == word.text for each in rest):
            return
        right = BLOCK_ENDS[word.text]
        self.reporter.report(codes.END_ALONE, word.span, found=word.text, right=right)
        self.blocks.end(word.span)
        raise Resumed

    def counted_loop(self, word: Token) -> None:
        """`LOOP(I = 0; I < 4; I++)`: the loop counts by itself."""
        cursor = self.cursor
        start = cursor.i
        end = after_bracket(cursor.tokens, start)
        times = counted(cursor.tokens[:end], start)
        if end is None or times is None:
            return
        cursor.i = end
        place = cursor.span_from(word)
        found = cursor.source[Span(cursor.tokens[start].end, cursor.last.start)].strip()
        self.reporter.report(
            codes.LOOP_COUNTS, place, found=found, times=str(times), fix=f"LOOP({times})"
        )
        self._begin("LOOP", place)

    def instead(self, word: Token, start: int) -> None:
        """Look at what stands without brackets behind the header's `word`, from `start` on."""
        first = self.cursor.tokens[start]
        if word.text == "LOOP" and "UNTIL" in (first.text, meant_by(first.text)):
            self._loop_until(word, start)
        if word.text == "LOOP":
            self._loop_times(word, start)

    def _loop_until(self, word: Token, start: int) -> None:
        """`LOOP UNTIL(DISTANCE < 10)`: WHILE asks the opposite."""
        cursor, tokens = self.cursor, self.cursor.tokens
        values = inside(tokens, start + 1)
        question = opposite(with_signs(values))
        if not question:
            return
        end = end_of_values(tokens, start + 1, values)
        cursor.i = start
        while cursor.token.start < end:
            cursor.i += 1
        place = cursor.span_from(word)
        found = cursor.source[Span(word.start, tokens[start].end)]
        self.reporter.report(codes.OTHER_LANGUAGE, place, place, found=found, right="WHILE",
                             fix=f"WHILE({question})", usage="")  # fmt: skip
        self._begin("WHILE", place)

    def _loop_times(self, word: Token, start: int) -> None:
        """`LOOP x4`, `LOOP = 4`: how often, with a sign before it."""
        cursor = self.cursor
        row = cursor.tokens[start : body_begins(cursor.tokens, start)]
        if any(self.known.is_own(each.text) for each in row):
            return  # `LOOP X4`, of a program with X4
        texts = [each.text.removeprefix("X") or each.text for each in row]
        if texts[:2] == ["-", ">"]:
            texts[:2] = ["->"]
        digits = [text for text in texts if text.isdecimal()]
        if len(digits) != 1 or len(row) > 3 or texts == [row[0].text]:
            return
        if all(text in digits or text in _BESIDE_TIMES for text in texts):
            cursor.i = start + len(row)
            place = cursor.span_from(word)
            fix, usage = f"LOOP({digits[0]})", WORDS["LOOP"].usage
            self.reporter.report(codes.MISSING_OPEN, place, word="LOOP", fix=fix, usage=usage)
            self._begin("LOOP", place)

    def if_not(self, word: Token, start: int) -> None:
        """`IF NOT F(1, 50)`: with no question behind it, it is ELSE."""
        cursor = self.cursor
        if word.text != "IF" or cursor.tokens[start].text not in ("NOT", "NO"):
            return
        known = WORDS.get(cursor.tokens[start + 1].text)
        if known is not None and known.is_instruction:
            place = Span(word.start, cursor.tokens[start].end)
            found = cursor.source[place]
            self.reporter.report(codes.OTHER_LANGUAGE, place, place, found=found, right="ELSE",
                                 fix="ELSE", usage="ELSE")  # fmt: skip
            block = self.blocks.innermost
            if block is not None and block.word == "IF" and block.otherwise is None:
                block.next_arm(None, place)
                block.otherwise = []
            cursor.i = start + 1
            raise Resumed

    def is_sign_before_bracket(self) -> bool:
        """Whether one sign too much stands before a bracket, as in `UNTIL.(c)`; then drop it."""
        token = self.cursor.token
        is_one = (
            token.kind is ODD and token.text in (".", ":") and self.cursor.following.kind == "("
        )
        if is_one:
            del self.cursor.tokens[self.cursor.i]
        return is_one

    def until_near(self, word: Token, start: int) -> None:
        """`F(2, 80) until the wall`."""
        cursor = self.cursor
        near = near_at(cursor.tokens, start, self.known) if word.text == "UNTIL" else None
        if near is not None and cursor.tokens[near.end].kind in AT_END:
            cursor.i = near.end
            place = cursor.span_from(word)
            fix = f"UNTIL({near.question})"
            self.reporter.fail(codes.MISSING_OPEN, place, place, word=word.text, fix=fix, usage="")

    def in_braces(self, word: Token, start: int) -> None:
        """`IF{DISTANCE < 10}`: braces for brackets."""
        cursor, tokens = self.cursor, self.cursor.tokens
        close = cursor.closing(start) if tokens[start].kind == "{" else None
        row = tokens[start + 1 : close]
        if close is None or any(each.kind in AT_END for each in row) or not row:
            return
        if (word.text == "LOOP" and len(row) > 1) or (word.text != "LOOP" and not any(
            each.kind in COMPARISONS for each in row
        )):  # fmt: skip
            return
        self.reporter.answer(tokens[start])
        cursor.i = close + 1
        place = cursor.span_from(word)
        known = WORDS[word.text]
        fix = head_in(known, row)
        self.reporter.report(codes.MISSING_OPEN, place, word=word.text, fix=fix, usage=known.usage)
        if word.text not in BLOCK_ENDS:
            raise Failed  # `UNTIL{c}`, `ELSEIF{c}`: what has read the word goes on
        self._begin(word.text, place)

    # -- what is written as one line in another order -----------------------------------------

    def around(self, word: Token) -> None:
        """`repeat F(1, 50) 3 times`, `repeat F(1, 50) until DISTANCE < 10`."""
        cursor, tokens = self.cursor, self.cursor.tokens
        first = tokens[min(cursor.i + 1, len(tokens) - 1)]
        known = WORDS.get(first.text) if first.kind is WORD else None
        end = after_bracket(tokens, cursor.i + 2) if known is not None and known.is_call else None
        if end is None or tokens[cursor.i + 2].kind != "(":
            return
        body = cursor.source[Span(first.start, tokens[end - 1].end)]
        number, after = tokens[end], tokens[min(end + 2, len(tokens) - 1)]
        fix = ""
        if number.kind is NUMBER and tokens[end + 1].text in TIMES and after.kind in AT_END:
            fix, end = f"LOOP({number.text});{body};{BLOCK_ENDS['LOOP']}", end + 2
        elif "UNTIL" in (number.text, meant_by(number.text)):
            values = inside(tokens, end + 1)
            asked = written(with_signs(values))
            fix = f"LOOP(FOREVER);{body};IF({asked});BREAK;ENDIF;{BLOCK_ENDS['LOOP']}"
            last = end_of_values(tokens, end + 1, values)
            if not any(each.kind in COMPARISONS for each in with_signs(values)):
                return
            while tokens[end].start < last:
                end += 1
        if fix and tokens[end].kind in AT_END:
            cursor.i = end
            place = Span(word.start, tokens[end - 1].end)
            found = shortened(cursor.source[place])
            self.reporter.fail(codes.REPEATED, place, place, found=found, fix=fix)

    def choice(self, first: Token) -> None:
        """`DISTANCE < 10 ? S : F(1, 50)`: IF and ELSE choose."""
        cursor, tokens = self.cursor, self.cursor.tokens
        start = end = cursor.i
        while tokens[end].kind not in AT_END:
            end += 1
        row = tokens[start:end]
        signs = [k for k, each in enumerate(row) if each.kind is ODD and each.text in ("?", ":")]
        if [row[k].text for k in signs] != ["?", ":"] or signs[0] + 1 == signs[1]:
            return
        one, two = signs
        if two + 1 == len(row):
            return
        pieces = (row[:one], row[one + 1 : two], row[two + 1 :])
        asked, yes, no = (cursor.source[Span(p[0].start, p[-1].end)] for p in pieces)
        for k in signs:
            self.reporter.answer(row[k])
        cursor.i = end
        place = Span(first.start, row[-1].end)
        fix = f"IF({asked});{yes};ELSE;{no};{BLOCK_ENDS['IF']}"
        self.reporter.fail(codes.NOT_AN_INSTRUCTION, row[one].span, place, found="?", fix=fix)

    # -- a question in two brackets -----------------------------------------------------------

    # -- the block that was meant -------------------------------------------------------------

    def _begin(self, word: str, place: Span) -> NoReturn:
        """Open the block of a header that has a diagnostic, and go on behind it."""
        self.blocks.begin(word, place).is_reported = True
        self._go_on()

    def _go_on(self) -> NoReturn:
        cursor = self.cursor
        while cursor.token.text in AFTER_HEADER or (
            cursor.token.kind is ODD and cursor.token.text == ":"
        ):
            self.reporter.answer(cursor.token)
            cursor.i += 1
        self.reporter.crowded_line = cursor.line_of(cursor.last)
        raise Resumed
