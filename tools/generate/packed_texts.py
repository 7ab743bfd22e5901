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

END_CODE = 0  # code that ends a text; pairs are numbered from 1
FIRST_LETTER = 0x20  # the letters of ASCII begin here, and the codes of pairs end
FIRST_COMMON = 8  # a half of a byte from here on is a code of its own
COMMON_COUNT = 16 - FIRST_COMMON
MAX_NESTED_PAIRS = 3  # pairs in pairs: the robot's stack holds a call for each
MIN_SAVED = 4  # half bytes, of which a pair itself takes 4
ROUND_COUNT = 8  # rounds of choosing codes and pairs, which depend on each other

Pair = tuple[int, int]


class PackedTexts(NamedTuple):
    """Texts, one after the other; the 4-bit codes, and the pairs made of them."""

    common: tuple[int, ...]
    pairs: list[Pair]
    texts: bytes

    @property
    def size(self) -> int:
        return len(self.common) + 2 * len(self.pairs) + len(self.texts)


def pack_texts(texts: Sequence[str]) -> PackedTexts:
    """Return the texts in as few bytes as are found."""
    rows = [[*text.encode("ascii"), END_CODE] for text in texts]
    common_codes = _most_common(rows)
    candidates = []
    for _ in range(ROUND_COUNT):
        pairs, shorter = _pair_codes(rows, common_codes)
        candidates.append(PackedTexts(common_codes, pairs, _split_halves(shorter, common_codes)))
        common_codes = _most_common(shorter)
    return min(candidates, key=lambda packed_texts: packed_texts.size)


def unpack_texts(data: PackedTexts) -> list[str]:
    """Return the texts of packed data."""
    halves = [half for byte in data.texts for half in (byte >> 4, byte & 15)]
    texts, text, index = [], bytearray(), 0
    while index < len(halves):
        if halves[index] >= FIRST_COMMON:
            code, index = data.common[halves[index] - FIRST_COMMON], index + 1
        elif index + 1 < len(halves):
            code, index = 16 * halves[index] + halves[index + 1], index + 2
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
            new_letter
            for letter in letters
            for new_letter in (pairs[letter - 1] if letter < FIRST_LETTER else (letter,))
        ]
    return bytes(letters)


def _most_common(rows: Sequence[Sequence[int]]) -> tuple[int, ...]:
    """Return the end and the most frequent letters, which take 4 bits."""
    uses = Counter(code for row in rows for code in row if code >= FIRST_LETTER)
    commonest_codes = sorted(uses, key=lambda code: (-uses[code], code))[: COMMON_COUNT - 1]
    return (END_CODE, *sorted(commonest_codes))


def _pair_codes(
    rows: Sequence[Sequence[int]], common_codes: Sequence[int]
) -> tuple[list[Pair], list[list[int]]]:
    """Return pairs, and the texts with their codes."""
    new_rows = [list(row) for row in rows]
    pairs: list[Pair] = []
    depths: dict[int, int] = {}

    def halves(code: int) -> int:
        return 1 if code in common_codes else 2

    while len(pairs) < FIRST_LETTER - 1:
        uses = Counter(pair for row in new_rows for pair in _row_pairs(row) if END_CODE not in pair)
        possible_pairs = [
            (count * (halves(pair[0]) + halves(pair[1]) - 2), pair)
            for pair, count in uses.items()
            if max(depths.get(part, 0) for part in pair) < MAX_NESTED_PAIRS
        ]
        saved_halves, pair = max(possible_pairs, default=(0, (END_CODE, END_CODE)))
        if saved_halves <= MIN_SAVED:
            break
        code = 1 + len(pairs)
        depths[code] = 1 + max(depths.get(part, 0) for part in pair)
        pairs.append(pair)
        new_rows = [_replace_pair(row, pair, code) for row in new_rows]
    return pairs, new_rows


def _split_halves(rows: Sequence[Sequence[int]], common_codes: Sequence[int]) -> bytes:
    """Return codes as bytes: the high half of each comes first."""
    halves: list[int] = []
    for code in (code for row in rows for code in row):
        halves += (
            [FIRST_COMMON + common_codes.index(code)] if code in common_codes else divmod(code, 16)
        )
    if len(halves) % 2:
        halves.append(0)
    return bytes(16 * high + low for high, low in zip(halves[::2], halves[1::2], strict=True))


def _row_pairs(row: Sequence[int]) -> list[Pair]:
    """Return the pairs of a row; of a letter three times in a row there is one."""
    pairs: list[Pair] = []
    is_free = True
    for previous_pair, pair in pairwise(((-1, -1), *pairwise(row))):
        is_free = not (is_free and pair == previous_pair and pairs)
        if is_free:
            pairs.append((pair[0], pair[1]))
    return pairs


def _replace_pair(row: Sequence[int], pair: Pair, code: int) -> list[int]:
    codes: list[int] = []
    for code_in_row in row:
        if codes and (codes[-1], code_in_row) == pair:
            codes[-1] = code
        else:
            codes.append(code_in_row)
    return codes
