"""Recovery of several orders in one sentence: `avanza 2 segundos y luego para`."""

from __future__ import annotations

from tiniscript.diagnostics import codes
from tiniscript.source import Span
from tiniscript.syntax.block_recovery import BlockRecovery
from tiniscript.syntax.clauses import sentence_at
from tiniscript.syntax.cursor import AT_END, Cursor
from tiniscript.syntax.lexer import Token
from tiniscript.syntax.phrases import AFTER_HEADER
from tiniscript.syntax.reporter import Reporter
from tiniscript.words import WORDS


class ClauseRecovery:
    def __init__(self, cursor: Cursor, reporter: Reporter, in_block: BlockRecovery) -> None:
        self.cursor = cursor
        self.reporter = reporter
        self.in_block = in_block

    def several(self, start: int) -> None:
        """Report the orders from `start` on, where one word alone does not say them."""
        cursor = self.cursor
        before = cursor.tokens[start - 1]
        is_first = not start or before.kind in (*AT_END, "|", "{", "}")
        if not (is_first or before.text in AFTER_HEADER or before.text == ":"):
            return  # a part of a sentence: `if wall ahead then turn right`
        sentence = sentence_at(cursor.tokens, start, self.in_block.known)
        if sentence is None or (len(sentence.orders) < 2 and not sentence.has_until):
            return
        first: Token = cursor.tokens[start]
        cursor.i = sentence.end
        for token in cursor.tokens[start : cursor.i]:
            self.reporter.answer(token)  # an accent, a point at the end
        place = Span(first.start, cursor.last.end)
        if sentence.turn is not None:
            self.reporter.fail(
                codes.SEVERAL_ORDERS, place, sentence.turn, fix="",
                example=", ".join(sentence.examples), right=";".join(sentence.orders),
            )  # fmt: skip
        if len(sentence.orders) == 1:  # `avanza hasta que veas una pared`
            usage, fix = WORDS["F"].usage, sentence.orders[0]
            self.reporter.fail(
                codes.OTHER_LANGUAGE, first.span, place, found=first.text, right="F", fix=fix,
                usage=usage,
            )  # fmt: skip
        self.reporter.fail(
            codes.SEVERAL_ORDERS, place, place, fix=";".join(sentence.orders),
            example=", ".join(sentence.examples),
        )  # fmt: skip
