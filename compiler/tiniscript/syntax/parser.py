"""Tokens become a syntax tree.

Knows the shape of instructions. Does not know what a name stands for, how many arguments a word
takes or which kinds fit: `checker` does. Names what is wrong and goes on with the next
instruction. Works with stacks of its own, so no depth of input exhausts Python's.
"""

from __future__ import annotations

from typing import NamedTuple

from tiniscript import problems
from tiniscript.kit import Kit
from tiniscript.source import Source, Span
from tiniscript.syntax.ast import Argument, Assign, Break, Command, Program
from tiniscript.syntax.blocks import GoesOn
from tiniscript.syntax.call_suggestions import call_in, starts_value
from tiniscript.syntax.expressions import Failed
from tiniscript.syntax.lexer import END, NEWLINE, WORD, Scan, Token, scan
from tiniscript.syntax.recovery import Mistakes
from tiniscript.syntax.suggestions import BLOCKS, body_begins, head_in
from tiniscript.words import ALIASES, BLOCK_ENDS, WORDS, Word, meant_by, other_name

ENOUGH = 100  # mistakes after which reading on helps nobody

_AT_END = frozenset((";", NEWLINE, END))


class Parsed(NamedTuple):
    program: Program
    scan: Scan
    problems: list[problems.Problem]


def parse(source: Source, kit: Kit | None = None) -> Parsed:
    """Return the tree of a program with all that is wrong in its shape.

    The names of `kit` are no slips. Without a kit a name may be anything.
    """
    parser = _Parser(source, scan(source.text), kit)
    program = parser.program()
    return Parsed(program, parser.scan, parser.found())


