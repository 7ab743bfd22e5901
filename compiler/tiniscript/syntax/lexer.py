"""The lexer: text becomes tokens.

Knows characters. Knows no word of the language and no grammar. A text that it cannot read, or that
has a checksum, is for `lexer_recovery`, which right programs never load.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import NamedTuple

from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.source import Span

WORD = "word"
NUMBER = "number"
NEWLINE = "newline"
END = "end"
ODD = "odd"  # reported already; the parser passes it over in silence


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
    tokens: list[Token]  # the last one is END
    comments: list[Token]
    diagnostics: list[Diagnostic]


QUOTES = "\"'`´‘’‚‛“”„‟«»"

# What right programs are made of. `lexer_recovery` gets what it may read in another way: signs that
# become one with their neighbours, `50%` as a value, `1 000`, tags of HTML.
_PATTERN = re.compile(
    r"""(?P<space>[ \t]+)
      | (?P<word>[A-Za-z][A-Za-z0-9_]*)(?![\w.])
      | (?P<sign>[-+*(),;] | (?:[<>]=|<>|=)(?![ ]*[<>=)]) | <(?![ ]*[<>=/]|[A-Za-z][^<>\r\n]*>)
            | >(?![ ]*[<>=]) | %(?![ ]*[,)]) | /(?![*/]) | \|(?!\|))
      | (?P<number>(?:[0-9]+(?:\.[0-9]+)?|\.[0-9]+)(?![\w.]|[ ][0-9.]))
      | (?P<newline>\r\n|\n|\r)
      | (?P<comment>//[^\r\n]*)
      | (?P<other>.)
    """,
    re.VERBOSE | re.DOTALL,
)


def lexed(text: str) -> Scan | None:
    """Return the tokens of `text` and its comments, or None where something cannot be read."""
    tokens: list[Token] = []
    comments: list[Token] = []
    if "~" not in text and read(_PATTERN, text, tokens, comments):
        return Scan(tokens, comments, [])
    return None


def read(
    pattern: re.Pattern[str],
    text: str,
    tokens: list[Token],
    comments: list[Token],
    repair: Callable[[re.Match[str], list[Token]], None] | None = None,
) -> bool:
    """Add the tokens and comments of `text`; `repair` adds those of what cannot be read.

    Without it reading ends there, and the answer is no.
    """
    add = tokens.append
    new = tuple.__new__  # in half the time of Token()
    for match in pattern.finditer(text):
        group = match.lastgroup
        if group == "space":
            continue
        start, end = match.span()
        if group == "word":
            add(new(Token, (WORD, match.group().upper(), start, end)))
        elif group == "sign":
            sign = match.group()
            add(new(Token, (sign, sign, start, end)))
        elif group == "number":
            add(new(Token, (NUMBER, match.group(), start, end)))
        elif group == "newline":
            add(new(Token, (NEWLINE, "\n", start, end)))
        elif group == "comment":
            comments.append(Token("comment", match.group(), start, end))
        elif repair is None:
            return False
        else:
            repair(match, tokens)
    add(Token(END, "", len(text), len(text)))
    return True
