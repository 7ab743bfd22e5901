"""A place among the tokens of a program.

It knows how to look around and how to continue. Knows no grammar and reports nothing.
"""

from __future__ import annotations

from tiniscript.base.source import Source, Span
from tiniscript.syntax.lexer import END, NEWLINE, WORD, Token

INSTRUCTION_ENDS = frozenset((";", NEWLINE, END))  # tokens that end an instruction
VALUE_ENDS = frozenset((",", ")", *INSTRUCTION_ENDS))  # tokens that end a value


class Cursor:
    """`tokens[i]` is the token to read next. The caller that reads it advances `i`."""

    __slots__ = ("i", "source", "tokens")

    def __init__(self, source: Source, tokens: list[Token]) -> None:
        self.source = source
        self.tokens = tokens  # the last one is END, and is never gone past
        self.i = 0

    @property
    def current_token(self) -> Token:
        return self.tokens[self.i]

    @property
    def following_token(self) -> Token:
        """The token after the next one. END follows itself."""
        return self.tokens[min(self.i + 1, len(self.tokens) - 1)]

    @property
    def last_token(self) -> Token:
        """The token that was read last."""
        return self.tokens[self.i - 1]

    def span_from(self, first: Token) -> Span:
        """Return the span from `first` to the token that was read last."""
        return Span(first.start, self.tokens[self.i - 1].end)

    # -- looking over line ends, which are white space in brackets ------------------------------

    def peek_inner(self) -> Token:
        """Return the next token other than a line end, without consuming it."""
        k = self.i
        while self.tokens[k].kind is NEWLINE:
            k += 1
        return self.tokens[k]

    def skip_newlines(self) -> None:
        while self.tokens[self.i].kind is NEWLINE:
            self.i += 1

    def take_inner(self, kind: str) -> bool:
        """Consume the next token other than a line end if it is of this kind; return whether it
        is.
        """
        is_next = self.peek_inner().kind == kind
        if is_next:
            self.skip_newlines()
            self.i += 1
        return is_next

    def has_names(self) -> bool:
        """Return whether brackets with names come next, or none."""
        k = self.i
        sign = self.tokens[k].kind
        while sign in ("(", ",") and self.tokens[k + 1].kind is WORD:
            k += 2
            sign = self.tokens[k].kind
        return sign == ")" or self.tokens[self.i].kind != "("

    def index_before(self, k: int) -> int:
        """Return the index of the last token before `k` other than a line end."""
        k -= 1
        while self.tokens[k].kind is NEWLINE:
            k -= 1
        return k

    def skip_instruction(self) -> None:
        """Go to where the instruction ends: at a separator outside brackets."""
        depth = 0
        while (kind := self.tokens[self.i].kind) is not NEWLINE and kind is not END:
            depth += (kind == "(") - (kind == ")")
            if kind == ";" and depth <= 0:
                break
            self.i += 1
