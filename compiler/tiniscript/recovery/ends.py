"""Where a block of one line may end that lacks its end: after one of its instructions."""

from __future__ import annotations

from collections.abc import Sequence

from tiniscript.base.words import BLOCK_ENDS
from tiniscript.recovery.meanings import WORD_OF_END, Lexeme, texts
from tiniscript.recovery.slips import instructions
from tiniscript.recovery.writing import laid_out

_MOST_PLACES = 4  # places, of which the last is always one
_ARMS = ("ELSE", "ELSEIF")
_ENDLESS_CONDITIONS = (("(", "FOREVER", ")"), ("(", "TRUE", ")"))


def possible_places(tokens: Sequence[Lexeme]) -> list[str]:
    """Return the instructions after which the block may end that these tokens begin, in order.

    What comes after an endless loop is never done: that ends after all of them.
    """
    header, *inside = instructions(tokens)
    places: list[str] = []
    depth = 0
    for item in inside:
        word = item[0].text if item else ""
        depth += word in BLOCK_ENDS
        if word in WORD_OF_END:
            if not depth:
                break  # of a block around it
            depth -= 1
        if word in _ARMS and not depth:
            places = []  # it ends in its last branch
        elif item and not depth:
            places.append(laid_out(item))
    is_endless = texts(header[1:]) in _ENDLESS_CONDITIONS
    return places[-1:] if is_endless else places


def places_text(places: Sequence[str]) -> str:
    """Return places for a message, nothing for one alone: that is no guess."""
    if len(places) < 2:
        return ""
    parts = (
        [*places[: _MOST_PLACES - 1], "...", places[-1]] if len(places) > _MOST_PLACES else places
    )
    return ", ".join(parts)


def added_end(before: Sequence[Lexeme], after: Sequence[Lexeme]) -> int | None:
    """Return where the first end is that only the repaired tokens have, None for none."""
    texts_left = list(texts(before))
    for k, word in enumerate(texts(after)):
        if word in texts_left:
            del texts_left[: texts_left.index(word) + 1]
        elif word in WORD_OF_END:
            return k
    return None


def header_of(tokens: Sequence[Lexeme], end: int) -> int:
    """Return where the block begins that ends at a token."""
    depth = 0
    for k in range(end, -1, -1):
        depth += (tokens[k].text in WORD_OF_END) - (tokens[k].text in BLOCK_ENDS)
        if tokens[k].text in BLOCK_ENDS and not depth:
            return k
    return 0
