"""Cuts the text of a program into words, numbers and signs."""

from __future__ import annotations

import re
import zlib
from itertools import pairwise
from typing import NamedTuple

from tests.oracle.words import FIXED_WORDS, Mistake


class Token(NamedTuple):
    """A word (in capitals), number, symbol, newline, or the end of the text."""

    kind: str
    text: str
    line: int


_TOKEN = re.compile(
    r"""(?P<space>[ \t\u00a0\u202f]+|//[^\n]*)
      | (?P<newline>\n)
      | (?P<number>(?:[0-9]+(?:\.[0-9]+)?|\.[0-9]+)
            (?=(?i:cm|deg)(?![A-Za-z0-9_])|(?![A-Za-z0-9_.])))
      | (?P<degrees>[°º])
      | (?P<word>[A-Za-z][A-Za-z0-9_]*)
      | (?P<symbol><=|>=|<>|[-+*/%=<>(),;|])""",
    re.VERBOSE,
)


def without_checksum(line: str) -> str:
    """A line without the checksum at its first ~, if there is one; it must fit."""
    text_before, _, text_after = line.partition("~")
    digits = text_after.rstrip(" \t\u00a0\u202f")
    if not re.fullmatch(r"[0-9A-Fa-f]{8}", digits):
        return line
    if int(digits, 16) != zlib.crc32(text_before.encode()):
        raise Mistake(f"{line!r} does not fit its checksum")
    return text_before


def tokens_of(text: str) -> list[Token]:
    """Cuts a text into tokens; an end of line inside parentheses is white space."""
    text = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")
    text = "\n".join(map(without_checksum, text.split("\n")))
    tokens: list[Token] = []
    line, depth, position = 1, 0, 0
    while position < len(text):
        match = _TOKEN.match(text, position)
        if match is None:
            raise Mistake(f"line {line}: {text[position]!r} is not understood")
        kind, word = str(match.lastgroup), match.group().upper()
        position = match.end()
        if kind == "symbol" and word in "()":
            depth = max(0, depth + (1 if word == "(" else -1))
        if word == ";" and depth > 0:
            raise Mistake(f"line {line}: a ; inside parentheses")
        if kind == "degrees":
            kind, word = "word", "DEG"
        if word in FIXED_WORDS:
            names, meaning = FIXED_WORDS[word]
            values, position = _read_values(text, position, len(names)) if names else ([], position)
            for token in tokens_of(meaning)[:-1]:
                replacements = dict(zip(names, values, strict=True)).get(token.text, [token])
                tokens += (replacement._replace(line=line) for replacement in replacements)
        elif kind != "space" and not (kind == "newline" and depth > 0):
            tokens.append(Token(kind, word, line))
        if kind == "newline":
            line += 1
    tokens.append(Token("end", "", line))
    return tokens


def _read_values(text: str, position: int, count: int) -> tuple[list[list[Token]], int]:
    """The tokens of each value in the brackets that begin here, and where these end."""
    match = re.compile(r"\s*\(").match(text, position)
    if match is None:
        raise Mistake("a word without its values")
    begin = end = match.end()
    depth, argument_ends = 1, [begin - 1]
    while depth:
        if end == len(text):
            raise Mistake("brackets without an end")
        depth += (text[end] == "(") - (text[end] == ")")
        if depth == 0 or (depth == 1 and text[end] == ","):
            argument_ends.append(end)
        end += 1
    if len(argument_ends) != count + 1:
        raise Mistake("another number of values")
    return [tokens_of(text[a + 1 : b])[:-1] for a, b in pairwise(argument_ends)], end


def thousandths(text: str) -> int:
    """The value of a literal, rounded half away from zero; it may be out of range."""
    whole_part, _, decimals = text.partition(".")
    whole_part = whole_part.lstrip("0")
    if len(whole_part) > 10:
        return 10**13  # out of range anyhow
    value = int(whole_part or "0") * 1000 + int((decimals + "000")[:3])
    return value + (1 if len(decimals) > 3 and decimals[3] >= "5" else 0)
