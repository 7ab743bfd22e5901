"""Recovery of a question behind a sentence: `avanza 2 segundos si la distancia es mayor que 10`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NoReturn

from tiniscript.diagnostics import codes
from tiniscript.source import Span
from tiniscript.syntax.block_recovery import BlockRecovery
from tiniscript.syntax.call_suggestions import written
from tiniscript.syntax.cursor import AT_END, Cursor
from tiniscript.syntax.lexer import WORD, Token
from tiniscript.syntax.operators import COMPARISONS
from tiniscript.syntax.reporter import Reporter
from tiniscript.syntax.suggestions import (
    end_of_values,
    foreign_block,
    inside,
    opposite,
    with_signs,
)
from tiniscript.words import Word


class QuestionRecovery:
    def __init__(self, cursor: Cursor, reporter: Reporter, in_block: BlockRecovery) -> None:
        self.cursor = cursor
        self.reporter = reporter
        self.in_block = in_block

    def behind(self, span: Span, values: Sequence[Token], end: int) -> Token | None:
        """Return the SI or MIENTRAS behind an instruction, if a question follows it."""
        tokens, k = self.cursor.tokens, self.cursor.i
        last = max(span.end, end, *(each.end for each in values), 0)
        while tokens[k].kind not in AT_END:
            is_one = tokens[k].text == "SI" or foreign_block(tokens[k].text) in ("IF", "WHILE")
            if tokens[k].start >= span.end and tokens[k].kind is WORD and is_one:
                asked = with_signs(inside(tokens, k + 1))
                is_near = tokens[k - 1].end <= last
                return tokens[k] if is_near and _compares(asked) else None
            k += 1
        return None

    def asked(self, span: Span, asking: Token, call: str, meant: Word) -> NoReturn:
        """`avanza 2 segundos si la distancia es mayor que 10`."""
        tokens, k = self.cursor.tokens, self.cursor.i
        while tokens[k] is not asking:
            k += 1
        values = inside(tokens, k + 1)
        row = with_signs(values)
        known = self.in_block.known
        asked, contrary = known.translated(written(row)), known.translated(opposite(row))
        fix = f"IF({asked});{call};ENDIF"
        if foreign_block(asking.text) == "WHILE" and meant.role in ("move", "wait"):
            if call == meant.example:  # how long is not said
                call = f"{meant.text}(FOREVER{call[call.find(',') :] if ',' in call else ')'}"
            fix = f"{call} UNTIL({contrary})" if contrary else ""
        elif foreign_block(asking.text) == "WHILE":
            fix = f"WHILE({asked});{call};END_WHILE"
        place = Span(span.start, end_of_values(tokens, k + 1, values))
        self.cursor.skip_instruction()
        self.reporter.fail(codes.QUESTION_BEHIND, span, place, found=asking.text, fix=fix)


def _compares(tokens: Sequence[Token]) -> bool:
    return any(each.kind in COMPARISONS for each in tokens)
