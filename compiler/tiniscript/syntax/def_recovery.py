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
from tiniscript.syntax.vocabulary import name_at

_FARTHEST = 4000  # tokens in which calls of a DEF are looked for


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
        name = self.cursor.token
        found = self.cursor.source[name.span].upper()
        letters = found.lstrip("0123456789_")
        if name.kind is NUMBER and letters.isalnum() and letters.isascii():
            self.cursor.i += 1
            right = letters + found[: len(found) - len(letters)]
            self._digits_first(found, right)
            own = Token(WORD, right, *name.span)
            self.in_block.known.add(right)
            self.blocks.begin("DEF", Span(word.start, name.end), name=own).is_reported = True
            raise Resumed
        self.in_block.begin_reported("DEF", word.span)
        self.reporter.fail(codes.DEF_NEEDS_NAME, word.span)

    def _digits_first(self, found: str, right: str) -> None:
        """`DEF 2PASOS`: it and its calls have their digits behind."""
        tokens, start = self.cursor.tokens, self.cursor.i - 1
        for k in range(start, min(len(tokens), start + _FARTHEST)):
            span = tokens[k].span
            if tokens[k].kind is NUMBER and self.cursor.source[span].upper() == found:
                self.reporter.answer(tokens[k])
                self.reporter.report(codes.BAD_NAME, span, found=found, right=right)
                tokens[k] = Token(WORD, right, *span)

    def joined(self, name: Token) -> Token:
        """`DEF MY TURN`, `DEF PASO-UNO`: a name has no space, and no `-`. So its calls, too."""
        cursor = self.cursor
        start = cursor.i - 1
        words = name_at(cursor.tokens, start)
        if len(words) < 2:
            return name
        cursor.i = _end_of_name(cursor.tokens, start, words)
        whole = Token(WORD, "_".join(words), name.start, cursor.last.end)
        self._report_spaced(whole)
        k = cursor.i
        while k < min(len(cursor.tokens) - 1, cursor.i + _FARTHEST):
            end = _end_of_name(cursor.tokens, k, words)
            if end:
                call = Token(WORD, whole.text, cursor.tokens[k].start, cursor.tokens[end - 1].end)
                cursor.tokens[k:end] = [call]
                self._report_spaced(call)
            k += 1
        return whole

    def _report_spaced(self, name: Token) -> None:
        found = self.cursor.source[name.span]
        self.reporter.report(codes.NAME_WITH_SPACE, name.span, found=found, right=name.text)

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
        elif arguments:  # `DEF JUMP(3)`
            span = Span(name.end, place.end)
            text = self.cursor.source[arguments[0].span]
            is_often = len(arguments) == 1 and text.isdecimal() and int(text[:9]) > 1
            times = text if is_often else ""
            values = {"word": name.text, "name": name.text, "times": times, "fix": ""}
            self.reporter.report(codes.NO_BRACKETS_HERE, span, place, **values)
        else:
            span = self.cursor.span_from(name)
            self.reporter.report(codes.EMPTY_BRACKETS, span, word=name.text, of_def=name.text)

    def body_of_def(self, block: Block) -> None:
        """`def turn():`: go past the colon. That it lacks its END_DEF is another mistake."""
        cursor = self.cursor
        if cursor.token.kind is ODD and cursor.token.text == ":":
            self.reporter.answer(cursor.token)
            cursor.i += 1
        block.is_reported = True


def _end_of_name(tokens: Sequence[Token], start: int, words: Sequence[str]) -> int:
    """Return the place behind these words, with spaces or `-` between them; 0 for others."""
    k = start
    for word in words:
        k += k > start and tokens[k].kind == "-"
        if tokens[k].text != word:
            return 0
        k += 1
    return k
