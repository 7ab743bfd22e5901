"""Text becomes tokens.

Knows characters. Knows no word of the language and no grammar. What it cannot read it names
as a problem, and goes on with the nearest thing that makes sense.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from tiniscript import problems
from tiniscript.problems import Problem
from tiniscript.source import Span

WORD = "word"
NUMBER = "number"
NEWLINE = "newline"
END = "end"
ODD = "odd"  # already named by a problem; the parser passes it over in silence


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
    problems: list[Problem]


_PATTERN = re.compile(
    r"""(?P<space>[ \t\f\v\u00a0\u2000-\u200b\u202f\u3000\ufeff]+)
      | (?P<word>[A-Za-z][A-Za-z0-9_]*)(?!\w)
      | (?P<number>(?:[0-9]+(?:\.[0-9]+)?|\.[0-9]+)(?![\w.]))
      | (?P<newline>\r\n|\n|\r)
      | (?P<comment>//[^\r\n]*)
      | (?P<slip>==|!=|=>|=<|><|&&|\|\||!|[\u2264\u2265\u2260\u00d7\u00f7])
      | (?P<sign><=|>=|<>|[-+*/%=<>(),;|])
      | (?P<dash>[\u2010-\u2015\u2212])
      | (?P<badnumber>\.?[0-9][\w.]*)
      | (?P<badword>\w+)
      | (?P<quote>["'`\u00b4\u2018-\u201f\u00ab\u00bb]+)
      | (?P<hash>\#[^\r\n]*)
      | (?P<odd>.)
    """,
    re.VERBOSE | re.DOTALL,
)

# What people write, and what the language writes.
_SLIPS = {
    "==": "=", "!=": "<>", "=>": ">=", "=<": "<=", "><": "<>", "&&": "AND", "||": "OR",
    "!": "NOT", "≤": "<=", "≥": ">=", "≠": "<>", "×": "*", "÷": "/",
}  # fmt: skip


def scan(text: str) -> Scan:
    """Return the tokens of `text`, its comments and what could not be read."""
    tokens: list[Token] = []
    comments: list[Token] = []
    found: list[Problem] = []
    add = tokens.append
    for match in _PATTERN.finditer(text):
        group = match.lastgroup
        if group == "space":
            continue
        start, end = match.span()
        if group == "word":
            add(Token(WORD, match.group().upper(), start, end))
        elif group == "sign":
            sign = match.group()
            add(Token(sign, sign, start, end))
        elif group == "number":
            add(Token(NUMBER, match.group(), start, end))
        elif group == "newline":
            add(Token(NEWLINE, "\n", start, end))
        elif group == "dash":
            add(Token("-", "-", start, end))
        elif group == "comment":
            comments.append(Token("comment", match.group(), start, end))
        else:
            assert group is not None
            add(_odd(group, match.group(), start, end, found))
    add(Token(END, "", len(text), len(text)))
    return Scan(tokens, comments, found)


def _odd(group: str, text: str, start: int, end: int, found: list[Problem]) -> Token:
    """Name what is wrong with `text` and return the token to go on with."""
    span = Span(start, end)
    if group == "slip":
        right = _SLIPS[text]
        found.append(Problem(problems.OTHER_SIGN, span, {"found": text, "right": right}))
        return Token(WORD if right.isalpha() else right, right, start, end)
    if group == "badnumber":
        found.append(Problem(problems.BAD_NUMBER, span, {"found": text, "right": _number_in(text)}))
        return Token(NUMBER, _number_in(text), start, end)
    if group == "badword":
        plain = _plain(text)
        found.append(Problem(problems.BAD_NAME, span, {"found": text, "right": plain}))
        return Token(WORD, plain.upper(), start, end)
    if group == "quote":
        found.append(Problem(problems.QUOTE, span, {"found": text}))
    elif group == "hash":
        comment = "//" + text[1:]
        found.append(Problem(problems.HASH_COMMENT, span, {"right": comment[:40]}))
    elif not found or found[-1].code is not problems.ODD_CHARACTER or found[-1].span.end != start:
        shown = text if text.isprintable() else f"U+{ord(text):04X}"
        found.append(Problem(problems.ODD_CHARACTER, span, {"found": shown}))
    else:  # one problem for a run of them
        found[-1] = found[-1]._replace(span=Span(found[-1].span.start, end))
    return Token(ODD, text, start, end)


def _number_in(text: str) -> str:
    """Return the number that was probably meant: `5` for `5.`, `1.2` for `1.2.3`, `2` for `2X`."""
    match = re.match(r"[0-9]*(?:\.[0-9]+)?", text)
    return match.group()[:40] if match and match.group() else "0"


def _plain(text: str) -> str:
    """Return the nearest name in plain letters: `ANO` for `AÑO`, `PASOS` for `_PASOS`."""
    from unicodedata import normalize

    letters = normalize("NFD", text).encode("ascii", "ignore").decode()
    plain = re.sub(r"^[^A-Za-z]+|\W", "", letters)
    return plain or "X"
