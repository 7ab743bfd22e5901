"""The grammar of a single line, and the place if it fails.

The parser itself: where it would report a mistake, reading ends. Knows no other line, and so no
block: headers, arms and ends are items of their own.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from tiniscript.base.source import Source, Span
from tiniscript.base.words import BLOCK_ENDS, WORDS, Word
from tiniscript.diagnostics import codes
from tiniscript.syntax.ast import Argument
from tiniscript.syntax.blocks import WORD_OF_END, Block, Blocks
from tiniscript.syntax.expressions import ExpressionParser
from tiniscript.syntax.lexer import END, WORD, Scan, Token
from tiniscript.syntax.operators import Postfix
from tiniscript.syntax.parser import Parser
from tiniscript.syntax.reporter import Failed, Reporter


class KnownNames(NamedTuple):
    """The names of a program: what may be a value, an instruction, and one with so many values."""

    values: frozenset[str]
    instructions: frozenset[str]
    names_with_count: frozenset[tuple[str, int]]


class Item(NamedTuple):
    """An instruction of a line, from token `start` to before `end`.

    `kind` is `open` for a header, `arm`, `end` or `do`; `word` is the instruction's first.
    """

    kind: str
    word: str
    start: int
    end: int


class Failure(NamedTuple):
    """The instruction that begins at token `start` cannot be read on at token `failed_at`."""

    start: int
    failed_at: int


def outline(
    kinds_and_texts: Sequence[tuple[str, str]], known_names: KnownNames
) -> list[Item] | Failure:
    """Return the items of a line of tokens (kind, text), or where it is wrong."""
    tokens = [Token(kind, text, k, k + 1) for k, (kind, text) in enumerate(kinds_and_texts)]
    tokens.append(Token(END, "", len(tokens), len(tokens)))
    return _Line(tokens, known_names).items()


class _RaisingReporter(Reporter):
    def report(self, code: codes.Code, span: Span, **values: str) -> None:
        if code.is_mistake and code is not codes.NUMBER_TOO_BIG:
            raise Failed


class _LoneBlocks(Blocks):
    """Each header, arm and end is right for itself."""

    @property
    def innermost_block(self) -> Block:
        return Block("IF", Span(0, 0), None, None, ())

    def begin(self, *header: object, **name: object) -> None:
        pass


class _Expressions(ExpressionParser):
    values: frozenset[str] = frozenset()

    def word(self, token: Token, postfix: Postfix) -> bool:
        if token.text not in WORDS and token.text not in self.values:
            raise Failed
        return super().word(token, postfix)


class _Line(Parser):
    def __init__(self, tokens: list[Token], known_names: KnownNames) -> None:
        super().__init__(Source(""), Scan(tokens, [], []))
        self.reporter = _RaisingReporter([])
        self.blocks = _LoneBlocks(self.reporter)
        self.expressions = self._own_expressions = _Expressions(self.cursor, self.reporter)
        self._own_expressions.values = known_names.values
        self._known_names, self._names_with_count = known_names, known_names.names_with_count
        self._items: list[Item] = []

    def items(self) -> list[Item] | Failure:
        cursor, start = self.cursor, 0
        try:
            if cursor.following_token.kind == "|":
                self.setup()
            while cursor.current_token.kind is not END:
                start = cursor.i
                if cursor.current_token.kind == ";":
                    cursor.i += 1
                else:
                    self.instruction()
        except Failed:
            return Failure(start, max(start, cursor.i))
        return self._items

    def instruction(self) -> None:
        start, word = self.cursor.i, self.cursor.current_token.text
        super().instruction()
        is_set = self.cursor.tokens[start + 1].kind == "="
        kind = "do" if is_set else _KINDS.get(word, "do")
        self._items.append(Item(kind, word, start, self.cursor.i))

    def assignment(self, name: Token) -> None:
        tokens, k = self.cursor.tokens, self.cursor.i + 2
        if tokens[k].kind is WORD and tokens[k + 1].kind == "=":
            raise Failed  # `X = Y = 5` is rather two of them than a question
        super().assignment(name)
        self._own_expressions.values |= {name.text}

    def close(self, word: Token) -> None:
        """The block that it ends is on other lines."""

    def arguments_of(self, word: Token, word_row: Word | None) -> tuple[Argument, ...] | None:
        arguments = super().arguments_of(word, word_row)
        count = len(arguments or ())
        is_right = (
            len(word_row.arguments) == count
            if word_row
            else (word.text, count) in self._names_with_count
        )
        if not is_right:
            raise Failed
        return arguments

    def argument_of(self, word: Token) -> Argument:
        argument = super().argument_of(word)
        if argument.is_plain and word.text != "LOOP":
            raise Failed  # a number is no question
        return argument

    def own_name(self, word: Token, following_token: Token) -> None:
        is_called = following_token.kind == "("  # the number of values is checked later
        names = (
            {name for name, _ in self._names_with_count}
            if is_called
            else self._known_names.instructions
        )
        if word.text not in names:
            raise Failed


_KINDS = {
    **dict.fromkeys(BLOCK_ENDS, "open"),
    **dict.fromkeys(("ELSE", "ELSEIF"), "arm"),
    **dict.fromkeys(WORD_OF_END, "end"),
}
