"""How a file of the user's cache is read: whatever lies there, reading it ends soon.

A pipe would be waited for, and a device or a huge file would fill the memory. Knows no content.
"""

from __future__ import annotations

import os
import stat
from pathlib import Path


def contents(path: Path, limit_bytes: int) -> bytes:
    """Return the bytes of a file. Raises OSError where it has none, or more than so many."""
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    number = os.open(path, flags)
    with os.fdopen(number, "rb") as file:
        if not stat.S_ISREG(os.fstat(number).st_mode):
            raise OSError("no file")
        data = file.read(limit_bytes + 1)
    if len(data) > limit_bytes:
        raise OSError("too large")
    return data
