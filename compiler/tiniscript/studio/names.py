"""Names of pupils: their visible form, and whether readers can distinguish two.

`alike.txt` has Unicode's table of what looks alike.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from unicodedata import category, normalize

from tiniscript.base.source import printable

NAME_CHARACTERS = 24
# Invisible letters and signs outside of the invisible categories.
_BLANK = re.compile("[\u115f\u1160\u2800\u3164\uffa0\U00013441\U0001d159]")
# Characters that only change their neighbours' look, or nothing.
_INVISIBLE = re.compile("[\u034f\u17b4\u17b5\u180b-\u180f\ufe00-\ufe0f\U000e0100-\U000e01ef]")
_INVISIBLE_CATEGORIES = frozenset("CMZ")  # controls, marks without a letter, and spaces


def plain_name(typed_name: str) -> str:
    """Return a pupil's name as one line that hides nothing; empty if nothing of it is seen."""
    line = " ".join(_BLANK.sub(" ", normalize("NFC", typed_name)).split())
    if all(category(letter)[0] in _INVISIBLE_CATEGORIES for letter in line):
        return ""
    return printable(line, NAME_CHARACTERS)


def are_alike(name: str, other_name: str) -> bool:
    """Return whether two names look alike, or differ only in capitals."""
    return not _looks(name).isdisjoint(_looks(other_name))


def free_name(wanted_name: str, taken_names: Iterable[str]) -> str:
    """Return a name that looks different from all that are taken: `Ana`, or else `Ana (2)`."""
    looks = {look for taken_name in taken_names for look in _looks(taken_name)}
    name, k = wanted_name, 1
    while not looks.isdisjoint(_looks(name)):
        k += 1
        name = f"{wanted_name} ({k})"
    return name


def _looks(name: str) -> set[str]:
    """Return the visual forms of a name, as it is and in small letters."""
    return {_case_folded(name), _case_folded(name.casefold())}


def _case_folded(text: str) -> str:
    """Return a common form of all texts that look alike, as in Unicode standard 39."""
    table = _table()
    text = _INVISIBLE.sub("", text)
    for form in ("NFD", "NFKD"):  # the table contains what the normal forms leave
        text = normalize(form, text).translate(table)
    return normalize("NFC", text)


@cache
def _table() -> dict[int, str]:
    look_by_code_point: dict[int, str] = {}
    for line in Path(__file__).with_name("alike.txt").read_text(encoding="utf-8").splitlines():
        if not line.startswith("# "):
            looks, _, signs = line.partition(" ")
            look_by_code_point |= dict.fromkeys(map(ord, signs), looks)
    return look_by_code_point
