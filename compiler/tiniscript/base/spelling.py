"""Finds the word that a misspelt one was meant to be.

`nearest` counts slips of the finger; `Speller` also knows which letters sound alike in each
language. Only texts with mistakes need them.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from functools import cache

from tiniscript.base.languages import languages, read_language_file


def nearest(word: str, candidates: Iterable[str]) -> str | None:
    """Return the word among `candidates` that a slip of the finger away is `word`, or None.

    A slip is a letter that is wrong, missing, doubled or exchanged with the next: one in short
    words, two in longer ones. A wrong suggestion is worse than none, so in a word of three
    letters no letter is taken for another.
    """
    if not 2 < len(word) <= 40:
        return None
    most_edits = 1 if len(word) <= 5 else 2
    best_word, best_edit_count = None, most_edits + 1
    letters = set(word)
    for candidate in candidates:
        is_too_different = (
            abs(len(candidate) - len(word)) > most_edits
            or len(letters.difference(candidate)) > most_edits
        )
        if len(candidate) > 1 and not is_too_different:
            edit_count = _edit_count(word, candidate)
            if edit_count == 1 and len(word) <= 3 and len(candidate) == len(word):
                edit_count += sorted(word) != sorted(candidate)
            if edit_count < best_edit_count:
                best_word, best_edit_count = candidate, edit_count
    return best_word


def is_slip(word: str, intended_text: str) -> bool:
    """Return whether a word is one slip away from another, which may be short because its place is
    decisive.
    """
    return (
        len(word) > 1
        and abs(len(word) - len(intended_text)) < 2
        and _edit_count(word, intended_text) == 1
    )


def _edit_count(word: str, other_word: str) -> int:
    """Return the number of slips between two words; exchanging neighbours is one slip."""
    row_before_last: list[int] = []
    last_row = list(range(len(other_word) + 1))
    for i, letter in enumerate(word, 1):
        row = [i]
        for k, other_letter in enumerate(other_word, 1):
            least_edit_count = min(
                last_row[k] + 1, row[k - 1] + 1, last_row[k - 1] + (letter != other_letter)
            )
            if i > 1 and k > 1 and letter == other_word[k - 2] and other_letter == word[i - 2]:
                least_edit_count = min(least_edit_count, row_before_last[k - 2] + 1)
            row.append(least_edit_count)
        row_before_last, last_row = last_row, row
    return last_row[-1]


_MIN_SOUND_LETTERS = 4  # letters that a word needs where only its sound is the same
_MIN_SWAP_LETTERS = 5  # … where two neighbours are exchanged
_MIN_SLIP_LETTERS = 6  # … where a letter is wrong, missing or too much
_MAX_LETTERS = 24


@cache
def _sounds() -> tuple[tuple[tuple[re.Pattern[str], str], ...], ...]:
    """Return the patterns for letters that sound alike in some language, each with its sign."""
    tables = (read_language_file(language, "sounds.txt").split("\n") for language in languages())
    rows_by_language = ([row.rpartition("|") for row in rows if "|" in row] for rows in tables)
    return tuple(
        tuple((re.compile(pattern.strip(), re.M), sign.strip()) for pattern, _, sign in rows)
        for rows in rows_by_language
        if rows
    )


class Speller:
    """The words that are looked for. A lookup takes the same time however many they are."""

    def __init__(self, words: Iterable[str]) -> None:
        self._word_by_sound: dict[tuple[int, str], str] = {}
        self._words_by_deletion: dict[str, list[str]] = {}
        words = [word for word in words if len(word) >= _MIN_SOUND_LETTERS]
        for language_number, sounds in enumerate(_sounds_of(words)):
            for sound, word in zip(sounds, words, strict=True):
                self._word_by_sound.setdefault((language_number, sound), word)
        for word in words:
            if len(word) >= _MIN_SWAP_LETTERS:
                for deletion in _deletions(word):
                    self._words_by_deletion.setdefault(deletion, []).append(word)

    def find_sound_alike(self, word: str) -> str | None:
        """Return the word that sounds like `word`, or None."""
        if not _MIN_SOUND_LETTERS <= len(word) <= _MAX_LETTERS:
            return None
        sound_keys = ((k, sounds[0]) for k, sounds in enumerate(_sounds_of([word])))
        return next(filter(None, map(self._word_by_sound.get, sound_keys)), None)

    def find_near_miss(self, word: str) -> str | None:
        """Return a word that is one slip of the finger away from `word`, or None."""
        if not _MIN_SWAP_LETTERS <= len(word) <= _MAX_LETTERS or not word.isalpha():
            return None
        for deletion in _deletions(word):
            for other in self._words_by_deletion.get(deletion, ()):
                if _is_one_edit_away(word, other):
                    return other
        return None


def _sounds_of(words: Sequence[str]) -> Iterator[list[str]]:
    """Yield how words sound in each language. A pattern reads all words at once, a line each."""
    for rows in _sounds():
        sounds = "".join(f"{word}\n" for word in words)
        for pattern, sign in rows:
            sounds = pattern.sub(sign, sounds)
        yield sounds.splitlines()


def _deletions(word: str) -> Iterator[str]:
    """Yield the word, and every variant without one of its letters."""
    yield word
    for k in range(len(word)):
        yield word[:k] + word[k + 1 :]


def _is_one_edit_away(word: str, other_word: str) -> bool:
    """Return whether one letter is wrong, missing or superfluous, or two neighbours are
    exchanged.
    """
    k = 0
    while k < min(len(word), len(other_word)) and word[k] == other_word[k]:
        k += 1
    word, other_word = word[k:], other_word[k:]
    if (
        len(word) == len(other_word)
        and word[:2] == other_word[1::-1]
        and word[2:] == other_word[2:]
    ):
        return True
    if (
        min(len(word), len(other_word)) + k < _MIN_SLIP_LETTERS
    ):  # `AVNZA`: a vowel omitted as in text messages
        return (
            len(other_word) + k >= _MIN_SLIP_LETTERS
            and other_word[:1] in tuple("AEIOU")
            and word == other_word[1:]
        )
    return word[1:] in (other_word, other_word[1:]) or word == other_word[1:]
