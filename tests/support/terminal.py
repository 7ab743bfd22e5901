"""A command on its own terminal, with Ctrl-C; `pyte` plays the terminal."""

from __future__ import annotations

import fcntl
import os
import pty
import re
import signal
import struct
import subprocess
import termios
from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from pathlib import Path
from queue import Queue
from threading import Thread
from time import monotonic

import pyte

from tests.support.command import TSC, rest_of
from tests.support.waiting import HANG_LIMIT_S

CHUNK_BYTES = 1000  # bytes
HIDDEN_VARIABLES = (
    "COLUMNS",
    "LINES",
    "NO_COLOR",
    "FORCE_COLOR",
    "CI",
    "TTY_COMPATIBLE",
    "TTY_INTERACTIVE",
)


class Terminal:
    """`tsc` with these words, or another command, on a terminal of so many columns and rows.

    Standard output is the terminal, too, or a file.
    """

    def __init__(
        self, *words: str | Path, command: Sequence[str] = TSC, size: tuple[int, int] = (80, 24),
        output: Path | None = None, env: Mapping[str, str] | None = None, types: bool = True,
    ) -> None:  # fmt: skip
        """Start the command; with `types`, standard input is the terminal, otherwise empty."""
        self._our_end, device_end = pty.openpty()
        fcntl.ioctl(device_end, termios.TIOCSWINSZ, struct.pack("HHHH", size[1], size[0], 0, 0))
        modes = termios.tcgetattr(device_end)
        modes[3] |= termios.NOFLSH  # without NOFLSH, Ctrl-C may drop later output
        termios.tcsetattr(device_end, termios.TCSANOW, modes)
        variables = {
            name: value for name, value in os.environ.items() if name not in HIDDEN_VARIABLES
        }
        with output.open("wb") if output else nullcontext(device_end) as out:
            self.process = subprocess.Popen(
                [*command, *map(str, words)], stdin=device_end if types else subprocess.DEVNULL,
                stdout=out, stderr=device_end,
                env={**variables, "TERM": "xterm-256color", **(env or {})},
                start_new_session=True, preexec_fn=_take_terminal,
            )  # fmt: skip
        os.close(device_end)
        self.screen = pyte.HistoryScreen(*size, history=100_000)
        self.output_bytes = b""
        self._stream = pyte.ByteStream(self.screen)
        self._unread = b""
        self._is_over = False
        self._read: Queue[bytes] = Queue()
        self._reader = Thread(target=self._read_on, daemon=True)
        self._reader.start()

    def lines(self) -> list[str]:
        return [line.rstrip() for line in self.screen.display]

    def whole(self) -> list[str]:
        """Return the lines with those that have scrolled away."""
        columns = range(self.screen.columns)
        scrolled_lines = [
            "".join(line[k].data for k in columns) for line in self.screen.history.top
        ]
        return [*(line.rstrip() for line in scrolled_lines), *self.lines()]

    def until(self, pattern: str) -> re.Match[str]:
        """Wait until something is to be seen."""
        end_s = monotonic() + HANG_LIMIT_S
        while True:
            match = re.search(pattern, "\n".join(self.lines()))
            if match:
                return match
            assert self.take(), f"it ends without {pattern}: {self.lines()}"
            assert monotonic() < end_s, f"it draws on without {pattern}: {self.lines()}"

    def type(self, keys: str) -> None:
        os.write(self._our_end, keys.encode())

    def interrupt(self) -> None:
        """Act like Ctrl-C on the terminal of a shell."""
        self.process.send_signal(signal.SIGINT)

    def end(self) -> int:
        """Wait until it has ended; return its exit code."""
        while self.take():
            pass
        self._reader.join()
        os.close(self._our_end)
        return self.process.wait(HANG_LIMIT_S)

    def take(self) -> bool:
        """Draw a small part of the output, so that brief displays are not missed."""
        if not self._unread and not self._is_over:
            self._unread = self._read.get(timeout=HANG_LIMIT_S)
            self._is_over = not self._unread
            self.output_bytes += self._unread
        part, self._unread = self._unread[:CHUNK_BYTES], self._unread[CHUNK_BYTES:]
        self._stream.feed(part)
        return bool(part)

    def _read_on(self) -> None:
        """Read at once, because a writer to a full terminal blocks."""
        part = b"begun"
        while part:
            part = rest_of(self._our_end)
            self._read.put(part)


def _take_terminal() -> None:
    """Make standard error the terminal whose Ctrl-C this process gets."""
    fcntl.ioctl(2, termios.TIOCSCTTY, 0)