class _Parser(Mistakes):
    def __init__(self, source: Source, scanned: Scan, kit: Kit | None) -> None:
        super().__init__(source, scanned, kit)
        self.scan = scanned

    def found(self) -> list[problems.Problem]:
        """Return the problems, without odd signs of which the parser knew more."""
        odd = self.scan.problems
        found = [each for each in odd if each.span.start not in self.answered]
        found += self.problems[len(odd) :]
        return found if any(each.is_mistake for each in found) else self.problems

    # -- the program ------------------------------------------------------------------------

    def program(self) -> Program:
        start = self._setup()
        while self.tokens[self.i].kind is not END and len(self.problems) <= ENOUGH:
            kind = self.tokens[self.i].kind
            if kind is NEWLINE or kind == ";":
                self.i += 1
                continue
            try:
                self._instruction()
            except GoesOn:
                continue
            except Failed:
                self.skip()
        self.never_end()
        return Program(start, tuple(self.body))

    def _setup(self) -> str:
        while self.tokens[self.i].kind is NEWLINE:
            self.i += 1
        word, bar = self.tokens[self.i], self.tokens[min(self.i + 1, len(self.tokens) - 1)]
        if word.kind is not WORD:
            return "SI"
        if bar.kind != "|":
            if not self._is_like_a_bar(word, bar):
                return "SI"
            span = Span(word.start, bar.end)
            self.instead(bar, problems.SETUP_NEEDS_BAR, span, found=word.text)
        self.i += 2
        if word.text == "PING":
            self._ping(word)
            return "PING"
        if word.text not in ("SI", "SB"):
            right = "SI|START;" if word.text == "START" else "SI|"
            self.report(problems.SETUP_UNKNOWN, word.span, found=word.text, right=right)
            return "SI"
        return word.text

    def _is_like_a_bar(self, word: Token, bar: Token) -> bool:
        """Whether `SI:` or `SI||` begins the program."""
        sign = self.source[bar.span]
        return word.text in ("SI", "SB", "PING") and sign in (":", "||", "/", "\\", "¦")

    def _ping(self, ping: Token) -> None:
        """Read `check_connection`, after which nothing may come."""
        token = self.tokens[self.i]
        if token.kind is WORD and token.text == "CHECK_CONNECTION":
            self.i += 1
            while (token := self.tokens[self.i]).kind is NEWLINE or token.kind == ";":
                self.i += 1
            if token.kind is END:
                return
        self.report(problems.PING_ALONE, ping.span if token.kind is END else token.span)
        self.i = len(self.tokens) - 1

    # -- instructions -----------------------------------------------------------------------

    def _instruction(self) -> None:
        token = self.tokens[self.i]
        if token.kind is not WORD:
            return self.no_word(token)
        following = self.tokens[self.i + 1]
        text = token.text
        if following.kind == "=":
            self._assign(token)
        elif text in BLOCKS:
            self.header(token)
        elif text == "DEF":
            self.define(token)
        elif text in ("ELSE", "ELSEIF"):
            self.arm(token)
        elif text in ALIASES or text in BLOCK_ENDS.values():
            self.i += 1
            self.no_brackets(token)
            self.end(ALIASES.get(text, text), token.span)
        elif text == "BREAK":
            self.i += 1
            self.no_brackets(token)
            self.here.append(Break(token.span))
        elif text == "END" and following.kind is WORD and following.text in BLOCK_ENDS:
            self.end_in_two_words(token, following)
        else:
            self._command(token)
        if self.tokens[self.i].kind not in _AT_END:
            self.no_separator(token)

    def _assign(self, name: Token) -> None:
        reserved = name.text in WORDS
        if reserved:
            self._reserved(name)
        self.i += 2
        try:
            value = self.argument(inside=False)
        except Failed:
            self.set_somehow(name)
            raise
        if reserved:
            raise Failed
        span = Span(name.start, value.span.end)
        self.here.append(Assign(name.text, name.span, value, span))

    def _reserved(self, name: Token) -> None:
        """`S = 5`; but `F = 2, 80` is F without brackets."""
        word = WORDS[name.text]
        end = body_begins(self.tokens, self.i + 2, names_end=False)
        rest = self.tokens[self.i + 2 : end]
        if len(word.arguments) > 1 and any(token.kind == "," for token in rest):
            span = Span(name.start, rest[-1].end)
            self.i = end
            self.fail(problems.MISSING_OPEN, span, word=name.text, fix=call_in(word, rest))
        self.reserved.add(name.text)
        right = other_name(name.text)
        self.report(problems.RESERVED, name.span, word=name.text, right=right)

    def _command(self, word: Token) -> None:
        known = WORDS.get(word.text)
        following = self.tokens[self.i + 1]
        if known is not None:
            self.refuse_if_no_command(word, known.role, following)
        elif following.kind not in _AT_END or self.kit is not None or word.text == "END":
            self.refuse_if_slip(word, following)
        self.i += 1
        arguments = None
        if following.kind == "(":
            arguments = self._arguments_of(word, known)
        elif known is not None and known.arguments:
            self.no_open_after(word, known)
        until = None
        if self.tokens[self.i].kind is WORD or self.tokens[self.i].kind == ",":
            until = self._until(word)
        span = Span(word.start, self.tokens[self.i - 1].end)
        if known is None or known.role != "start":
            self.here.append(Command(word.text, word.span, arguments, until, span))

    def _arguments_of(self, word: Token, known: Word | None) -> tuple[Argument, ...] | None:
        if known is not None and not known.arguments:
            self.no_brackets(word)
            return None
        arguments = self.arguments()
        if arguments or known is not None:
            return arguments
        span = Span(word.start, self.tokens[self.i - 1].end)
        self.report(problems.EMPTY_BRACKETS, span, word=word.text)
        return None

    def _until(self, word: Token) -> Argument | None:
        """Read `UNTIL(c)`, where it comes: right after the instruction."""
        token = self.tokens[self.i]
        following = self.tokens[min(self.i + 1, len(self.tokens) - 1)]
        if token.kind == ",":
            if following.kind is not WORD or following.text != "UNTIL":
                return None
            self.i += 1
            self.until_alone(following, self.source[Span(word.start, token.start)])
        elif token.text != "UNTIL":
            if meant_by(token.text) != "UNTIL" or not starts_value(following):
                return None
            fix = head_in(WORDS["UNTIL"], self.inside(self.i + 1))
            self.report(problems.OTHER_LANGUAGE, token.span, found=token.text, right="UNTIL",
                        fix=fix)  # fmt: skip
        self.i += 1
        until = Token(WORD, "UNTIL", *self.tokens[self.i - 1].span)
        return self.one_argument(until, is_told=token.text != "UNTIL")
