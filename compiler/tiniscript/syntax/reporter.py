"""The diagnostics of one parse, and what must not be reported again.

Knows how the parser abandons a rule: it reports why, and raises Failed. Knows no grammar.
"""

from __future__ import annotations

from typing import NoReturn

from tiniscript.diagnostics.codes import Code, Diagnostic
from tiniscript.source import Span
from tiniscript.syntax.lexer import Token


class Failed(Exception):
    """An instruction cannot be read to its end. This is reported; the rest of it is skipped."""


class Resumed(Failed):
    """What could not be read ends here: the next instruction begins at the cursor's place."""


class Reporter:
    """`diagnostics` begins with those of the lexer."""

    def __init__(self, of_lexer: list[Diagnostic]) -> None:
        self._of_lexer = of_lexer
        self.diagnostics = list(of_lexer)
        self._answered: set[int] = set()
        self.reserved_words: set[str] = set()  # that are assigned: reported there, and only there
        self.crowded_line = -1  # the last line with a separator missing, which is reported once

    def report(self, code: Code, span: Span, place: Span | None = None, **values: str) -> None:
        self.diagnostics.append(Diagnostic(code, span, values, place))

    def fail(self, code: Code, span: Span, place: Span | None = None, **values: str) -> NoReturn:
        self.report(code, span, place, **values)
        raise Failed

    def change(self, place: int, diagnostic: Diagnostic) -> None:
        """Replace the diagnostic at index `place`."""
        if place < len(self._of_lexer):
            self._of_lexer[place] = diagnostic
        self.diagnostics[place] = diagnostic

    def widen(self, start: int, end: int) -> None:
        """Let the thing to try of the diagnostic at `start` stand for all up to `end`."""
        for k, each in enumerate(self.diagnostics):
            if each.span.start == start and each.is_mistake:
                self.diagnostics[k] = each._replace(place=Span(start, end))

    def withdraw(self, count: int) -> None:
        """Drop all diagnostics but the first `count`, because the others follow from them."""
        del self.diagnostics[count:]

    def answer(self, odd: Token) -> None:
        """Drop what the lexer said about an odd sign: the parser knows more."""
        self._answered.add(odd.start)

    def found(self) -> list[Diagnostic]:
        """Return the diagnostics without the answered ones.

        If there are no others, the answered ones stay, because an odd sign is always a mistake.
        """
        odd = self._of_lexer
        found = [each for each in odd if each.span.start not in self._answered]
        found += self.diagnostics[len(odd) :]
        return found if any(each.is_mistake for each in found) else self.diagnostics
