"""The ends and arms further down that belong to blocks that begin before.

Knows the words that begin and end a block, here and elsewhere. Reports nothing.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from tiniscript.syntax.blocks import ENDS
from tiniscript.syntax.lexer import NEWLINE, WORD, Token
from tiniscript.syntax.phrases import ENDS_OF_ANY
from tiniscript.syntax.suggestions import foreign_block
from tiniscript.words import BLOCK_ENDS, WORDS

ARMS = ("ELSE", "ELSEIF")
ANY = "END"  # an end that names no block
_FARTHEST = 1000  # tokens in which the end of a block is looked for


def ends_behind(tokens: Sequence[Token], start: int) -> Iterator[str]:
    """Give what ends or divides blocks that are open at `start`: IF for ENDIF, ELSE, ANY."""
    inner = 0
    is_first = True
    for k in range(start, min(len(tokens) - 1, start + _FARTHEST)):
        token = tokens[k]
        if is_first and token.kind is WORD:
            word = _said(tokens, k)
            is_if = token.text == "SI" and word not in ARMS and tokens[k + 1].kind != "|"
            if word in BLOCK_ENDS or is_if:
                inner += 1
            elif word in ENDS or token.text in ENDS_OF_ANY or word in ARMS:
                if not inner:
                    yield word if word in ARMS else ENDS.get(word, ANY)
                elif word not in ARMS:
                    inner -= 1
        elif token.kind == "}":
            inner = max(0, inner - 1)
        is_first = token.kind in (NEWLINE, ";", "{", "}")


def comes_later(word: str, around: Sequence[str], tokens: Sequence[Token], start: int) -> bool:
    """Whether the end of a block of `word` that is open at `start` follows, at any distance.

    `around` are the words of the blocks around it, which need their ends, too.
    """
    ends = [each for each in ends_behind(tokens, start) if each not in ARMS]
    if not ends or ends[0] not in (word, ANY):
        return False
    if ANY in ends:
        return len(ends) > len(around)
    return ends.count(word) > around.count(word)


def arm_at(tokens: Sequence[Token], k: int) -> bool:
    """Whether ELSE or ELSEIF is the first word at `k`, or behind separators."""
    while tokens[k].kind in (NEWLINE, ";"):
        k += 1
    return tokens[k].kind is WORD and _said(tokens, k) in ARMS


def _said(tokens: Sequence[Token], k: int) -> str:
    """Return the word of a block that stands at `k`, in our language; or the word itself."""
    text = tokens[k].text
    if text == "SI" and tokens[k + 1].text == "NO":
        return "ELSE"
    return text if text in WORDS else foreign_block(text) or text
