"""Blocks in curly brackets, written with the words of the language.

Knows which word ends the block that a bracket begins. Gives up where one belongs to no block.
"""

from __future__ import annotations

from collections.abc import Sequence

from tiniscript.source import Edit, Span
from tiniscript.syntax.cursor import AT_END
from tiniscript.syntax.lexer import NEWLINE, Token
from tiniscript.syntax.parser import scan
from tiniscript.syntax.suggestions import foreign_block
from tiniscript.words import ALIASES, BLOCK_ENDS, WORDS

_ARMS = ("ELSE", "ELSEIF")


def without_braces(text: str) -> list[Edit] | None:
    """Return the changes that write all blocks of a text without curly brackets, or None."""
    tokens = scan(text).tokens
    edits: list[Edit] = []
    opened: list[str] = []
    for k, token in enumerate(tokens):
        if token.kind == "{":
            word = _header(tokens, k)
            word = "" if word is None and _is_alone(tokens, k) else word
            if word is None:
                return None
            opened.append("IF" if word in _ARMS else word)
            after = tokens[k + 1].kind
            is_own_line = k == 0 or tokens[k - 1].kind is NEWLINE
            new = "" if is_own_line or after in ("}", *AT_END) else "; "
            edits.append(_replaced(text, tokens, k, new))
        elif token.kind == "}":
            if not opened:
                return None
            word = opened.pop()
            if _goes_on(tokens, k):
                is_alone = tokens[k - 1].kind in (NEWLINE, ";", "{") or k == 0
                edits.append(_replaced(text, tokens, k, "" if is_alone else ";"))
                continue
            is_gone = not word or _says(tokens, k, BLOCK_ENDS[word])
            edits.append(_gone(tokens, k) if is_gone else _ended(tokens, k, BLOCK_ENDS[word]))
    return None if opened else edits


def _header(tokens: Sequence[Token], brace: int) -> str | None:
    """Return the word of the block that a bracket begins."""
    k = brace
    while k and tokens[k - 1].kind in (NEWLINE, ";"):  # on a line of its own
        k -= 1
    while k and tokens[k - 1].kind not in (NEWLINE, ";", "{", "}", "|"):
        k -= 1
    first = tokens[k].text
    word = first if first in WORDS else foreign_block(first)
    return word if word in BLOCK_ENDS or word in _ARMS else None


def _is_alone(tokens: Sequence[Token], brace: int) -> bool:
    """Whether a `{` begins the text, or stands behind an instruction that begins no block."""
    k = brace
    while k and tokens[k - 1].kind in (NEWLINE, ";"):
        k -= 1
    if not k or tokens[k - 1].kind == "|":
        return True
    if k == brace:
        return False
    while k and tokens[k - 1].kind not in AT_END:
        k -= 1
    known = WORDS.get(tokens[k].text)
    return known is not None and known.is_instruction


def _says(tokens: Sequence[Token], brace: int, end: str) -> bool:
    """Whether the end of the block stands behind its `}` already."""
    k = brace + 1
    while tokens[k].kind in (NEWLINE, ";"):
        k += 1
    return ALIASES.get(tokens[k].text, tokens[k].text) == end


def _gone(tokens: Sequence[Token], k: int) -> Edit:
    """A `}` that ends no block goes."""
    is_between = tokens[k - 1].kind not in AT_END and tokens[k + 1].kind not in AT_END
    return Edit(tokens[k].span, ";" if is_between else "")


def _goes_on(tokens: Sequence[Token], brace: int) -> bool:
    """Whether an ELSE comes after a `}`: it ends no block then."""
    k = brace + 1
    while tokens[k].kind in (NEWLINE, ";"):
        k += 1
    word = tokens[k].text
    return (word if word in WORDS else foreign_block(word)) in _ARMS


def _replaced(text: str, tokens: Sequence[Token], k: int, new: str) -> Edit:
    """A bracket goes with the spaces around it."""
    start, end = tokens[k].span
    while start and text[start - 1] in " \t" and tokens[k - 1].kind is not NEWLINE:
        start -= 1
    while text[end : end + 1] in (" ", "\t"):
        end += 1
    return Edit(Span(start, end), new)


def _ended(tokens: Sequence[Token], k: int, end: str) -> Edit:
    before = "" if k == 0 or tokens[k - 1].kind in (NEWLINE, ";") else ";"
    after = "" if tokens[k + 1].kind in AT_END else ";"
    return Edit(tokens[k].span, f"{before}{end}{after}")
