"""Packs the texts that a robot says: a byte from 0x80 on stands for two bytes of a table.

Knows letters and pairs, not what the texts say. The pair that saves most is taken first.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from itertools import pairwise

FIRST_PAIR = 0x80
MOST_PAIRS = 0x80
DEEPEST = 3  # pairs in pairs: the robot's stack holds a call for each
LEAST_USES = 3  # a pair takes two bytes and saves one at each use

Pair = tuple[int, int]


def packed(texts: Sequence[str]) -> tuple[list[Pair], list[bytes]]:
    """Return the pairs, and the texts with the codes of the pairs."""
    rows = [list(text.encode("ascii")) for text in texts]
    pairs: list[Pair] = []
    depths: dict[int, int] = {}
    while len(pairs) < MOST_PAIRS:
        uses = Counter(pair for row in rows for pair in _apart(row))
        possible = [
            (count, pair)
            for pair, count in uses.items()
            if count >= LEAST_USES and max(depths.get(each, 0) for each in pair) < DEEPEST
        ]
        if not possible:
            break
        _, pair = max(possible)
        code = FIRST_PAIR + len(pairs)
        depths[code] = 1 + max(depths.get(each, 0) for each in pair)
        pairs.append(pair)
        rows = [_replaced(row, pair, code) for row in rows]
    return pairs, [bytes(row) for row in rows]


def unpacked(text: bytes, pairs: Sequence[Pair]) -> str:
    """Return what a packed text says."""
    letters = list(text)
    while any(letter >= FIRST_PAIR for letter in letters):
        letters = [
            each
            for letter in letters
            for each in (pairs[letter - FIRST_PAIR] if letter >= FIRST_PAIR else (letter,))
        ]
    return bytes(letters).decode("ascii")


def _apart(row: Sequence[int]) -> list[Pair]:
    """Return the pairs of a row; of a letter three times in a row there is one."""
    found: list[Pair] = []
    is_free = True
    for before, pair in pairwise(((-1, -1), *pairwise(row))):
        is_free = not (is_free and pair == before and found)
        if is_free:
            found.append((pair[0], pair[1]))
    return found


def _replaced(row: Sequence[int], pair: Pair, code: int) -> list[int]:
    made: list[int] = []
    for letter in row:
        if made and (made[-1], letter) == pair:
            made[-1] = code
        else:
            made.append(letter)
    return made
