"""Recovery of numbers that more than one token makes: `2 cm`, `1/2 minuto`, `1 1/2`."""

from __future__ import annotations

from tiniscript.diagnostics import codes
from tiniscript.fixed_point import as_text
from tiniscript.source import Span
from tiniscript.syntax.amounts import is_amount, with_number
from tiniscript.syntax.cursor import AFTER_VALUE, AT_END, Cursor
from tiniscript.syntax.lexer import END, NEWLINE, NUMBER, WORD, Token
from tiniscript.syntax.operators import BINARY
from tiniscript.syntax.reporter import Reporter
from tiniscript.syntax.suggestions import between
from tiniscript.syntax.units import converted
from tiniscript.words import NUMBER_WORDS, UNITS, WORDS, Word

_ARTICLES = frozenset(("UN", "UNA", "EL", "LA", "A", "THE"))


class NumberRecovery:
    def __init__(self, cursor: Cursor, reporter: Reporter) -> None:
        self.cursor = cursor
        self.reporter = reporter

    def amount(self, span: Span, last: Token, token: Token) -> None:
        """`F(2, muy rapido)`."""
        said = (
            with_number(self.cursor.source.text, span) if is_amount(last.text, token.text) else {}
        )
        if said:
            self.reporter.answer(last)  # `rápido` has an accent
            self.reporter.answer(token)
            found = self.cursor.source[span].upper()
            self.reporter.fail(codes.UNKNOWN_NAME, span, None, found=found, **said)

    def is_unit(self, token: Token, k: int, in_brackets: bool) -> bool:
        """`W(2 s)`, `IF(DISTANCE < 10 cm)`."""
        cursor, tokens = self.cursor, self.cursor.tokens
        before, after = tokens[cursor.before(k)], tokens[k + 1].kind
        if k > cursor.i:
            return False  # `IF(DISTANCE < 20` and S on the next line
        is_name = before.kind is WORD and token.text not in WORDS and in_brackets
        if is_name and is_amount(before.text):
            return False  # `LOOP(varias veces)`
        if token.text not in UNITS or not (before.kind is NUMBER or is_name):
            return False
        ends_here = after in (AFTER_VALUE if in_brackets else AT_END)
        if in_brackets and token.text in WORDS and not self._closes(k + 1):
            return False  # `IF(DISTANCE < 10 S`: the bracket is open, and S stops
        if (
            not (ends_here and (in_brackets or token.text not in WORDS))
            and tokens[k + 1].text not in BINARY
        ):
            return False
        number, first = NUMBER_WORDS.get(before.text, before.text), before
        sign, over = tokens[cursor.before(k) - 1], tokens[max(0, cursor.before(k) - 2)]
        if before.kind is NUMBER and sign.kind in ("/", "*"):  # `1/2 minuto`, not `1/2/2 s`
            outer = tokens[max(0, cursor.before(k) - 3)].kind
            number = "" if outer in ("/", "*") else _divided(over, sign, before)
            first = over if number else before
        span = Span(first.start, token.end)
        found = cursor.source[span]
        unit = token.text
        is_number = before.kind is NUMBER or number.isdecimal()  # `dos segundos`
        right = converted(number, unit) if is_number and number else number
        self.reporter.report(codes.UNIT, span, found=found, number=number, right=right, unit=unit)
        cursor.i = k + 1
        return True

    def percent(self, token: Token, k: int) -> Token:
        """`50 por ciento`: return one word for both."""
        after = self.cursor.tokens[min(k + 1, len(self.cursor.tokens) - 1)]
        if token.text != "POR" or after.text != "CIENTO":
            return token
        both = Token(WORD, "PORCIENTO", token.start, after.end)
        self.cursor.tokens[k : k + 2] = [both]
        return both

    def unknown_time(self, span: Span, article: Token, name: Token) -> None:
        """`W(un rato)`: no name of two words, and no number."""
        if article.text in _ARTICLES:
            self.reporter.fail(codes.UNKNOWN_NAME, span, found=name.text, near="")

    def between(self, subject: Token) -> None:
        """`DISTANCE entre 5 y 10`."""
        k = self.cursor.after_newlines(self.cursor.i)
        said = between(self.cursor.tokens[k : k + 4], subject.text)
        if said is not None:
            right, end = said
            span = Span(subject.start, end)
            found = self.cursor.source[span]
            self.reporter.fail(codes.OTHER_SIGN, span, found=found, right=right)

    def plus(self, token: Token, place: int) -> None:
        """`F(+2, 80)`; and `v =+ 10` adds."""
        cursor = self.cursor
        before = cursor.tokens[place]
        if token.kind == "+" and cursor.tokens[cursor.i + 1].kind is NUMBER:
            number = cursor.tokens[cursor.i + 1]  # `F(+2, 80)`
            name = cursor.tokens[place - 1]
            if before.kind == "=" and before.end == token.start < number.start - 1:  # `v =+ 10`
                fix = f"{name.text} = {name.text} + {number.text}"
                span = Span(name.start, number.end)
                self.reporter.fail(codes.OTHER_ASSIGNMENT, name.span, span, found="=+", fix=fix)
            span = Span(token.start, number.end)
            is_sign = token.end == number.start and before.kind != "="
            right = number.text if is_sign else ""  # of `X = + 1` a name may be missing
            self.reporter.fail(codes.BAD_NUMBER, span, found=cursor.source[span], right=right)

    def cut_in_two(self, word: Word | None, bracket: int) -> None:
        """`F(2;80`: a `;` for the comma, and no `)`."""
        cursor = self.cursor
        row = cursor.tokens[bracket + 1 : bracket + 5]
        if len(row) < 4:
            return
        first, sign, second, after = row
        is_cut = first.kind is NUMBER and sign.kind == ";" and second.kind is NUMBER
        if word is None or len(word.arguments) != 2 or not is_cut or after.kind not in AT_END:
            return
        while cursor.token is not after:
            cursor.i += 1
        span = Span(cursor.tokens[bracket - 1].start, second.end)
        fix = f"{word.text}({first.text}, {second.text})"
        self.reporter.fail(codes.MISSING_CLOSE, first.span, span, last=first.text, fix=fix)

    def _closes(self, k: int) -> bool:
        """Whether a `)` comes on this line before another bracket opens."""
        tokens = self.cursor.tokens
        while tokens[k].kind not in ("(", ")", NEWLINE, END):
            k += 1
        return tokens[k].kind == ")"

    def with_part(self, whole: Token, over: Token) -> None:
        """`1 1/2`: a number and a part of one."""
        tokens = self.cursor.tokens
        k = self.cursor.after_newlines(self.cursor.i)
        if len(tokens) < k + 3 or not whole.kind is over.kind is NUMBER:
            return
        part = _divided(over, *tokens[k + 1 : k + 3])
        if part and "." not in whole.text + over.text:
            span = Span(whole.start, tokens[k + 2].end)
            value = as_text(int(whole.text[:9]) * 1000 + round(float(part) * 1000))
            self.reporter.fail(codes.BAD_NUMBER, span, found=self.cursor.source[span], right=value)


def _divided(over: Token, sign: Token, under: Token) -> str:
    """Return what `1/2` is, "" where it is no part of one."""
    if sign.kind != "/" or not (over.kind is under.kind is NUMBER):
        return ""
    low = float(under.text[:9])
    return as_text(round(float(over.text[:9]) / low * 1000)) if low else ""
