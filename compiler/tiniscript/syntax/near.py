"""Reads a question for something near: `si hay una pared`, `if there is a wall`.

Knows that what a robot measures is how far something is. Reports nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from tiniscript.syntax.lexer import NUMBER, ODD, WORD, Token
from tiniscript.syntax.phrases import WAYS
from tiniscript.syntax.vocabulary import Vocabulary
from tiniscript.words import NEAR_WORDS

ASKING = frozenset(("IF", "ELSEIF", "WHILE", "UNTIL"))
# What stands around what the robot sees: `si el robot ve una pared`.
_THERE_IS = frozenset(
    "HAY HAYA UN UNA EL LA DE THE THERE IS A AN ROBOT ESTA CLOSE TO".split()  # noqa: SIM905
    + "QUE YOU IT VE VES VEA VEAS SEE SEES DETECTA DETECTAS DETECTS ENCUENTRA".split()  # noqa: SIM905
)
_AHEAD = frozenset(("ADELANTE", "AHEAD", "ENFRENTE"))


class Near(NamedTuple):
    question: str
    end: int  # among the tokens


def near_at(tokens: Sequence[Token], start: int, known: Vocabulary) -> Near | None:
    """Return the question that the words from `start` on ask, None where they ask another one.

    Where something is, but ahead, no kit's DISTANCE says.
    """
    end, is_near, is_not = start, False, False
    while tokens[end].kind is WORD:
        text = tokens[end].text
        is_ahead = is_near and text in _AHEAD and tokens[end + 1].kind is not NUMBER
        if not (is_ahead or text in NEAR_WORDS or text in _THERE_IS or text in ("NO", "NOT")):
            break
        is_near |= text in NEAR_WORDS
        is_not |= text in ("NO", "NOT")
        end += 1
    after = tokens[end]
    if not is_near or not known.is_number("DISTANCE"):
        return None
    if any(known.is_own(token.text) for token in tokens[start:end]):
        return None
    is_odd = after.kind is ODD and after.text not in (":", ".")
    if after.text in WAYS or is_odd or after.kind in (NUMBER, "(", ")"):
        return None
    return Near("DISTANCE > 10" if is_not else "DISTANCE < 10", end)
