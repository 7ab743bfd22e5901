"""Recovery of the headers of DEFs: without a name, with values, with a colon."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NoReturn

from tiniscript.diagnostics import codes
from tiniscript.source import Span
from tiniscript.syntax.ast import Argument, Assign
from tiniscript.syntax.block_recovery import BlockRecovery
from tiniscript.syntax.blocks import Block
from tiniscript.syntax.cursor import Cursor
from tiniscript.syntax.lexer import NUMBER, ODD, WORD, Token
from tiniscript.syntax.reporter import Reporter, Resumed
from tiniscript.syntax.vocabulary import is_part_of_name
from tiniscript.words import WORDS


class DefRecovery:
    def __init__(self, cursor: Cursor, reporter: Reporter, in_block: BlockRecovery) -> None:
        self.cursor = cursor
        self.reporter = reporter
        self.blocks = in_block.blocks
        self.in_block = in_block

    def no_name(self, word: Token) -> NoReturn:
        """`DEF` alone, with a name that begins with digits: `DEF 1PASO`, or `DEF(DANCE)`."""
        tokens, k = self.cursor.tokens, self.cursor.i
        if tokens[k].kind == "(" and tokens[k + 1].kind is WORD and tokens[k + 2].kind == ")":
            name = tokens[k + 1]
            self.cursor.i = k + 3
            place = self.cursor.span_from(word)
            self.reporter.report(codes.NO_BRACKETS_HERE, Span(tokens[k].start, place.end), place,
                                 word=word.text, fix=f"DEF {name.text}")  # fmt: skip
            self.blocks.begin("DEF", place, name=name)
            raise Resumed
        self.in_block.begin_reported("DEF", word.span)
        name = self.cursor.token
        found = self.cursor.source[name.span]
        letters = found.lstrip("0123456789_")
        if name.kind is NUMBER and letters.isalnum() and letters.isascii():
            self.reporter.answer(name)
            right = letters + found[: len(found) - len(letters)]
            self.reporter.fail(codes.BAD_NAME, name.span, found=found, right=right)
        self.reporter.fail(codes.DEF_NEEDS_NAME, word.span)

    def joined(self, name: Token) -> Token:
        """`DEF MY TURN`, `DEF PASO-UNO`: a name has no space, and no `-`."""
        cursor, tokens = self.cursor, self.cursor.tokens
        k = cursor.i + (cursor.token.kind == "-")
        second, after = tokens[k], tokens[min(k + 1, len(tokens) - 1)]
        is_word = second.kind is WORD or k > cursor.i  # no number behind a space
        if not is_word or name.text in WORDS or not is_part_of_name(second, after):
            return name
        cursor.i = k + 1
        whole = Token(WORD, f"{name.text}_{second.text}", name.start, second.end)
        found = cursor.source[whole.span]
        self.reporter.report(codes.NAME_WITH_SPACE, whole.span, found=found, right=whole.text)
        return whole

    def def_with_values(self, word: Token, name: Token, arguments: Sequence[Argument]) -> None:
        """`DEF SQUARE(SIDE)`: a DEF takes no values, but a variable can bring them."""
        place = self.cursor.span_from(word)
        names = [
            str(part.value)
            for each in arguments
            for part in each.expression
            if part.op == "NAME" and not self.in_block.is_name(str(part.value))
        ]
        for each in names:  # known from here on
            self.blocks.program.append(Assign(each, name.span, None, name.span))
        fix = ";".join((*(f"{each} = 0" for each in names), f"DEF {name.text}"))
        if names:
            span = Span(name.end, place.end)
            self.reporter.report(codes.NO_BRACKETS_HERE, span, place, word=name.text, fix=fix)
        else:
            span = self.cursor.span_from(name)
            self.reporter.report(codes.EMPTY_BRACKETS, span, word=name.text)

    def body_of_def(self, block: Block) -> None:
        """`def turn():`: go past the colon. That it lacks its END_DEF is another mistake."""
        cursor = self.cursor
        if cursor.token.kind is ODD and cursor.token.text == ":":
            self.reporter.answer(cursor.token)
            cursor.i += 1
        block.is_reported = True
