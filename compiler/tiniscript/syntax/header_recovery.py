"""Recovery of headers that were meant to be another one: `LOOP UNTIL(c)`, `LOOP x4`, `IF NOT S`.

Knows how the header that was meant is written, and opens its block.
"""

from __future__ import annotations

from typing import NoReturn

from tiniscript.diagnostics import codes
from tiniscript.source import Span
from tiniscript.syntax.blocks import ENDS, Block, Blocks
from tiniscript.syntax.cursor import Cursor
from tiniscript.syntax.lexer import ODD, Token
from tiniscript.syntax.operators import COMPARISONS
from tiniscript.syntax.phrases import AFTER_HEADER
from tiniscript.syntax.reporter import Reporter, Resumed
from tiniscript.syntax.suggestions import (
    after_bracket,
    body_begins,
    counted,
    end_of_values,
    head_in,
    inside,
    opposite,
    with_signs,
)
from tiniscript.words import BLOCK_ENDS, WORDS, meant_by

_BESIDE_TIMES = frozenset(("X", "POR", "BY", "*", "=", "-", ">", *AFTER_HEADER))


class HeaderRecovery:
    def __init__(self, cursor: Cursor, reporter: Reporter, blocks: Blocks) -> None:
        self.cursor = cursor
        self.reporter = reporter
        self.blocks = blocks

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
        texts = [each.text.removeprefix("X") or each.text for each in row]
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

    # -- a question in two brackets -----------------------------------------------------------

    def second_question(self, header: Block) -> None:
        """`IF(A)(B)`: both questions are asked."""
        cursor, tokens = self.cursor, self.cursor.tokens
        end = after_bracket(tokens, cursor.i)
        row = tokens[cursor.i + 1 : end - 1] if end is not None else []
        if header.word not in ("IF", "WHILE") or not any(t.kind in COMPARISONS for t in row):
            return
        span = Span(cursor.last.start, cursor.token.end)
        header.is_reported, cursor.i = True, end or cursor.i
        self.reporter.report(codes.OTHER_SIGN, span, found=")(", right=" AND ")
        self._go_on()

    def question_goes_on(self, first: Token, header: Block) -> NoReturn:
        """`IF (A) AND (B)`: the brackets go around the whole question."""
        cursor = self.cursor
        start = cursor.i
        while cursor.tokens[start] is not first:
            start -= 1
        cursor.i = body_begins(cursor.tokens, cursor.i)
        known = WORDS[first.text]
        fix = head_in(known, cursor.tokens[start + 1 : cursor.i])
        header.is_reported, header.head = True, None
        span = cursor.span_from(first)
        values = {"word": first.text, "fix": fix, "usage": known.usage}
        self.reporter.report(codes.MISSING_OPEN, span, span, **values)
        self._go_on()

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
