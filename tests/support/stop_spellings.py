"""Spellings of a typed STOP, and the bytes before it."""

from __future__ import annotations

import re

RUNNING_LINE = b"SI|F(60,80)\n"
SILENCE_MS = 1000
SHORTEST_STOP_MS, MAX_MS = 100, 1.0
# Bytes before the line of the stop, after a running program and a second of silence.
PREFIXES = {
    "nothing": b"",
    "CR LF": b"\r\n",
    "CR CR": b"\r\r",
    "LF CR": b"\n\r",
    "tabs": b"\t\t",
    "a digit": b"5\n",
    "a cursor key": b"\x1b[A",
    "a key with numbers": b"\x1b[1;5C",
    "another key": b"\x1bOB",
    "backspace": b"x\b",
    "backspace first": b"\b",
    "delete": b"\x7f",
    "a bracket": b"(\n",
    "a blank": b" \n",
    "a line": b"F(1,80)\n",
    "a line that is cut": b"F(1,\x03\n",
    "half a program": b"SI|F(1,\n",
    "a lost line": b"F(1,80);" * 12 + b"\n",
    "a long number": b"9" * 90 + b"\n",
    "noise": b"\x7f\x80\xff\n",
    "a frame": b"\0\x08\x02\x02\x0a\x62\xe4\x10\x1c\0",
    "a damaged frame": b"\0\x08\x02\x02\x0b\x62\xe4\x10\x1c\0",
    "a zero": b"\0",
    "zeros": b"\0\0",
    "a line after a zero": b"\0F(1,80)\r\n",
    "a mistake": b"FORWARD!\n",
    "six questions": b"HELP\n" * 6,
    "eight questions": b"HELP\n" * 8,
    "UTF-8": "ñandú\n".encode(),
    "a byte order mark": b"\xef\xbb\xbf",
    "a module's message": b"OK+CONN\r\n",
}
# The same inside a started frame.
FRAME_PREFIXES = {
    "a frame that has begun": b"\0\x08\x02\x02\n",
    "a zero and lines without anything": b"\0\n\n",
    "a zero and UTF-8": "\0ñandú\n".encode(),
    "a zero and noise": b"\0\x7f\x80\xff\n",
}
ALL_PREFIXES = PREFIXES | FRAME_PREFIXES
STRICT_SPELLINGS = (b"S\n", b"s\r", b"STOP\r\n", b"stop\n", b" \t;S ;\n", b";sToP\r\n")
LOOSE_SPELLINGS = (
    b"SS\n", b"S.\r", b"Stop.\r\n", b"stop!\n", b"S()\n", b"stop();\r\n", b"STOP NOW\n", b"alto\r",
    b"PARA\n", b"parar\r\n", b"detente\n", b"halt\r", "¡Alto!\n".encode(), b"S\0", b"STOP\0",
)  # fmt: skip
SPELLINGS = STRICT_SPELLINGS + LOOSE_SPELLINGS


def spellings_after(name: str) -> tuple[bytes, ...]:
    """Return the spellings that stop after a prefix. Bytes next to a 0x00 must be printable."""
    if name in FRAME_PREFIXES:
        return STRICT_SPELLINGS
    prefix = PREFIXES[name]
    line = re.split(rb"[\r\n\0]|\x1b\[[\d;]*.|\x1bO.", prefix)[-1].lstrip(b" \t\b\x7f")
    spellings = tuple(
        spelling for spelling in SPELLINGS if spelling[-1] != 0 or _is_printable(line)
    )
    return tuple(
        spelling for spelling in spellings if prefix[-1:] != b"\0" or _is_printable(spelling[:-2])
    )


def _is_printable(line: bytes) -> bool:
    return all(0x20 <= byte < 0x7F for byte in line)
