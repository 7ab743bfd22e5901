"""Recovery of how a program begins: SETUP and its bar.

Knows what people write in place of `SI|`, and bars that stand elsewhere.
"""

from __future__ import annotations

from typing import NoReturn

from tiniscript.diagnostics import codes
from tiniscript.source import Span
from tiniscript.syntax.cursor import Cursor
from tiniscript.syntax.foreign import Grammar, foreign_header
from tiniscript.syntax.lexer import END, NEWLINE, NUMBER, WORD, Token
from tiniscript.syntax.near import near_at
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
    head_in,
    inside,
    is_question,
)
from tiniscript.words import TURN_WORDS, WORDS, meant_by

# What comes after the SI of a question: `si hay un obstaculo`, `si toca la pared`.
_SEEING = frozenset(
    "HAY VE VES VEO DETECTA ENCUENTRA TOCA CHOCA LLEGA ESTA EL LA UN UNA".split()  # noqa: SIM905
)


_TITLES = 3  # lines above a program
# Words of a line that does something in another language.
_SAYING = (
    SETTING | CHANGING | BEFORE_NAME | BEFORE_CALL | IMPORTING | EVENTS | FRAME_WORDS | TURN_WORDS
    | {*OPERATOR_WORDS, "TO"}
)  # fmt: skip
_SHORT = 3  # letters of names that may be variables
_IN_INSTRUCTION = frozenset(("(", "=", "|", "{", "}", "<", ">", ";"))


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

    def in_two(self, word: Token, letter: Token) -> None:
        """`S I|F(2, 80)`."""
        if self.cursor.tokens[self.cursor.i + 2].kind == "|":
            self._unknown(Span(word.start, letter.end), "SI|")
            self.cursor.i += 3

    def misread(self, first: Token) -> str:
        """`5I|F(2, 80)`: return how the program begins."""
        text = self.cursor.source[first.span].upper()
        if text in ("5I", "51", "5B", "58"):
            self.reporter.answer(first)
            self._unknown(first.span, "SI|" if text in ("5I", "51") else "SB|")
            self.cursor.i += 2
        return "SB" if text in ("5B", "58") else "SI"

    def _unknown(self, span: Span, right: str) -> None:
        found = self.cursor.source[span].upper()
        self.reporter.report(codes.SETUP_UNKNOWN, span, None, found=found, right=right)

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
        self._unknown(word.span, right)
        return "SI"

    def not_alone(self, ping: Token, token: Token) -> None:
        """`PING|F(2, 80)`: nothing after it is read."""
        cursor = self.cursor
        at_end = token is cursor.tokens[-1]
        self.reporter.report(codes.PING_ALONE, ping.span if at_end else token.span)
        cursor.i = len(cursor.tokens) - 1

    def in_the_middle(self, parser: Grammar, word: Token) -> NoReturn:
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
                fix = head_in(WORDS["IF"], row)
                self.reporter.report(codes.SPANISH_IF, word.span, None, fix=fix)
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

    def _near(self, parser: Grammar, word: Token) -> None:
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
