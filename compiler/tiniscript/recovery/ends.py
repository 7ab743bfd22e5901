"""Possible ends of a one-line block without an end: after one of its instructions."""

from __future__ import annotations

from collections.abc import Sequence

from tiniscript.base.words import BLOCK_ENDS
from tiniscript.recovery.meanings import Lexeme, texts
from tiniscript.recovery.slips import instructions
from tiniscript.recovery.writing import format_line
from tiniscript.syntax.blocks import WORD_OF_END

_MAX_CANDIDATES = 4  # the last of these places is always valid
_ARMS = ("ELSE", "ELSEIF")
_ENDLESS_CONDITIONS = (("(", "FOREVER", ")"), ("(", "TRUE", ")"))


def possible_last_instructions(tokens: Sequence[Lexeme]) -> list[str]:
    """Return the instructions after which the block may end that these tokens begin, in order.

    Instructions after an endless loop never run, so it ends after all of them.
    """
    header, *instructions_inside = instructions(tokens)
    candidates: list[str] = []
    depth = 0
    for instruction in instructions_inside:
        word = instruction[0].text if instruction else ""
        depth += word in BLOCK_ENDS
        if word in WORD_OF_END:
            if not depth:
                break  # the end belongs to an outer block
            depth -= 1
        if word in _ARMS and not depth:
            candidates = []  # the block ends in its last branch
        elif instruction and not depth:
            candidates.append(format_line(instruction))
    is_endless = texts(header[1:]) in _ENDLESS_CONDITIONS
    return candidates[-1:] if is_endless else candidates


def candidates_text(candidates: Sequence[str]) -> str:
    """Return places for a message, or "" for a single one, which is certain."""
    if len(candidates) < 2:
        return ""
    shown_lines = (
        [*candidates[: _MAX_CANDIDATES - 1], "...", candidates[-1]]
        if len(candidates) > _MAX_CANDIDATES
        else candidates
    )
    return ", ".join(shown_lines)


def added_end_index(old_tokens: Sequence[Lexeme], new_tokens: Sequence[Lexeme]) -> int | None:
    """Return the index of the first end that only the repaired tokens have, or None."""
    texts_left = list(texts(old_tokens))
    for k, word in enumerate(texts(new_tokens)):
        if word in texts_left:
            del texts_left[: texts_left.index(word) + 1]
        elif word in WORD_OF_END:
            return k
    return None


def header_index(tokens: Sequence[Lexeme], end: int) -> int:
    """Return the start of the block that ends at a token."""
    depth = 0
    for k in range(end, -1, -1):
        depth += (tokens[k].text in WORD_OF_END) - (tokens[k].text in BLOCK_ENDS)
        if tokens[k].text in BLOCK_ENDS and not depth:
            return k
    return 0
