"""Whether a stream reaches a terminal that reads sequences: colors, and what moves the cursor.

Terminals of Unix do. A console of Windows 10 or newer does when it is asked to: PowerShell and the
Windows Terminal ask for the commands they start, cmd only for itself, and then a command that
does not ask prints `←[1;31m`.
"""

from __future__ import annotations

import os
import sys
from typing import TextIO

# of SetConsoleMode
PROCESSED_OUTPUT = 0x0001
VIRTUAL_TERMINAL_PROCESSING = 0x0004


def are_read(stream: TextIO) -> bool:
    """Return whether sequences that are written to a stream are read. Asks the console to."""
    if not stream.isatty():
        return False
    if sys.platform != "win32":
        return True
    import ctypes
    import msvcrt
    from ctypes import wintypes

    console = ctypes.windll.kernel32
    mode = wintypes.DWORD()
    try:
        handle = wintypes.HANDLE(msvcrt.get_osfhandle(stream.fileno()))
    except (OSError, ValueError):  # no file of the system
        return False
    if not console.GetConsoleMode(handle, ctypes.byref(mode)):  # a device such as NUL
        return False
    if mode.value & VIRTUAL_TERMINAL_PROCESSING:
        return True
    wanted = mode.value | PROCESSED_OUTPUT | VIRTUAL_TERMINAL_PROCESSING
    return bool(console.SetConsoleMode(handle, wintypes.DWORD(wanted)))


def has_colors(stream: TextIO) -> bool:
    """Return whether a stream shows colors, and the person has not declined them."""
    return not os.environ.get("NO_COLOR") and are_read(stream)
