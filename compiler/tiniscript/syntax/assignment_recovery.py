"""Recovery of what sets a variable in another way: `X, Y = 5, 6`, `mi-vel = 5`, `X + 1`."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from tiniscript.diagnostics import codes
from tiniscript.source import Span
from tiniscript.syntax.cursor import AT_END, Cursor
from tiniscript.syntax.lexer import NUMBER, WORD, Token
from tiniscript.syntax.reporter import Reporter
from tiniscript.syntax.vocabulary import Vocabulary
from tiniscript.words import WORDS

_IN_VALUE = frozenset((NUMBER, "+", "-", "*", "/", "(", ")"))
_ANSWERS = ("TRUE", "FALSE")
_MOST_IN_VALUE = 12  # tokens of a value that several variables get


class AssignmentRecovery:
    """`unread` remembers that a variable is set to a value that cannot be read."""

    def __init__(
        self,
        cursor: Cursor,
        reporter: Reporter,
        known: Vocabulary,
        unread: Callable[[Token], None],
    ) -> None:
        self.known = known
        self.cursor = cursor
        self.reporter = reporter
        self.unread = unread

    def changed(self, name: Token, tokens: Sequence[Token]) -> None:
        """`X + 1` alone: X gets the sum."""
        if len(tokens) != 3 or tokens[1].kind not in ("+", "-", "*", "/"):
            return
        sign, number = tokens[1:]
        if number.kind is NUMBER:
            span = Span(name.start, number.end)
            fix = f"{name.text} = {name.text} {sign.text} {number.text}"
            self.cursor.skip_instruction()
            self.reporter.fail(codes.NOT_AN_INSTRUCTION, name.span, span, found=name.text, fix=fix)

    def hyphened(self, word: Token) -> None:
        """`mi-velocidad = 50`: a name has no hyphen."""
        tokens, k = self.cursor.tokens, self.cursor.i
        second = tokens[k + 2]
        is_close = tokens[k + 1].start == word.end and second.start == tokens[k + 1].end
        if is_close and second.kind is WORD and tokens[k + 3].kind == "=":
            right = f"{word.text}_{second.text}"
            span = Span(word.start, second.end)
            self.unread(Token(WORD, right, *span))
            found = self.cursor.source[span]
            self.reporter.fail(codes.NAME_WITH_SPACE, span, found=found, right=right)

    def one_for_all(self, first: Token, k: int) -> None:
        """`X = Y = 50`, with Y at `k`, where Y has no value before: each of them gets the 50."""
        cursor = self.cursor
        tokens = cursor.tokens
        names = [first]
        while tokens[k].kind is WORD and tokens[k + 1].kind == "=":
            names.append(tokens[k])
            k += 2
        known = [name for name in names[1:] if self.known.is_name(name.text)
                 or self.known.first_set.get(name.text, first.start) < first.start]  # fmt: skip
        if self.known.kit is None or known:
            return
        end = k
        while tokens[end].kind in _IN_VALUE or tokens[end].text in _ANSWERS:
            end += 1
        is_value = any(each.kind is NUMBER or each.kind is WORD for each in tokens[k:end])
        if not is_value or tokens[end].kind not in AT_END or end - k > _MOST_IN_VALUE:
            return
        value = cursor.source[Span(tokens[k].start, tokens[end - 1].end)]
        reserved = [name.text for name in names if name.text in WORDS]
        if any(WORDS[name].role in ("value", "operator") for name in reserved):
            return
        free = {name: cursor.free_name(name) for name in reserved}
        rows = [f"{free.get(name.text, name.text)} = {value}" for name in names]
        for name in names:
            self.unread(name)
        rows = list(dict.fromkeys(rows))  # `X = X = 5`
        cursor.i = end
        values = {"fix": ";".join(rows)}
        if reserved:
            values = {"example": "; ".join(rows), "reserved": reserved[0],
                      "free": free[reserved[0]]}  # fmt: skip
        self.reporter.reserved_words.update(reserved)
        span = cursor.span_from(first)
        self.reporter.fail(codes.SET_TOGETHER, span, span, **values)

    def several_at_once(self, word: Token) -> None:
        """`X, Y = 5, 6`: each variable has a line of its own."""
        cursor = self.cursor
        tokens, k = cursor.tokens, cursor.i
        names = [word]
        while tokens[k + 1].kind == "," and tokens[k + 2].kind is WORD:
            k += 2
            names.append(tokens[k])
        if tokens[k + 1].kind != "=" or len(names) < 2:
            return
        end = k + 2
        while tokens[end].kind not in AT_END:
            end += 1
        row = tokens[k + 2 : end]
        values = [each.text for each in row if each.kind is NUMBER or each.kind is WORD]
        is_even = len(values) == len(names) and len(row) == 2 * len(values) - 1
        pairs = zip(names, values, strict=False)
        fix = ";".join(f"{name.text} = {value}" for name, value in pairs) if is_even else ""
        for name in names:
            self.unread(name)
        cursor.i = end
        place = cursor.span_from(word)
        self.reporter.fail(codes.OTHER_ASSIGNMENT, word.span, place, found=",", fix=fix)
