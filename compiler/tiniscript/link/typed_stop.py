"""Recognizes typed stops: of a line's characters, only ASCII letters and digits count.

Text after // is ignored. Knows spellings, no receiver and no time. The C++ version is
`vm_arduino/src/link/typed_stop.h`.
"""

from __future__ import annotations

import re

_WORDS = re.compile(rb"(?:S|STOP)+|(?:S|STOP)*STOPNOW|ALTO|PARA|PARAR|PARE|DETENTE|HALT")
_IMMEDIATE_STOP = re.compile(rb"SSS|STOPSTOP", re.IGNORECASE)
_BLANKS = re.compile(rb"[ \t]")
# The start of a cursor key's sequence, as far as received.
_KEY = re.compile(rb"\x1b(?:[\[O][ -?]*[@-~]?)?")
_COMMENT = re.compile(rb"/[ \t]*/")
_DELETE_KEYS = b"\b\x7f"
_LINE_END = re.compile(rb"[\r\n\0]")
_CTRL_C = re.compile(rb"\x03+")


def is_typed_stop(line: bytes) -> bool:
    """Return whether a line of text, without its end, is a typed stop."""
    letters = bytearray()
    for byte in _strip_keys_and_comment(line):
        if byte in _DELETE_KEYS:
            del letters[-1:]
        elif byte < 0x80 and chr(byte).isalnum():
            letters.append(byte)
    return _WORDS.fullmatch(letters.upper()) is not None


def stops_at_once(line: bytes) -> bool:
    """Return whether the beginning of a line stops the running program before the line ends."""
    return _IMMEDIATE_STOP.search(_BLANKS.sub(b"", _strip_keys_and_comment(line))) is not None


def is_at_stop(data: bytes) -> bool:
    """Return whether text ends with a line that stops the run if no more text follows."""
    line = _LINE_END.split(data)[-1]
    return is_typed_stop(line) or stops_at_once(line) or _CTRL_C.fullmatch(line) is not None


def _strip_keys_and_comment(line: bytes) -> bytes:
    """Return the relevant part of a line, without keys and comment."""
    return _COMMENT.split(_KEY.sub(b"", line), 1)[0]
