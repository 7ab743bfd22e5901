"""Names that a program does not have yet, for its variables and its DEFs.

Knows the text of the program, and no grammar: a word in a note is a name that is taken, too.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import lru_cache
from itertools import count

from tiniscript.base.words import other_name


@lru_cache(maxsize=1)
def names_in(text: str) -> frozenset[str]:
    """Return all words of a text, in capitals."""
    return frozenset(re.findall(r"\w+", text.upper()))


def numbered_names(text: str, stem: str) -> Iterator[str]:
    """Yield `stem`_2, `stem`_3 … without those that the text has."""
    names = (f"{stem}_{k}" for k in count(2))
    return (name for name in names if name not in names_in(text))


def free_word_name(text: str, word: str) -> str:
    """Return a new name for something named `word`, a word of the language: F_1, or F_2 if F_1
    exists."""
    numbered_name = other_name(word)
    is_free = numbered_name not in names_in(text)
    return (
        numbered_name if is_free else next(numbered_names(text, numbered_name.removesuffix("_1")))
    )


def free_number_name(text: str) -> str:
    """Return a name for a variable that gets a number: N, or N_2 if there is an N."""
    return "N" if "N" not in names_in(text) else next(numbered_names(text, "N"))
