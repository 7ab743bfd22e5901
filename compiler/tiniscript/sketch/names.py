"""What the names of a program are called in C++: `MY_SPEED` is `mySpeed`.

No two have the same name, and none has a name of C++, of the Arduino core or of a helper.
"""

from __future__ import annotations

import re

from tiniscript.sketch.reserved import RESERVED
from tiniscript.sketch.texts import IDENTIFIERS

_COUNTER = re.compile(r"[ijk][0-9]*|first[0-9]+")  # of a LOOP; of a value that is kept
_PREFIXES = ("my", "mi")  # in English and in Spanish


class Names:
    """Gives names in the order in which it is asked."""

    def __init__(self, language: str) -> None:
        self._prefix = _PREFIXES[language == "es"]
        self._taken = {word for both in IDENTIFIERS.values() for word in both}

    def of(self, name: str, before: str = "") -> str:
        """Return the name in C++ of a name in capitals; `before` is the verb of a function."""
        words = [word for word in name.lower().split("_") if word]
        made = "".join(word.capitalize() for word in words)
        made = before + made if before else words[0] + made[len(words[0]) :]
        if made in RESERVED or made in self._taken or _COUNTER.fullmatch(made):
            made = self._prefix + made[0].upper() + made[1:]
        found, number = made, 2
        while found in self._taken:
            found, number = f"{made}_{number}", number + 1
        self._taken.add(found)
        return found


def counter(depth: int) -> str:
    """Return the variable that counts a LOOP inside so many others."""
    return "ijk"[depth] if depth < 3 else f"i{depth + 1}"
