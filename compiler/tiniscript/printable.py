"""Text of others as a terminal may have it.

A file's name, an argument, a profile or a robot may hold characters that move the cursor, hide
text, turn its direction or begin a new line. Whatever is put into a sentence comes through here.
"""

from __future__ import annotations

INSTEAD = "?"  # of a character that is not printable


def printable(text: str, most: int | None = None) -> str:
    """Return a text without control characters, line ends and marks of direction.

    What is longer than `most` characters is cut, which the reader can see.
    """
    cut = text if most is None else text[:most]
    if not cut.isprintable():
        cut = "".join(letter if letter.isprintable() else INSTEAD for letter in cut)
    return cut + "…" if len(cut) < len(text) else cut
