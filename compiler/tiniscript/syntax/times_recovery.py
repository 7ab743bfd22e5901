"""Recovery of how often, said beside an instruction: `3 veces F(1, 50)`, `F(1, 50) x3`."""

from __future__ import annotations

from typing import NoReturn

from tiniscript.diagnostics import codes
from tiniscript.source import Span
from tiniscript.syntax.ast import Command
from tiniscript.syntax.block_recovery import BlockRecovery
from tiniscript.syntax.cursor import AT_END, Cursor
from tiniscript.syntax.lexer import NUMBER, WORD, Token
from tiniscript.syntax.phrases import TIMES
from tiniscript.syntax.reporter import Reporter
from tiniscript.syntax.suggestions import after_bracket, shortened
from tiniscript.words import BLOCK_ENDS, WORDS

_NOT_OFTEN = ("0", "1")
MOST_ON_A_LINE = 8  # instructions before the one that says how often
_OF_BLOCKS = frozenset((*BLOCK_ENDS, *BLOCK_ENDS.values(), "ELSE", "ELSEIF"))


class TimesRecovery:
    def __init__(self, cursor: Cursor, reporter: Reporter, in_block: BlockRecovery) -> None:
        self.cursor = cursor
        self.reporter = reporter
        self.in_block = in_block

    def so_many_times(self, number: Token) -> None:
        """`2x F(1, 50)`."""
        written = self.cursor.source[number.span].upper()
        if not (written[-1:] == "X" and written[:-1].isdecimal()):
            return
        first = self.cursor.token
        is_call = _is_command(first) and self.cursor.following.kind == "("
        if self.in_block.known.is_def(first.text) and self.cursor.following.kind in AT_END:
            self.reporter.answer(number)  # `3x DANCE`
            self.cursor.i += 1
            times = number._replace(text=written[:-1])
            self._loop_of(times, first.span, self.cursor.span_from(number))
        end = after_bracket(self.cursor.tokens, self.cursor.i + 1) if is_call else None
        if end is not None and self.cursor.tokens[end].kind in AT_END:
            self.reporter.answer(number)
            self.cursor.i = end
            body = Span(first.start, self.cursor.last.end)
            times = number._replace(text=written[:-1])
            self._loop_of(times, body, self.cursor.span_from(number))

    def times_before(self, number: Token) -> None:
        """`3 veces F(1, 50)`, `3 * F(1, 50)`, `3 veces:`."""
        cursor = self.cursor
        is_head = cursor.following.kind in ("{", *AT_END) or cursor.following.text == ":"
        if cursor.token.text in TIMES and is_head:
            cursor.i += 1
            span = cursor.span_from(number)
            found = cursor.source[span]
            if number.text == "1":  # nothing is repeated
                self.reporter.report(codes.REPEATED, span, None, found=found, fix="", line=found)
            else:
                fix = f"LOOP({number.text})"
                self.reporter.report(codes.REPEATED, span, span, found=found, fix=fix)
            self.in_block.begin_reported("LOOP", span)
            self.in_block.go_on()
        is_said = cursor.token.kind == "*" or cursor.token.text in (*TIMES, "X")
        name = cursor.following if is_said else cursor.token
        after = cursor.i + is_said + 1
        is_called = self.in_block.known.is_def(name.text) and cursor.tokens[after].kind in AT_END
        if is_called and (is_said or not self._counts_lines(number)):
            cursor.i = after  # `3 DANCE`, `3 veces DANCE`
            self._loop_of(number, name.span, cursor.span_from(number))
        if not is_said:
            return
        first = cursor.following
        is_call = _is_command(first) and cursor.tokens[cursor.i + 2].kind == "("
        end = after_bracket(cursor.tokens, cursor.i + 2) if is_call else None
        if end is None or cursor.tokens[end].kind not in AT_END:
            return
        cursor.i = end
        body = Span(first.start, cursor.tokens[end - 1].end)
        self._loop_of(number, body, cursor.span_from(number))

    def _counts_lines(self, number: Token) -> bool:
        """Whether the line above begins with a number, too."""
        source = self.cursor.source
        line = source.position(number.start)[0]
        above = source.line_text(line - 1) if line > 1 else ""
        return number.text == "1" or above.lstrip()[:1].isdecimal()

    def all_before(self, word: Token) -> None:
        """`F(1, 50); R(1, 50); repetir 4 veces`, at the end: what is repeated stands before."""
        cursor, blocks = self.cursor, self.in_block.blocks
        row = cursor.tokens[cursor.i + 1 :]
        numbers = [each.text for each in row if each.kind is NUMBER]
        is_last = all(
            each.kind in ("(", ")", *AT_END) or each.text in (*TIMES, *numbers) for each in row
        )
        before = [each for each in blocks.here if isinstance(each, Command)]
        if not is_last or blocks.open or not before or len(numbers) > 1:
            return
        source = self.cursor.source
        rows = [source[each.span] for each in before]
        cursor.i = len(cursor.tokens) - 1
        last = max((each.end for each in row if each.kind not in AT_END), default=word.end)
        span = Span(word.start, last)
        values = {"found": source[span], "fix": ""}
        is_often = bool(numbers) and numbers[0] not in _NOT_OFTEN
        if is_often and len(rows) == len(blocks.here) <= MOST_ON_A_LINE:
            values["all"] = ";".join((f"LOOP({numbers[0]})", *rows, BLOCK_ENDS["LOOP"]))
        self.reporter.fail(codes.REPEATED, span, None, **values)

    def _loop_of(self, number: Token, body: Span, place: Span) -> NoReturn:
        found = shortened(self.cursor.source[place])
        if number.text in _NOT_OFTEN:  # nothing is repeated
            once = self.cursor.source[body] if number.text == "1" else ""
            self.reporter.fail(codes.REPEATED, place, None, found=found, fix="", once=once)
        fix = f"LOOP({number.text});{self.cursor.source[body]};END_LOOP"
        self.reporter.fail(codes.REPEATED, place, found=found, fix=fix)


def _is_command(token: Token) -> bool:
    known = WORDS.get(token.text) if token.kind is WORD else None
    return known is not None and known.is_instruction
