"""Packs the texts that a robot says into codes of 4 and 8 bits.

Knows letters, pairs and halves of bytes, not what the texts say. A code is the end of a text, a
pair of two codes of a table, or a letter in ASCII. The most frequent ones take 4 bits, all others
8. The pair that saves most is taken first.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

END_CODE = 0  # of a text; the pairs are numbered from 1
FIRST_LETTER = 0x20  # the letters of ASCII begin here, and the codes of pairs end
FIRST_COMMON = 8  # a half of a byte from here on is a code of its own
COMMON = 16 - FIRST_COMMON
MOST_NESTED_PAIRS = 3  # pairs in pairs: the robot's stack holds a call for each
LEAST_SAVED = 4  # halves of bytes, of which a pair itself takes 4
ROUND_COUNT = 8  # which codes are common, and which pairs save most, depends on each other

Pair = tuple[int, int]


class Packed(NamedTuple):
    """Texts, one after the other; the codes of 4 bits, and those of which the pairs are made."""

    common: tuple[int, ...]
    pairs: list[Pair]
    texts: bytes

    @property
    def size(self) -> int:
        return len(self.common) + 2 * len(self.pairs) + len(self.texts)


def pack(texts: Sequence[str]) -> Packed:
    """Return the texts in as few bytes as are found."""
    rows = [[*text.encode("ascii"), END_CODE] for text in texts]
    common = _most_common(rows)
    candidates = []
    for _ in range(ROUND_COUNT):
        pairs, shorter = _pair_codes(rows, common)
        candidates.append(Packed(common, pairs, _split_halves(shorter, common)))
        common = _most_common(shorter)
    return min(candidates, key=lambda each: each.size)


def unpack(data: Packed) -> list[str]:
    """Return what packed texts say."""
    halves = [half for byte in data.texts for half in (byte >> 4, byte & 15)]
    texts, text, at = [], bytearray(), 0
    while at < len(halves):
        if halves[at] >= FIRST_COMMON:
            code, at = data.common[halves[at] - FIRST_COMMON], at + 1
        elif at + 1 < len(halves):
            code, at = 16 * halves[at] + halves[at + 1], at + 2
        else:
            break  # the rest of the last byte
        if code == END_CODE:
            texts.append(text.decode("ascii"))
            text = bytearray()
        else:
            text += letters_of(code, data.pairs)
    return texts


def letters_of(code: int, pairs: Sequence[Pair]) -> bytes:
    """Return the letters that a code stands for."""
    letters = [code]
    while any(letter < FIRST_LETTER for letter in letters):
        letters = [
            item
            for letter in letters
            for item in (pairs[letter - 1] if letter < FIRST_LETTER else (letter,))
        ]
    return bytes(letters)


def _most_common(rows: Sequence[Sequence[int]]) -> tuple[int, ...]:
    """Return the end and the most frequent letters, which take 4 bits."""
    uses = Counter(code for row in rows for code in row if code >= FIRST_LETTER)
    commonest_codes = sorted(uses, key=lambda code: (-uses[code], code))[: COMMON - 1]
    return (END_CODE, *sorted(commonest_codes))


def _pair_codes(
    rows: Sequence[Sequence[int]], common: Sequence[int]
) -> tuple[list[Pair], list[list[int]]]:
    """Return pairs, and the texts with their codes."""
    items = [list(row) for row in rows]
    pairs: list[Pair] = []
    depths: dict[int, int] = {}

    def halves(code: int) -> int:
        return 1 if code in common else 2

    while len(pairs) < FIRST_LETTER - 1:
        uses = Counter(pair for row in items for pair in _row_pairs(row) if END_CODE not in pair)
        possible_pairs = [
            (count * (halves(pair[0]) + halves(pair[1]) - 2), pair)
            for pair, count in uses.items()
            if max(depths.get(item, 0) for item in pair) < MOST_NESTED_PAIRS
        ]
        saved, pair = max(possible_pairs, default=(0, (END_CODE, END_CODE)))
        if saved <= LEAST_SAVED:
            break
        code = 1 + len(pairs)
        depths[code] = 1 + max(depths.get(item, 0) for item in pair)
        pairs.append(pair)
        items = [_replace_pair(row, pair, code) for row in items]
    return pairs, items


def _split_halves(rows: Sequence[Sequence[int]], common: Sequence[int]) -> bytes:
    """Return codes as bytes: the high half of each comes first."""
    halves: list[int] = []
    for code in (code for row in rows for code in row):
        halves += [FIRST_COMMON + common.index(code)] if code in common else divmod(code, 16)
    if len(halves) % 2:
        halves.append(0)
    return bytes(16 * high + low for high, low in zip(halves[::2], halves[1::2], strict=True))


def _row_pairs(row: Sequence[int]) -> list[Pair]:
    """Return the pairs of a row; of a letter three times in a row there is one."""
    pairs: list[Pair] = []
    is_free = True
    for before, pair in pairwise(((-1, -1), *pairwise(row))):
        is_free = not (is_free and pair == before and pairs)
        if is_free:
            pairs.append((pair[0], pair[1]))
    return pairs


def _replace_pair(row: Sequence[int], pair: Pair, code: int) -> list[int]:
    result: list[int] = []
    for letter in row:
        if result and (result[-1], letter) == pair:
            result[-1] = code
        else:
            result.append(letter)
    return result
