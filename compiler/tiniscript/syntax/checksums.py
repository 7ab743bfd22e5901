"""The checksums of lines: `~` and eight hexadecimal digits at the end of a line of text.

It knows which bytes of a line a checksum covers, and where it may be. Knows no token.
"""

from __future__ import annotations

import re
from zlib import crc32

from tiniscript.base.source import SPACES, Span
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic

# a line, and the checksum at its first ~
_CHECKED_LINE = re.compile(
    rf"(?:\A|(?<=[\r\n]))([^~\r\n]*)~([0-9A-Fa-f]{{8}})(?=[{SPACES}]*(?:[\r\n]|\Z))"
)


def checksum_of(line: str) -> int:
    """Return the CRC-32 (zlib) of a line, byte order marks at its beginning left out."""
    return crc32(line.lstrip("\ufeff").encode("utf-8", "surrogatepass"))


def with_checksum(line: str) -> str:
    """Return a line that has a checksum after it, but no line end."""
    return f"{line}~{checksum_of(line):08X}"


def without_checksums(text: str) -> tuple[str, list[Diagnostic]]:
    """Return `text` with spaces in the place of checksums, and those that do not fit."""
    diagnostics = []
    for match in _CHECKED_LINE.finditer(text):
        if checksum_of(match[1]) != int(match[2], 16):
            span = Span(match.end(1), match.end())
            values = {"found": f"~{match[2]}"}
            diagnostics.append(Diagnostic(codes.CHECKSUM_WRONG, span, values))
    return _CHECKED_LINE.sub(rf"\1{' ' * 9}", text), diagnostics
