"""Bytes that apps send before and after a line."""

from __future__ import annotations

# Bytes that apps, terminals and modules send by themselves, and rests of other lines.
PIECES = (
    b"\n", b"\r", b"\r\n", b"\n\n", b" ", b"\t", b";", b"\xef\xbb\xbf", b"\0", b"\0\0", b"\0\0\0",
    b"AT\r\n", b"AT", b"AT+NAMEx\r\n", b"OK+CONN", b"OK+LOST", b"+CONNECTED\r\n", b"OK\r\n",
    b"S\n", b"S", b"F", b"x", b"1", b"SI|", b"si|", b"SB|", b"F(1,", b"80)\n", b"END_LOOP\n",
    b"// note\n", b"~1234ABCD\n", b"\x1b[A", b"\x08", b"\x7f", b"\xff", b"\xc3", b"LOOP(2)\n",
    b"x" * 300, b"F(0.1,80);" * 60,
)  # fmt: skip
