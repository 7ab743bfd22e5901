"""Recovery of questions that are joined as people say them: `DISTANCE > 10 y menor 20`, `A | B`.

Knows the tokens on both sides of AND and OR, and which sign or word was meant between them.
"""

from __future__ import annotations

from tiniscript.diagnostics import codes
from tiniscript.source import Span
from tiniscript.syntax.cursor import Cursor
from tiniscript.syntax.lexer import Token
from tiniscript.syntax.operators import COMPARISONS
from tiniscript.syntax.reporter import Reporter
from tiniscript.syntax.suggestions import operator_words
from tiniscript.syntax.vocabulary import Vocabulary
from tiniscript.words import NEAR_WORDS

_TOWARDS = frozenset(["A", "AL", "LA", "EL", "DE", "DEL", "UN", "UNA", "TO", "THE", "OF", "FROM"])


class JoinedQuestions:
    def __init__(self, cursor: Cursor, reporter: Reporter, known: Vocabulary) -> None:
        self.cursor = cursor
        self.reporter = reporter
        self.known = known

    def is_sign_alone(self, word: Token) -> bool:
        """`DISTANCE > 10 y menor 20`: read on with what is compared."""
        tokens, k = self.cursor.tokens, self.cursor.i
        said = operator_words(tokens, k)
        if (
            k < 5
            or said is None
            or self.known.is_own(word.text)
            or said[1] not in COMPARISONS
            or tokens[k - 1].text not in ("AND", "OR")
        ):
            return False
        subject, before = tokens[k - 4], tokens[k - 5]
        if tokens[k - 3].kind not in COMPARISONS or not self.known.is_own(subject.text):
            return False
        if before.kind != "(" and before.text not in ("AND", "OR", "NOT"):
            return False  # of `DISTANCE + LIGHT_R > 10` the whole sum is compared
        end, sign = said
        span = Span(word.start, tokens[end - 1].end)
        self.reporter.report(codes.OTHER_SIGN, span, found=self.cursor.source[span],
                             right=f"{subject.text} {sign}")  # fmt: skip
        tokens[k:end] = [subject._replace(start=span.start, end=span.end), Token(sign, sign, *span)]
        return True

    def is_in_words(self, word: Token) -> bool:
        """`la distancia a la pared < 10`: what is far away says no more than the sensor."""
        tokens, k = self.cursor.tokens, self.cursor.i
        name = self.known.value(word.text)
        end = k + 1
        while tokens[end].text in _TOWARDS or tokens[end].text in NEAR_WORDS:
            end += 1
        is_asked = tokens[end].kind in COMPARISONS or operator_words(tokens, end) is not None
        if name != "DISTANCE" or end == k + 1 or not (self.known.is_number(name) and is_asked):
            return False
        if tokens[end - 1].text not in NEAR_WORDS:
            return False
        span = Span(word.start, tokens[end - 1].end)
        found = self.cursor.source[span]
        self.reporter.report(codes.OTHER_LANGUAGE, span, span, found=found, right=name, fix=name,
                             usage=name)  # fmt: skip
        tokens[k:end] = [word._replace(text=name, end=span.end)]
        return True

    def asked_twice(self, word: Token) -> None:
        """`DISTANCE < 10 AND IF LIGHT_R > 50`: one IF asks all of it."""
        before = self.cursor.tokens[self.cursor.i - 1]
        if word.text in ("IF", "WHILE") and before.text in ("AND", "OR"):
            span = Span(before.start, word.end)
            found = self.cursor.source[span]
            self.reporter.fail(codes.OTHER_SIGN, span, found=found, right=before.text)
