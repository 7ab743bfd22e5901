"""Recovery of how often, said beside an instruction: `3 veces F(1, 50)`, `F(1, 50) x3`."""

from __future__ import annotations

import re
from collections.abc import Sequence
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
from tiniscript.words import BLOCK_ENDS, NUMBER_WORDS, WORDS

_WORDS = re.compile(r"\W")
_NOT_OFTEN = ("0", "1")
OFTEN = ("POR", "X", "*")  # before how often
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

    def times_behind(self, first: Token, token: Token, before: Token) -> None:
        """`F(1, 50) * 3`, `F(1, 50) x 3`, `F(1, 50) 3 veces`."""
        cursor = self.cursor
        is_sign = token.kind == "*" or token.text in ("X", "POR")
        row = list(cursor.tokens[cursor.i + is_sign : cursor.i + is_sign + 3])
        if token.kind is WORD and token.text[:1] == "X" and token.text[1:].isdecimal():
            row, is_sign = [token._replace(kind=NUMBER, text=token.text[1:]), *row[1:]], True
        if token.text in ("TWICE", "THRICE"):
            times = "2" if token.text == "TWICE" else "3"
            row, is_sign = [token._replace(kind=NUMBER, text=times), *row[1:]], True
        if len(row) > 1 and row[0].text in NUMBER_WORDS:  # `F(1, 50) cuatro veces`
            row[0] = row[0]._replace(kind=NUMBER, text=NUMBER_WORDS[row[0].text])
        if len(row) > 1 and row[1].text in TIMES:
            is_sign = True
            del row[1]
        is_called = self.in_block.known.is_def(first.text)
        is_sign = is_sign or (is_called and row[0].kind is NUMBER)  # `DANCE 3`
        if not is_sign or len(row) < 2 or row[0].kind is not NUMBER or row[1].kind not in AT_END:
            return
        if _is_command(first) or is_called:
            self.repeated(row[0], first, before)

    def repeated(self, number: Token, first: Token, before: Token) -> NoReturn:
        """Report how often the call from `first` to `before` is done, and go past it."""
        cursor = self.cursor
        cursor.skip_instruction()
        body = Span(first.start, before.end)
        if not self.in_block.known.is_def(first.text):
            self._all_or_last(number, body, cursor.span_from(first))
        self._loop_of(number, body, cursor.span_from(first))

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

    def _all_or_last(self, number: Token, body: Span, place: Span) -> None:
        """`F(1, 60); L(1, 60) x4`: how much of the line is done so often is not said."""
        source = self.cursor.source
        start = source.text.rfind("\n", 0, body.start) + 1
        start = max(start, source.text.find("|", start, body.start) + 1)
        row = [each.strip() for each in source.text[start : body.start].split(";")]
        row = [each for each in row if each and each.upper() != "START"]
        is_of_block = any(_WORDS.split(each)[0].upper() in _OF_BLOCKS for each in row)
        is_often = number.text not in _NOT_OFTEN
        if is_of_block or not is_often or not 0 < len(row) <= MOST_ON_A_LINE:
            return
        head, end = f"LOOP({number.text})", BLOCK_ENDS["LOOP"]
        values = {
            "found": shortened(source[place]), "fix": "",
            "last": f"{head};{source[body]};{end}",
            "all": ";".join((head, *row, source[body], end)),
        }  # fmt: skip
        self.reporter.fail(codes.REPEATED, place, None, **values)

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


def says_how_often(row: Sequence[Token]) -> bool:
    """`3 veces`, `por 3`, `x3`, `twice`."""
    texts = [token.text for token in row]
    if texts[0] in ("TWICE", "THRICE") or re.fullmatch("X[0-9]+", texts[0]):
        return True
    if texts[0] in OFTEN and len(row) == 2 and row[1].kind is NUMBER:
        return True
    numbers = [k for k, each in enumerate(row) if each.kind is NUMBER or each.text in NUMBER_WORDS]
    return any(k + 1 < len(row) and texts[k + 1] in TIMES and texts[k] != "UNA" for k in numbers)
