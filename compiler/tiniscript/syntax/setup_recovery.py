"""Recovery of how a program begins: SETUP and its bar.

Knows what people write in place of `SI|`, and bars that stand elsewhere.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NoReturn

from tiniscript.diagnostics import codes
from tiniscript.source import Span
from tiniscript.syntax.cursor import Cursor
from tiniscript.syntax.foreign import foreign_header
from tiniscript.syntax.lexer import WORD, Token
from tiniscript.syntax.near import near_at
from tiniscript.syntax.reporter import Reporter, Resumed
from tiniscript.syntax.suggestions import head_in, inside, is_question
from tiniscript.words import WORDS, meant_by

if TYPE_CHECKING:
    from tiniscript.syntax.parser import Parser

# What comes after the SI of a question: `si hay un obstaculo`, `si toca la pared`.
_SEEING = frozenset(
    "HAY VE VES VEO DETECTA ENCUENTRA TOCA CHOCA LLEGA ESTA EL LA UN UNA".split()  # noqa: SIM905
)


class SetupRecovery:
    def __init__(self, cursor: Cursor, reporter: Reporter) -> None:
        self.cursor = cursor
        self.reporter = reporter

    def is_taken_for_bar(self, word: Token, sign: Token) -> bool:
        """Whether `SI:` or `SI||` begins the program."""
        found = self.cursor.source[sign.span]
        is_sign = found in (":", "||", "/", "\\", "¦", "!", "¡")
        is_letter = found in ("l", "L", "I", "i", "1") and self._is_command(self.cursor.i + 2)
        if not (is_sign or is_letter):
            return False
        self.reporter.answer(sign)
        span = Span(word.start, sign.end)
        self.reporter.report(codes.SETUP_NEEDS_BAR, span, found=word.text)
        return True

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
        if rest is None and text[2:3] in ("L", "I", "1"):
            rest, length = WORDS.get(text[3:]), 3
        is_glued = (
            text not in WORDS and text[:2] in ("SI", "SB") and rest is not None and rest.is_call
        )
        if not is_glued or bar.kind != "(" or rest is None:
            return None
        span = Span(first.start, first.start + length)
        self.reporter.report(codes.SETUP_NEEDS_BAR, span, found=text[:2])
        cursor.tokens[cursor.i] = Token(WORD, rest.text, first.start + length, first.end)
        return text[:2]

    def _is_command(self, k: int) -> bool:
        """Whether an instruction begins at `k`: `SI l F(2, 80)` has a letter for its bar."""
        tokens = self.cursor.tokens
        known = WORDS.get(tokens[k].text) if k < len(tokens) else None
        return known is not None and known.role not in ("setup", "value", "operator")

    def unknown(self, word: Token) -> str:
        """`START|F(2, 80)`, `GO|F(2, 80)`: go on as after `SI|`."""
        known = WORDS.get(word.text)
        if known is not None and known.role == "block":  # `IF|DISTANCE < 10|S`
            values = {"word": word.text, "fix": "", "usage": known.usage}
            self.reporter.report(codes.MISSING_OPEN, word.span, None, **values)
            return "SI"
        right = "SI|START;" if word.text == "START" else "SI|"
        if word.text.startswith(("SB", "BOT", "BUT")) or meant_by(word.text) == "BUTTON":
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
                fix = head_in(WORDS["IF"], inside(cursor.tokens, cursor.i + 1))
                self.reporter.report(codes.SPANISH_IF, word.span, fix=fix)
                foreign_header(parser, word, "IF")
        row = cursor.tokens[cursor.i + 1 : cursor.i + 5]
        if word.text == "SI" and any(meant_by(each.text) == "BUTTON" for each in row):
            self.reporter.fail(codes.NO_BUTTON, word.span)
        if word.text == "SI" and following.text in _SEEING:
            self.reporter.report(codes.SPANISH_IF, word.span, fix=WORDS["IF"].example)
            foreign_header(parser, word, "IF")
        code = codes.SETUP_TWICE if following.kind == "|" else codes.SETUP_NEEDS_BAR
        self.reporter.fail(code, word.span, found=word.text)

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
