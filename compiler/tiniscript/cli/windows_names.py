"""Names that Windows gives to no file: whoever writes to one loses what was written.

`con.bin` is the console there and `aux.html` a serial port, in each folder; `sheet:1.html` is a
hidden part of the file `sheet`. Knows names alone, so it can be asked on every system.
"""

from __future__ import annotations

import ntpath

DEVICES = {"con", "prn", "aux", "nul", "conin$", "conout$"} | {
    f"{name}{number}" for name in ("com", "lpt") for number in "0123456789¹²³"
}
FORBIDDEN = set('<>"|?*') | {chr(code) for code in range(32)}


def has_no_file(path: str) -> bool:
    """Return whether Windows would make no file of this name, or one of another name."""
    rest = ntpath.splitdrive(path)[1].replace("/", "\\")
    parts = [each for each in rest.split("\\") if each not in ("", ".", "..")]
    return any(_is_impossible(each) for each in parts)


def _is_impossible(name: str) -> bool:
    stem = name.split(".")[0].rstrip(" ").lower()
    return stem in DEVICES or ":" in name or name[-1] in " ." or bool(FORBIDDEN & set(name))
