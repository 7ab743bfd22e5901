"""Single keys of the person at the terminal, without waiting for one."""

from __future__ import annotations

import os
import re
import select
import sys

INTERRUPT = "\x03"
# A key of several characters, such as F4 or an arrow: its last one was not typed.
_SEQUENCE = re.compile(r"\x1b(?:\[\[.|\[[0-?]*[ -/]*[@-~]|O.|[^\[O])?", re.DOTALL)
_SEQUENCE_OF_WINDOWS = re.compile(r"[\0\xe0].", re.DOTALL)


def letters_of(keys: str) -> str:
    """Return the typed characters without the keys of several characters."""
    pattern = _SEQUENCE_OF_WINDOWS if sys.platform == "win32" else _SEQUENCE
    return pattern.sub("", keys)


class Keys:
    """A keyboard without a terminal, which never has keys."""

    def __init__(self) -> None:
        self._saved_mode: object = None
        self._descriptor = -1

    def __enter__(self) -> Keys:
        if sys.stdin.isatty() and sys.platform != "win32" and is_in_front():
            import termios
            import tty

            self._descriptor = sys.stdin.fileno()
            self._saved_mode = termios.tcgetattr(self._descriptor)
            tty.setcbreak(self._descriptor)
        return self

    def __exit__(self, *signal_arguments: object) -> None:
        if self._saved_mode is not None and sys.platform != "win32":
            import termios

            termios.tcsetattr(self._descriptor, termios.TCSADRAIN, self._saved_mode)  # type: ignore[arg-type]

    def read_keys(self) -> str:
        """Return the keys that were pressed since the last time."""
        if sys.platform == "win32":
            return _read_on_windows()
        if self._descriptor < 0:
            return ""
        if not select.select([self._descriptor], [], [], 0)[0]:
            return ""
        return os.read(self._descriptor, 100).decode("utf-8", "replace")


def is_in_front() -> bool:
    """Return whether this command owns the terminal: `tsc robot &` leaves it to the shell."""
    if sys.platform == "win32":
        return True
    try:
        return os.tcgetpgrp(sys.stdin.fileno()) == os.getpgrp()
    except (OSError, ValueError):  # no terminal of a shell's
        return True


def _read_on_windows() -> str:
    if sys.platform != "win32" or not sys.stdin.isatty():
        return ""
    import msvcrt

    keys = ""
    while msvcrt.kbhit():
        keys += msvcrt.getwch()
    if INTERRUPT in keys:
        raise KeyboardInterrupt
    return keys
