"""Finds the word that a misspelt one was meant to be, as children spell.

Knows how Spanish sounds: who writes `ABANZA` means AVANZA. Knows no word: who asks brings them.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

_ALIKE = 4  # letters that a word needs where only its sound is the same
_SWAPPED = 5  # … where two neighbours are exchanged
_SLIPPED = 6  # … where a letter is wrong, missing or too much
_LONGEST = 24

# What sounds the same in Lima: the sign on the right stands for all that is on the left.
_SOUNDS = tuple(
    (re.compile(pattern), sound)
    for pattern, sound in (
        ("CH", "9"), ("SH", "9"), ("X", "9"), ("H", ""), ("QU(?=[EI])", "K"), ("C(?=[EI])", "S"),
        ("[CQ]", "K"), ("Z", "S"), ("V", "B"), ("LL", "Y"), ("G(?=[EI])", "J"), (r"(.)\1", r"\1"),
    )
)  # fmt: skip


class Speller:
    """The words that are looked for. A lookup takes the same time however many they are."""

    def __init__(self, words: Iterable[str]) -> None:
        self._by_sound: dict[str, str] = {}
        self._by_rest: dict[str, list[str]] = {}
        for word in words:
            if len(word) >= _ALIKE:
                self._by_sound.setdefault(_sound(word), word)
            if len(word) >= _SWAPPED:
                for rest in _rests(word):
                    self._by_rest.setdefault(rest, []).append(word)

    def alike(self, word: str) -> str | None:
        """Return the word that sounds like `word`, or None."""
        if not _ALIKE <= len(word) <= _LONGEST:
            return None
        return self._by_sound.get(_sound(word))

    def near(self, word: str) -> str | None:
        """Return a word that is one slip of the finger away from `word`, or None."""
        if not _SWAPPED <= len(word) <= _LONGEST or not word.isalpha():
            return None
        for rest in _rests(word):
            for other in self._by_rest.get(rest, ()):
                if _is_slip(word, other):
                    return other
        return None


def _sound(word: str) -> str:
    for pattern, sound in _SOUNDS:
        word = pattern.sub(sound, word)
    return word


def _rests(word: str) -> Iterator[str]:
    """Give the word, and what is left of it without one of its letters."""
    yield word
    for k in range(len(word)):
        yield word[:k] + word[k + 1 :]


def _is_slip(one: str, other: str) -> bool:
    """Whether one letter is wrong, missing or too much, or two neighbours are exchanged."""
    k = 0
    while k < min(len(one), len(other)) and one[k] == other[k]:
        k += 1
    one, other = one[k:], other[k:]
    if len(one) == len(other) and one[:2] == other[1::-1] and one[2:] == other[2:]:
        return True
    if min(len(one), len(other)) + k < _SLIPPED:  # `AVNZA`: a vowel that nobody texts
        return len(other) + k >= _SLIPPED and other[:1] in tuple("AEIOU") and one == other[1:]
    return one[1:] in (other, other[1:]) or one == other[1:]
