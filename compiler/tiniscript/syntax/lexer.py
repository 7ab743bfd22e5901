"""The lexer: text becomes tokens.

Knows characters. Knows no word of the language and no grammar. Text outside the language becomes an
odd token, which no rule of the grammar accepts.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

from tiniscript.base.source import SPACES, Span
from tiniscript.diagnostics.codes import Diagnostic

WORD = "word"
NUMBER = "number"
NEWLINE = "newline"
END = "end"
UNKNOWN_SIGN = "odd"

DASHES = "\u2010\u2011\u2012\u2013\u2014\u2015\u2212"
DEGREES = "°º"  # signs for DEG
QUOTES = "\"'`´‘’‚‛“”„‟«»"  # quotation marks of all keyboards; none belongs to the language


class Token(NamedTuple):
    """`kind` is one of the constants above, or the sign itself; words are in capitals."""

    kind: str
    text: str
    start: int
    end: int

    @property
    def span(self) -> Span:
        return Span(self.start, self.end)


class Scan(NamedTuple):
    """`diagnostics` are of the checksums of lines."""

    tokens: list[Token]  # the last one is END
    comments: list[Token]
    diagnostics: Sequence[Diagnostic]


_PATTERN = re.compile(
    rf"""
        (?P<space>[{SPACES}]+) | (?P<dash>[{DASHES}])
      | (?P<word>[A-Za-z][A-Za-z0-9_]*)(?![^\Wº]) | (?P<degrees>[{DEGREES}](?!\w))
    """
    r"""
      | (?P<comment>//[^\r\n]*)
      | (?P<sign><=|>=|<>|[-+*/%=<>(),;|])
      | (?P<number>(?:[0-9]+(?:\.[0-9]+)?|\.[0-9]+)(?=(?:[Cc][Mm]|[Dd][Ee][Gg]|º)\b|(?![\w.])))
      | (?P<newline>\r\n|\n|\r)
      | (?P<odd>\.?[0-9][\w.]*|\w+|~[0-9A-Fa-f]*|.)
    """,
    re.VERBOSE | re.DOTALL,
)
# Fixed spellings.
_FIXED_TOKENS = {"newline": (NEWLINE, "\n"), "degrees": (WORD, "DEG"), "dash": ("-", "-")}


def scan(text: str) -> Scan:
    """Return the tokens of a text, its comments, and its checksums that do not fit."""
    tokens: list[Token] = []
    comments: list[Token] = []
    wrong_checksums: Sequence[Diagnostic] = ()
    if "~" in text:
        from tiniscript.syntax.checksums import without_checksums  # few texts have any

        text, wrong_checksums = without_checksums(text)
    add = tokens.append
    new_token = tuple.__new__  # takes half the time of Token()
    for match in _PATTERN.finditer(text):
        group = match.lastgroup
        if group == "space":
            continue
        start, end = match.span()
        if group == "word":
            add(new_token(Token, (WORD, match.group().upper(), start, end)))
        elif group == "sign":
            sign = match.group()
            add(new_token(Token, (sign, sign, start, end)))
        elif group == "number":
            add(new_token(Token, (NUMBER, match.group(), start, end)))
        elif group == "comment":
            comments.append(Token("comment", match.group(), start, end))
        else:
            kind, token_text = _FIXED_TOKENS.get(group or "", (UNKNOWN_SIGN, match.group()))
            add(new_token(Token, (kind, token_text, start, end)))
    add(Token(END, "", len(text), len(text)))
    return Scan(tokens, comments, wrong_checksums)
