"""Breaks the text of a program at random."""

from __future__ import annotations

import random
import re

_PIECES = re.compile(r"[A-Za-z0-9_.]+|\s+|.", re.DOTALL)
_NOISE = "~();,|=<>+-*/%._ \n\t'\"#@!?&[]{}0123456789abcEFLWXYZñé¿½"
_WORDS = (
    "IF", "ELSE", "ELSEIF", "ENDIF", "LOOP", "END_LOOP", "WHILE", "END_WHILE", "BREAK", "DEF",
    "END_DEF", "UNTIL", "FOREVER", "SI", "SB", "|", "PING", "TRUE", "AND", "NOT", "X", "DISTANCE",
    "TIME", "5", "100.4", "2147483.648", "-", "RANDOM", "(", ")", ",", ";", "\n", "TASK",
    "KEY_A", "PAD_X",
)  # fmt: skip


def break_text(rng: random.Random, text: str) -> str:
    """The text with a few pieces lost, doubled, swapped or replaced, or with stray characters."""
    pieces = _PIECES.findall(text)
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        index = rng.randrange(len(pieces) + 1)
        kind = rng.randrange(7)
        if kind == 0 or index == len(pieces):
            pieces.insert(index, rng.choice(_NOISE))
        elif kind == 1:
            del pieces[index]
        elif kind == 2:
            pieces.insert(index, pieces[index])
        elif kind == 3:
            other_index = rng.randrange(len(pieces))
            pieces[index], pieces[other_index] = pieces[other_index], pieces[index]
        elif kind == 4:
            pieces[index] = rng.choice(_WORDS)
        elif kind == 5:
            pieces.insert(index, rng.choice(_WORDS))
        else:
            cut = rng.randrange(len(pieces[index]) + 1)
            pieces[index] = pieces[index][:cut] + rng.choice(_NOISE) + pieces[index][cut + 1 :]
    return "".join(pieces)
