"""Which lines are typed stops: of all their characters only ASCII letters and digits are looked at.

Knows spellings, no receiver and no time. The C++ version is `vm_arduino/src/link/typed_stop.h`.
"""

from __future__ import annotations

import re

_WORDS = re.compile(rb"S+|(?:STOP)+|STOPNOW|ALTO|PARA|PARAR|PARE|DETENTE|HALT")
_AT_ONCE = re.compile(rb"S[ \t]*S[ \t]*S|STOP[ \t]*STOP", re.IGNORECASE)
_NO_LETTERS = re.compile(rb"[^A-Za-z0-9]")
_COMMENT = re.compile(rb"(?:[\0-\x20\x7f]|\xef\xbb\xbf)*//")
# what a terminal sends for a cursor key, as far as it has come
_KEY = re.compile(rb"\x1b(?:\[[0-?]*[@-~]?|O[@-~]?)")
_LINE_END = re.compile(rb"[\r\n\0]")
_CTRL_C = re.compile(rb"\x03+")


def is_typed_stop(line: bytes) -> bool:
    """Return whether a line of text, without its end, is a typed stop."""
    line = _KEY.sub(b"", line)
    letters = _NO_LETTERS.sub(b"", line).upper()
    return not _COMMENT.match(line) and _WORDS.fullmatch(letters) is not None


def stops_at_once(line: bytes) -> bool:
    """Return whether what has come of a line stops what runs before the line ends."""
    line = _KEY.sub(b"", line)
    return not _COMMENT.match(line) and _AT_ONCE.search(line) is not None


def is_at_stop(data: bytes) -> bool:
    """Return whether text ends with a line that stops what runs if nothing more comes."""
    line = _LINE_END.split(data)[-1]
    return is_typed_stop(line) or stops_at_once(line) or _CTRL_C.fullmatch(line) is not None
