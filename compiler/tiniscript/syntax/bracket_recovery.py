"""Recovery of an instruction of the language without its brackets: `F 2 80`, `F{2, 80}`."""

from __future__ import annotations

from typing import NoReturn

from tiniscript.diagnostics import codes
from tiniscript.source import Span
from tiniscript.syntax.block_recovery import BlockRecovery
from tiniscript.syntax.call_suggestions import call_in
from tiniscript.syntax.clause_recovery import ClauseRecovery
from tiniscript.syntax.cursor import Cursor
from tiniscript.syntax.lexer import QUOTES, WORD, Token
from tiniscript.syntax.phrases import BEFORE_TIME, TIMES
from tiniscript.syntax.reporter import Failed, Reporter, Resumed
from tiniscript.syntax.sentence_recovery import SentenceRecovery
from tiniscript.syntax.suggestions import body_begins
from tiniscript.words import OTHER_WAY, WORDS, Word

_MANY = 6  # moves that an example has


class BracketRecovery:
    def __init__(
        self,
        cursor: Cursor,
        reporter: Reporter,
        in_block: BlockRecovery,
        sentence: SentenceRecovery,
        clauses: ClauseRecovery,
    ) -> None:
        self.cursor = cursor
        self.reporter = reporter
        self.in_block = in_block
        self.sentence = sentence
        self.clauses = clauses

    def no_bracket(self, word: Token, known: Word) -> NoReturn:
        """`F 2 80`: suggest the same with brackets and commas."""
        cursor = self.cursor
        self._letter_of_list(word)
        self.clauses.several(cursor.i - 1)
        first = cursor.source.text[cursor.token.start : cursor.token.start + 1]
        if first in tuple(QUOTES):
            raise Failed
        if cursor.token.text in (":", *BEFORE_TIME):  # `F: 2, 80`, `beep for 2 seconds`
            self.reporter.answer(cursor.token)
            cursor.i += 1
        start = cursor.i
        cursor.i = body_begins(cursor.tokens, start, names_end=False)
        rest = cursor.tokens[start : cursor.i]
        if cursor.token.text in TIMES:  # `BEEP 3 times`
            self.sentence.so_often(word.span, known, rest, 0)
        if len(rest) > 1 and rest[0].kind in ("-", "=", "=>") and rest[1].kind == ">":
            rest = rest[2:]  # `F -> 2, 80`
        is_dash = known.role in ("move", "wait", "beep")  # no value of theirs is below 0
        if is_dash and len(rest) > 1 and rest[0].kind == "-" and rest[0].start == word.end:
            rest = rest[1:]  # `F-2, 80`
        span = Span(word.start, rest[-1].end if rest else word.end)
        is_def = known.role != "actuator" and self.in_block.is_name(word.text)  # `DEF B` comes
        fix = call_in(known, rest)
        if rest and rest[0].text.startswith(".") and rest[0].start == word.end:
            fix = ""  # `F.2.80`
        if rest and cursor.source[rest[0].span].endswith("%") and known.role != "motors":
            fix = ""  # `F 80 %, 2`
        if not rest and cursor.token.text == "UNTIL" and known.role in ("move", "wait"):
            fix = known.example.replace("2" if known.role == "move" else "1", "FOREVER", 1)
        if is_def:
            self.reporter.fail(
                codes.RESERVED, word.span, word=word.text, right=cursor.free_name(word.text)
            )
        values = {"word": word.text, "fix": fix, "usage": known.usage}
        if rest and all(each.text in OTHER_WAY for each in (word, *rest)):  # `F F L F`
            letters = [each.text for each in (word, *rest)]
            values["words"] = ", ".join(dict.fromkeys(letters))
            values["example"] = "; ".join(WORDS[each].example for each in letters[:_MANY])
        self.reporter.report(codes.MISSING_OPEN, span, None, **values)
        if cursor.token.kind is WORD and cursor.token.text != "UNTIL":
            self.in_block.go_on()
        if cursor.token.kind == ",":  # `F 2, 80, R 1, 50`
            cursor.i += 1
            raise Resumed
        raise Failed

    def _letter_of_list(self, word: Token) -> None:
        """`b) R(1, 50)`, below `a) F(2, 80)`: what counts the lines."""
        cursor = self.cursor
        is_own_line = cursor.line_of(cursor.following) == cursor.line_of(word)
        if cursor.token.kind == ")" and cursor.following.kind is WORD and is_own_line:
            cursor.i += 1
            span = cursor.span_from(word)
            self.reporter.report(codes.LINE_NUMBER, span, found=cursor.source[span])
            raise Resumed
