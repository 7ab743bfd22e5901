"""Recovery of how a program begins: SETUP and its bar.

Knows what people write in place of `SI|`, and bars that stand elsewhere.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NoReturn

from tiniscript.diagnostics import codes
from tiniscript.source import Span
from tiniscript.syntax.cursor import AT_END, Cursor
from tiniscript.syntax.foreign import foreign_header
from tiniscript.syntax.lexer import END, NEWLINE, NUMBER, ODD, WORD, Token
from tiniscript.syntax.near import near_at
from tiniscript.syntax.operators import COMPARISONS
from tiniscript.syntax.phrases import (
    BEFORE_CALL,
    BEFORE_NAME,
    CHANGING,
    EVENTS,
    FRAME_WORDS,
    IMPORTING,
    SETTING,
    TERMINAL,
)
from tiniscript.syntax.reporter import Reporter, Resumed
from tiniscript.syntax.suggestions import (
    OPERATOR_WORDS,
    after_bracket,
    head_in,
    inside,
    is_question,
)
from tiniscript.syntax.worded_questions import either_sensor
from tiniscript.words import TURN_WORDS, WORDS, meant_by

if TYPE_CHECKING:
    from tiniscript.syntax.parser import Parser

# What comes after the SI of a question: `si hay un obstaculo`, `si toca la pared`.
_SEEING = frozenset(
    "HAY VE VES VEO DETECTA ENCUENTRA TOCA CHOCA LLEGA ESTA EL LA UN UNA".split()  # noqa: SIM905
)


_BARS = (":", "||", "/", "\\", "¦", "!", "¡")  # that stand for the bar whatever follows
# Signs that mean nothing right behind SI, where an instruction comes after them.
_FOR_BAR = COMPARISONS | {";", ",", "-", "+", "*", "/", "%", ")", "{"}
_TITLES = 3  # lines above a program
# Words of a line that does something in another language.
_SAYING = (
    SETTING | CHANGING | BEFORE_NAME | BEFORE_CALL | IMPORTING | EVENTS | FRAME_WORDS | TURN_WORDS
    | {*OPERATOR_WORDS, "TO"}
)  # fmt: skip
_SHORT = 3  # letters of names that may be variables
_IN_INSTRUCTION = frozenset(("(", "=", "|", "{", "}", "<", ">", ";"))
_SIGNS = 3  # of them in a row
_NOTE = re.compile(r"[ \t]*(//|#)(?=[ \t]*[A-Za-z]\w*[ \t]*\()")  # `SI//F(2, 80)`


class SetupRecovery:
    def __init__(self, cursor: Cursor, reporter: Reporter) -> None:
        self.cursor = cursor
        self.reporter = reporter

    def titles(self) -> None:
        """`Valentina Quispe 5to B`, above the line that begins with SI|: such lines are notes."""
        cursor, tokens = self.cursor, self.cursor.tokens
        ends: list[int] = []
        k = cursor.i
        while len(ends) < _TITLES and tokens[k].text not in ("SI", "SB"):
            end = k
            while tokens[end].kind not in (NEWLINE, END, *_IN_INSTRUCTION):
                end += 1
            if tokens[end].kind in _IN_INSTRUCTION:
                break
            ends.append(end)
            k = cursor.after_newlines(end)
        if tokens[k].text not in ("SI", "SB") or tokens[k + 1].kind != "|":
            ends = [end for end in ends[:1] if self._is_name(cursor.i, end)]
        for end in ends:
            cursor.to_inner()
            row = tokens[cursor.i : end]
            for token in row:
                self.reporter.answer(token)
            span = Span(row[0].start, row[-1].end)
            fix = f"// {cursor.source[span]}"
            command = cursor.source[span] if row[0].text in TERMINAL else ""
            self.reporter.report(codes.PROSE, span, None, fix=fix, command=command)
            cursor.i = end
        cursor.to_inner()

    def _is_name(self, start: int, end: int) -> bool:
        """Whether a first line says nothing, `Valentina Quispe`, and the next one is a call."""
        tokens = self.cursor.tokens
        row, k = tokens[start:end], self.cursor.after_newlines(end)
        known = WORDS.get(tokens[k].text)
        is_before_call = known is not None and known.is_call and tokens[k + 1].kind == "("
        says = any(
            each.kind is NUMBER or each.text in _SAYING or each.text in WORDS or meant_by(each.text)
            for each in row
        )
        words = [each for each in row if each.kind is WORD]
        is_long = len(words) > 1 and any(len(each.text) > _SHORT for each in words)
        return is_before_call and not says and is_long

    def without_bar(self, word: Token) -> str | None:
        """`SI:F(2, 80)`, `SI°F(2, 80)`, `SI F(2, 80)`: return how the program begins, and go on.

        None where another thing than a program may begin here, as a question in Spanish.
        """
        cursor, tokens = self.cursor, self.cursor.tokens
        start = k = cursor.i + 1
        if word.text == "PING" or (word.text == "S" and not self._is_in_two(word)):
            return None
        if word.text == "S":
            cursor.i += 3
            return "SI"
        line = cursor.line_of(word)
        while self._is_sign(k) and k - start < _SIGNS and cursor.line_of(tokens[k]) == line:
            k += 1
        if k > start and tokens[k].kind == "|":  # `SI.|F(2, 80)`
            k += 1
        if k == start and tokens[k].kind == "(":
            return self._in_brackets(word, start)
        is_letter = tokens[k].text in ("L", "I") or cursor.source[tokens[k].span] == "1"
        if k == start and is_letter and self._begins(k + 1, line):
            k += 1
        note = _NOTE.match(cursor.source.text, word.end)
        if k == start and note is not None:
            self.reporter.answer(Token(ODD, "", note.start(1), note.end()))
            self._bar_missing(word, Span(word.start, note.end()))
            cursor.i = k
            return "SB" if word.text == "SB" else "SI"
        is_bar = k == start + 1 and cursor.source[tokens[start].span] in _BARS
        is_line = k > start and tokens[k].kind in (NEWLINE, END)
        if not (is_bar or is_line or self._begins(k, line, k > start)):
            return None
        for token in tokens[cursor.i : k]:
            self.reporter.answer(token)
        span = Span(word.start, tokens[k - 1].end)
        self._bar_missing(word, span)
        cursor.i = k
        return "SB" if word.text == "SB" else "SI"

    def _is_in_two(self, word: Token) -> bool:
        """`S I|F(2, 80)`."""
        letter, bar = self.cursor.tokens[self.cursor.i + 1 : self.cursor.i + 3]
        if letter.text != "I" or bar.kind != "|":
            return False
        span = Span(word.start, letter.end)
        found = self.cursor.source[span]
        self.reporter.report(codes.SETUP_UNKNOWN, span, None, found=found, right="SI|")
        return True

    def _bar_missing(
        self, word: Token, span: Span, place: Span | None = None, fix: str = ""
    ) -> None:
        sign = self.cursor.source[Span(word.end, span.end)].strip()
        found = "SB" if word.text == "SB" else "SI"
        said = {"found": found, "fix": fix or f"{found}|", _kind_of(sign): sign}
        self.reporter.report(codes.SETUP_NEEDS_BAR, span, place, **said)

    def _in_brackets(self, word: Token, start: int) -> str | None:
        """`SI(F(2, 80))`: a bracket for the bar, and perhaps its other one."""
        tokens = self.cursor.tokens
        if not self._begins(start + 1, self.cursor.line_of(word)):
            return None
        end = after_bracket(tokens, start)
        self.reporter.answer(tokens[start])
        span = Span(word.start, tokens[start].end)
        self.cursor.i = start + 1
        if end is None:
            self._bar_missing(word, span)
        else:
            close = tokens.pop(end - 1)
            self.reporter.answer(close)
            inner = self.cursor.source[Span(tokens[start].end, close.start)]
            self._bar_missing(word, span, Span(word.start, close.end), f"{word.text}|{inner}")
        return word.text

    def _is_sign(self, k: int) -> bool:
        """Whether a sign is at `k` that stands for nothing at the beginning of a program."""
        token = self.cursor.tokens[k]
        is_bar = self.cursor.source[token.span] in _BARS
        return is_bar or token.kind is ODD or token.kind in _FOR_BAR

    def _begins(self, k: int, line: int, is_sure: bool = False) -> bool:
        """Whether an instruction begins at `k`; `is_sure`: it cannot be a question."""
        tokens = self.cursor.tokens
        if k >= len(tokens) or self.cursor.line_of(tokens[k]) != line:
            return False
        word, after = tokens[k], tokens[min(k + 1, len(tokens) - 1)]
        known = WORDS.get(word.text) if word.kind is WORD else None
        if known is not None and known.role not in ("setup", "value", "operator", "function"):
            return is_sure or after.kind in ("(", *AT_END) or word.text == "DEF" or known.is_call
        if word.kind is not WORD or not is_sure:
            return False
        return after.kind == "=" or (after.kind == "(" and meant_by(word.text) is not None)

    def misread(self, first: Token, bar: Token) -> str | None:
        """`5I|F(2, 80)` and `SILF(2, 80)`: return how the program begins, None if not so."""
        cursor = self.cursor
        text = cursor.source[first.span].upper()
        if bar.kind == "|" and text in ("5I", "51", "S1", "5B", "S8", "58"):
            self.reporter.answer(first)
            right = "SI|" if text in ("5I", "51", "S1") else "SB|"
            self.reporter.report(codes.SETUP_UNKNOWN, first.span, found=text, right=right)
            cursor.i += 2
            return right[:2]
        rest, length = WORDS.get(text[2:]), 2  # `SIF(2, 80)`
        if rest is None and text[2:3] in ("L", "I", "1", "_"):
            rest, length = WORDS.get(text[3:]), 3
        if text == "SIIF" and not any(
            each.kind in COMPARISONS for each in inside(cursor.tokens, cursor.i + 1)
        ):
            rest, length = WORDS["F"], 3  # an I for the bar
        begin = "SI" if text[:2] == "S1" else text[:2]
        is_known = rest is not None and (rest.is_call or rest.role == "block")
        is_glued = text not in WORDS and begin in ("SI", "SB") and is_known
        if not is_glued or bar.kind != "(" or rest is None:
            return None
        span = Span(first.start, first.start + length)
        sign = cursor.source[Span(first.start + 2, first.start + length)]
        said = {"found": begin, "fix": f"{begin}|", _kind_of(sign): sign}
        self.reporter.report(codes.SETUP_NEEDS_BAR, span, None, **said)
        cursor.tokens[cursor.i] = Token(WORD, rest.text, first.start + length, first.end)
        return begin

    def unknown(self, word: Token) -> str:
        """`START|F(2, 80)`, `GO|F(2, 80)`: go on as after `SI|`."""
        known = WORDS.get(word.text)
        if known is not None and known.role == "block":  # `IF|DISTANCE < 10|S`
            values = {"word": word.text, "fix": "", "usage": known.usage}
            self.reporter.report(codes.MISSING_OPEN, word.span, None, **values)
            return "SI"
        right = "SI|"
        if word.text.startswith(("SB", "S8", "BOT", "BUT")) or meant_by(word.text) == "BUTTON":
            right = "SB|"
        self.reporter.report(codes.SETUP_UNKNOWN, word.span, found=word.text, right=right)
        return "SI"

    def not_alone(self, ping: Token, token: Token) -> None:
        """`PING|F(2, 80)`: nothing after it is read."""
        cursor = self.cursor
        at_end = token is cursor.tokens[-1]
        self.reporter.report(codes.PING_ALONE, ping.span if at_end else token.span)
        cursor.i = len(cursor.tokens) - 1

    def in_the_middle(self, parser: Parser, word: Token) -> NoReturn:
        """`SI|SI|F(2, 80)`; but `SI(DISTANCE < 10)` asks a question."""
        cursor = self.cursor
        following = cursor.following
        if word.text == "CHECK_CONNECTION":
            self.reporter.fail(codes.PING_ALONE, word.span)
        if word.text == "SI" and following.kind is WORD:
            self._near(parser, word)
        if word.text == "SI" and following.text == "NO":
            found = cursor.source[Span(word.start, following.end)]
            values = {"found": found, "right": "ELSE", "fix": "ELSE", "usage": "ELSE"}
            self.reporter.report(
                codes.OTHER_LANGUAGE, Span(word.start, following.end), None, **values
            )
            cursor.i += 1
            parser.arm(Token(WORD, "ELSE", word.start, following.end), is_reported=True)
            parser.recovery.in_block.go_on()
        if word.text == "SI" and following.kind != "|":
            known = parser.recovery.in_block.known
            asks = is_question(cursor.tokens, cursor.i + 1) or known.is_number(following.text)
            if following.kind == "(" or asks:
                line = parser.recovery.in_block.whole_line(word, "IF")
                if line is not None:
                    place = cursor.span_from(word)
                    self.reporter.report(codes.SPANISH_IF, word.span, place, fix=line)
                    raise Resumed
                row = inside(cursor.tokens, cursor.i + 1)
                said = either_sensor(row, known) or {"fix": head_in(WORDS["IF"], row)}
                self.reporter.report(codes.SPANISH_IF, word.span, None, **said)
                foreign_header(parser, word, "IF")
        row = cursor.tokens[cursor.i + 1 : cursor.i + 5]
        if word.text == "SI" and any(meant_by(each.text) == "BUTTON" for each in row):
            self.reporter.fail(codes.NO_BUTTON, word.span)
        if word.text == "SI" and following.text in _SEEING:
            self.reporter.report(codes.SPANISH_IF, word.span, fix=WORDS["IF"].example)
            foreign_header(parser, word, "IF")
        is_later = any(each.kind is WORD for each in cursor.tokens[: cursor.i])
        if following.kind == "|" or (word.text == "SB" and is_later):
            values = self._button_later(following) if word.text == "SB" else {}
            self.reporter.fail(codes.SETUP_TWICE, word.span, None, found=word.text, **values)
        fix = f"{word.text}|" if word.text != "PING" else ""
        self.reporter.fail(codes.SETUP_NEEDS_BAR, word.span, None, found=word.text, fix=fix)

    def _button_later(self, following: Token) -> dict[str, str]:
        """`F(1, 80); SB|B(1, 80)`: return what is said of the SB before `following`."""
        cursor = self.cursor
        first = cursor.after_newlines(0)
        begins = cursor.tokens[first].text if cursor.tokens[first + 1].kind == "|" else ""
        values = {"button": "SB", "pause": "W(2)", "here": "SB|" if following.kind == "|" else "SB"}
        if begins == "SB":
            return {**values, "twice": values["here"]}
        return {**values, "instead": begins} if begins else values

    def _near(self, parser: Parser, word: Token) -> None:
        """`si hay una pared para`, `si no hay pared`."""
        cursor, in_block = self.cursor, parser.recovery.in_block
        near = near_at(cursor.tokens, cursor.i + 1, in_block.known)
        if near is None:
            return
        line = in_block.whole_line(word, "IF")
        if line is not None:
            self.reporter.report(codes.SPANISH_IF, word.span, cursor.span_from(word), fix=line)
            raise Resumed
        cursor.i = near.end
        place = cursor.span_from(word)
        fix = f"IF({near.question})"
        self.reporter.report(codes.SPANISH_IF, word.span, place, fix=fix)
        in_block.begin_reported("IF", place)
        in_block.go_on()

    def bar_between(self, first: Token, bar: Token) -> NoReturn:
        """`F(2, 80)|R(1, 60)`: a `;` is meant where the word before is an instruction."""
        if first.text in WORDS and WORDS[first.text].role == "setup":
            self.reporter.fail(codes.SETUP_TWICE, bar.span, found=first.text)
        self.reporter.report(codes.BAR_BETWEEN, bar.span)
        self.cursor.i += 1
        raise Resumed


def _kind_of(sign: str) -> str:
    """`SIlF(2, 80)` has a letter where the bar belongs, which looks like it."""
    return "letter" if sign.isalpha() else "sign"
