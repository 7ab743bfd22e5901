"""A place among the tokens of a program.

Knows how to look around and how to go on. Knows no grammar and reports nothing.
"""

from __future__ import annotations

from itertools import pairwise

from tiniscript.source import Source, Span
from tiniscript.syntax.lexer import END, NEWLINE, Token
from tiniscript.words import other_name

AT_END = frozenset((";", NEWLINE, END))  # where an instruction ends
AFTER_VALUE = frozenset((",", ")", *AT_END))  # where a value does


class Cursor:
    """`tokens[i]` is the token to read next. The caller that reads it advances `i`."""

    __slots__ = ("_braces", "_free", "i", "source", "tokens")

    def __init__(self, source: Source, tokens: list[Token]) -> None:
        self.source = source
        self.tokens = tokens  # the last one is END, and is never gone past
        self.i = 0
        self._braces: tuple[int, dict[int, int]] = (0, {})  # of so many tokens, see `closing`
        self._free: dict[str, str] = {}  # names for words of the language, see `free_name`

    @property
    def token(self) -> Token:
        return self.tokens[self.i]

    @property
    def following(self) -> Token:
        """The token after the next one. END follows itself."""
        return self.tokens[min(self.i + 1, len(self.tokens) - 1)]

    @property
    def last(self) -> Token:
        """The token that was read last."""
        return self.tokens[self.i - 1]

    def span_from(self, first: Token) -> Span:
        """Return the span from `first` to the token that was read last."""
        return Span(first.start, self.tokens[self.i - 1].end)

    def line_of(self, token: Token) -> int:
        return self.source.position(token.start)[0]

    def closing(self, start: int) -> int | None:
        """Return the place of the `}` that belongs to the `{` at `start`, None where none does."""
        if self._braces[0] != len(self.tokens):  # a repair may have made one of two
            open_ones, pairs = [], {}
            for k, token in enumerate(self.tokens):
                if token.kind == "{":
                    open_ones.append(k)
                elif token.kind == "}" and open_ones:
                    pairs[open_ones.pop()] = k
            self._braces = (len(self.tokens), pairs)
        return self._braces[1].get(start)

    def free_name(self, word: str) -> str:
        """Return a name for a variable or a DEF that was called `word`: F_1, or F_2 beside an F_1.

        Where no `F =` and no `DEF F` is left, F_1 is rather the name that it got already.
        """
        if word not in self._free:
            pairs = list(pairwise(each.text for each in self.tokens))
            right = other_name(word)
            if not {(word, "="), (word, ":"), ("DEF", word)}.isdisjoint(pairs):
                from tiniscript.syntax.free_names import in_place_of  # only wrong ones need it

                right = in_place_of(self.source.text, word)
            self._free[word] = right
        return self._free[word]

    # -- looking over line ends, which are white space in brackets ------------------------------

    def inner(self) -> Token:
        """Return the next token that is no line end, without going there."""
        token = self.tokens[self.i]
        return self.tokens[self.after_newlines(self.i)] if token.kind is NEWLINE else token

    def to_inner(self) -> None:
        while self.tokens[self.i].kind is NEWLINE:
            self.i += 1

    def take_inner(self, kind: str) -> bool:
        """Go past the next token that is no line end if it is a `kind`; return whether it is."""
        tokens, k = self.tokens, self.i
        while tokens[k].kind is NEWLINE:
            k += 1
        if tokens[k].kind != kind:
            return False
        self.i = k + 1
        return True

    def after_newlines(self, k: int) -> int:
        """Return the place of the first token from `k` on that is no line end."""
        while self.tokens[k].kind is NEWLINE:
            k += 1
        return k

    def before(self, k: int) -> int:
        """Return the place of the last token before `k` that is no line end."""
        k -= 1
        while self.tokens[k].kind is NEWLINE:
            k -= 1
        return k

    # -- skipping -------------------------------------------------------------------------------

    def skip_separators(self) -> None:
        """Go past line ends and empty instructions."""
        while self.tokens[self.i].kind is NEWLINE or self.tokens[self.i].kind == ";":
            self.i += 1

    def skip_instruction(self) -> None:
        """Go to where the instruction ends."""
        while self.tokens[self.i].kind not in AT_END:
            self.i += 1

    def skip_line(self) -> None:
        while self.tokens[self.i].kind not in (NEWLINE, END):
            self.i += 1
