"""Ranges of whole numbers as people say them, which TiniScript writes with a comma.

Knows `1 a 6`, `1-6` and `del 1 al 6`. Knows no place in a program.
"""

from __future__ import annotations

import re

_RANGE = re.compile(
    r"(?i)(?:(?:del?|desde|entre|from|between) )?(\d{1,7})"
    r" ?(?:-|al?|hasta|to|until|y|e|and) ?(?:el )?(\d{1,7})"
)


def range_in(text: str) -> list[str]:
    """Return the two numbers of a range, the lower one first; none where it is no range."""
    found = _RANGE.fullmatch(text)
    return sorted(found.groups(), key=int) if found else []
