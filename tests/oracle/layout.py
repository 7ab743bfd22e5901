"""Lays a program out as a person might: lines, spaces, comments, small letters, checksums."""

from __future__ import annotations

import itertools
import random
import zlib

from tests.oracle.author_values import Tokens

COMMENTS = ("", " go", " F(1, 50); S", " ¿qué? (ñandú)", " )", " // again", " SI|", "\ttab | ; (")


class Layout:
    """Turns instructions into text, with one style for the whole of it."""

    def __init__(self, rng: random.Random) -> None:
        self.rng = rng
        self.case = rng.choice(("upper", "upper", "lower", "any"))
        self.gaps = rng.choice(("tight", "normal", "normal", "wild"))
        self.ends = rng.choice(("one line", "lines", "both", "mixed"))
        self.indent = rng.choice(("", "  ", "\t"))
        self.newline = rng.choice(("\n", "\n", "\r\n"))

    def comment(self) -> str:
        return f"//{self.rng.choice(COMMENTS)}{self.newline}"

    def word(self, token: str) -> str:
        """A token in the case of the style."""
        if self.case == "upper":
            return token
        if self.case == "lower":
            return token.lower()
        return "".join(self.rng.choice((c.upper(), c.lower())) for c in token)

    def gap(self, left: str, right: str, is_in_parentheses: bool) -> str:
        """Return the text between two tokens of an instruction."""
        rng = self.rng
        has_words = left[-1] not in "(),=<>+-*/%" and right[0] not in "(),=<>+-*/%"
        if self.ends != "one line" and is_in_parentheses and rng.random() < 0.02:
            return f" {self.newline}  " if rng.random() < 0.7 else f" {self.comment()}"
        if self.gaps == "wild":
            space = rng.choice(("", " ", "  ", "\t", "\u00a0", ""))
        elif self.gaps == "normal":
            is_bare = left in "()" or right in "(),"
            space = "" if is_bare and right != "UNTIL" else " "
        else:
            space = ""
        return " " if has_words and not space else space

    def instruction(self, tokens: Tokens) -> str:
        text, depth = self.word(tokens[0]), 0
        for left, right in itertools.pairwise(tokens):
            depth += {"(": 1, ")": -1}.get(left, 0)
            text += self.gap(left, right, depth > 0) + self.word(right)
        return text

    def end(self) -> str:
        """Return the end of an instruction: at least one ; or line end, and perhaps empty ones."""
        rng = self.rng
        if self.ends == "one line":
            return rng.choice((";", ";", ";", "; ", ";;" if rng.random() < 0.1 else ";"))
        line = f" {self.comment()}" if rng.random() < 0.06 else self.newline
        line += self.newline if rng.random() < 0.05 else ""
        line += self.comment() if rng.random() < 0.04 else ""
        line += self.indent
        if self.ends == "lines":
            return line
        if self.ends == "both":
            return f";{line}"
        return rng.choice((";", "; ", f";{line}", line, line))

    def program(self, page: list[Tokens]) -> str:
        rng = self.rng
        setup = rng.choice(("", "", "SI|", "SB|"))
        if setup:
            setup = self.word(setup)
            setup += rng.choice(("", "", " ", "" if self.ends == "one line" else self.newline))
        text = setup
        for tokens in page:
            text += self.instruction(tokens) + self.end()
        if rng.random() < 0.5:
            text = text.rstrip(" ;\t\r\n\u00a0")
        if rng.random() < 0.1:
            text = self.newline.join(map(self.add_checksum, text.split(self.newline)))
        return ("\ufeff" if rng.random() < 0.03 else "") + text

    def add_checksum(self, line: str) -> str:
        """A line with its checksum, or without one."""
        if self.rng.random() < 0.5:
            return line
        digits = f"{zlib.crc32(line.encode()):08x}"
        return f"{line}~{self.rng.choice((digits, digits.upper()))}{self.rng.choice(('', ' '))}"
