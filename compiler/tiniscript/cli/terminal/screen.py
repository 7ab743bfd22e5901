"""A picture at the bottom of the terminal, which is redrawn while lines are printed above it.

The picture goes to standard error, the lines to standard output. Knows the terminal and the time
that passes in front of it; does not know what a picture shows.
"""

from __future__ import annotations

import os
import sys
import time
from typing import Protocol

from rich.console import Console
from rich.text import Text

from tiniscript.cli.encodings import DRAWN
from tiniscript.cli.terminal.frame import Frame
from tiniscript.cli.terminal.pace import FRAME_S
from tiniscript.cli.terminal.sequences import are_read

SLOWEST_S = 0.2  # a frame that took longer (a long computation, Ctrl-Z) does not skip a move


class Drawable(Protocol):
    """A picture: at most `height` lines of at most `width` columns."""

    def lines(self, width: int, height: int, now_ms: float) -> list[Text]: ...


class Screen:
    """The terminal: the trace, and below it the picture."""

    def __init__(self) -> None:
        # rich looks at standard output, and does not ask the console to read sequences
        is_legacy = sys.platform == "win32" and not are_read(sys.stderr)
        self.console = Console(stderr=True, legacy_windows=is_legacy)
        self.frame = Frame(self.console)
        self.is_begun = False
        # Where nothing can be redrawn, only the last picture is printed.
        self.is_still = self.console.legacy_windows or self.console.is_dumb_terminal
        self.last = Text()
        self.lines: list[str] = []  # of the trace, for the next frame
        self.frame_s = time.monotonic()
        # where the trace goes to this very terminal, it has to go around the picture
        self.is_shared = sys.stdout.isatty() and _is_one_terminal()

    def begin(self) -> None:
        self.is_begun = True
        if not self.is_still:
            self.frame.begin()

    def end(self) -> None:
        try:
            self.flush()
        finally:
            if self.is_begun:
                self.is_begun = False
                if self.is_still:
                    self.console.print(self.last)
                else:
                    self.frame.end()

    def say(self, line: str) -> None:
        """Print a line of the trace, at the next frame at the latest."""
        if self.is_shared and self.is_begun and not self.is_still:
            self.lines.append(line)
        else:
            sys.stdout.write(f"{line}\n")

    def flush(self) -> None:
        sys.stdout.flush()
        if self.lines:
            said = Text("\n".join(self.lines)).plain
            self.lines = []
            self.frame.draw(self.frame.lines, said)

    def warn(self, line: str) -> None:
        """Print a line on standard error, above the picture."""
        self.flush()
        if self.is_begun and not self.is_still:
            self.frame.draw(self.frame.lines, Text(line).plain)
        else:
            self.console.print(Text(line), soft_wrap=True)

    def rest(self) -> float:
        """Wait for the next frame; return the seconds since the last one."""
        last_s = self.frame_s
        time.sleep(max(0.0, last_s + FRAME_S - time.monotonic()))
        self.frame_s = time.monotonic()
        return min(self.frame_s - last_s, SLOWEST_S)

    def is_late(self) -> bool:
        """Return whether a frame is overdue: much has happened that takes the robot no time."""
        now_s = time.monotonic()
        if now_s - self.frame_s < 2 * FRAME_S:
            return False
        self.frame_s = now_s
        return True

    def draw(self, picture: Drawable, now_ms: float) -> None:
        """Print what was said, and the picture below it."""
        width, height = self.console.size
        lines = picture.lines(width - 1, height - max(3, height // 4), now_ms)
        if not self.console.encoding.startswith("utf"):
            for line in lines:
                line.plain = "".join("*" if "⠀" <= c <= "⣿" else c for c in line.plain)
                line.plain = line.plain.translate(DRAWN)
        self.last = Text("\n", no_wrap=True).join(lines)
        if not self.is_begun:
            self.flush()
            self.console.print(self.last)
        elif not self.is_still:
            sys.stdout.flush()
            said = Text("\n".join(self.lines)).plain if self.lines else ""
            self.lines = []
            self.frame.draw(lines, said)


def _is_one_terminal() -> bool:
    """Whether both streams of this command, which are terminals, are the same one."""
    if sys.platform == "win32":  # a command has one console
        return True
    numbers = [os.fstat(each.fileno()).st_rdev for each in (sys.stdout, sys.stderr)]
    return numbers[0] == numbers[1]
