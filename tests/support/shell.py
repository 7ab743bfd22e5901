"""A command on a terminal of its own, which is its controlling one: so Ctrl-C is what it is."""

from __future__ import annotations

import fcntl
import os
import pty
import re
import select
import struct
import termios
from collections.abc import Mapping

from tests.support.waiting import HANGS_S

CONTROL = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]|\x00|\x07")  # colors, the cursor, padding
COLUMNS = 80


class Shell:
    """A process that reads and writes a terminal of `rows` lines."""

    def __init__(self, words: list[str], env: Mapping[str, str], rows: int = 24) -> None:
        self.written = ""
        self._pid, self._terminal = pty.fork()
        if self._pid == 0:
            try:
                size = struct.pack("HHHH", rows, COLUMNS, 0, 0)
                fcntl.ioctl(0, termios.TIOCSWINSZ, size)
                os.execvpe(words[0], words, dict(env))
            finally:
                os._exit(127)

    def type(self, keys: str) -> None:
        os.write(self._terminal, keys.encode())

    def until(self, pattern: str) -> str:
        """Wait until it has written something; return what it wrote since the last time."""
        while not re.search(pattern, CONTROL.sub("", self.written)):
            assert self._reads(), f"it ends without {pattern}: {self.written!r}"
        seen, self.written = CONTROL.sub("", self.written), ""
        return seen

    def end(self) -> int:
        """Wait until it has ended; return its exit code."""
        while self._reads():
            pass
        os.close(self._terminal)
        return os.waitstatus_to_exitcode(os.waitpid(self._pid, 0)[1])

    def _reads(self) -> bool:
        ready, _, _ = select.select([self._terminal], [], [], HANGS_S)
        assert ready, f"it says nothing more: {self.written!r}"
        try:
            part = os.read(self._terminal, 65536)
        except OSError:  # Linux: the other end is closed
            part = b""
        self.written += part.decode(errors="replace")
        return bool(part)
