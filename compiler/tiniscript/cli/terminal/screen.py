"""A picture at the bottom of the terminal, which is redrawn while lines are printed above it.

The picture goes to standard error, the lines to standard output. It knows the terminal and the time
that passes in front of it, but not what a picture shows.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Sequence
from typing import Protocol

from rich.console import Console
from rich.text import Text

from tiniscript.cli.streams import DRAWING_SUBSTITUTES, reads_sequences
from tiniscript.cli.terminal import FRAME_S

BEGIN_UPDATE, END_UPDATE = "\x1b[?2026h", "\x1b[?2026l"  # begin and end of a synchronized update
HIDE_CURSOR, SHOW_CURSOR = "\x1b[?25l", "\x1b[?25h"  # the cursor
TO_LINE_END, TO_SCREEN_END = "\x1b[K", "\x1b[J"  # erase


class Frame:
    def __init__(self, console: Console) -> None:
        self.console = console
        self.lines: list[Text] = []  # the lines that the terminal shows
        self._width = 0  # width of the terminal when they were written

    def begin(self) -> None:
        self._write(HIDE_CURSOR)

    def end(self) -> None:
        """Leave the picture, and continue below it."""
        self._write(("\n" if self.lines else "") + SHOW_CURSOR)
        self.lines = []

    def draw(self, lines: Sequence[Text], text_above: str = "") -> None:
        """Show these lines in place of the last ones, and print `text_above` over them, to stay."""
        width = self.console.size.width
        if text_above or width != self._width or len(lines) != len(self.lines):
            text = self._full_picture(lines, text_above)
        else:
            text = self._changes(lines)
        self.lines = [line.copy() for line in lines]
        self._width = width
        if text:
            self._write(BEGIN_UPDATE + text + END_UPDATE)

    def _full_picture(self, lines: Sequence[Text], text_above: str) -> str:
        """Return the output that draws the whole picture, from the first line of the last one
        on.
        """
        width = self.console.size.width
        # a terminal that has become narrower has wrapped the last picture
        rows = max(0, len(self.lines) - 1)
        if width != self._width:
            rows += sum(max(0, line.cell_len - 1) // width for line in self.lines)
        parts = (
            [*(f"{line}{TO_LINE_END}\n" for line in text_above.split("\n"))] if text_above else []
        )
        parts.append(f"{TO_LINE_END}\n".join(map(self._style, lines)))
        erase_code = TO_SCREEN_END if width != self._width else ""
        return f"\r{_cursor_up(rows)}{erase_code}{''.join(parts)}{TO_SCREEN_END}"

    def _changes(self, lines: Sequence[Text]) -> str:
        """Return the output that redraws changed lines; the number of lines is the same."""
        rows = [
            ""
            if new_line == old_line and new_line.style == old_line.style
            else self._style(new_line) + TO_LINE_END
            for new_line, old_line in zip(lines, self.lines, strict=True)
        ]
        return f"\r{_cursor_up(len(rows) - 1)}" + "\r\n".join(rows) if any(rows) else ""

    def _style(self, line: Text) -> str:
        with self.console.capture() as capture:
            self.console.print(line, end="", no_wrap=True, overflow="ignore", crop=False)
        return capture.get()

    def _write(self, text: str) -> None:
        self.console.file.write(text)
        self.console.file.flush()


def _cursor_up(rows: int) -> str:
    return f"\x1b[{rows}A" if rows else ""


SLOWEST_FRAME_S = 0.2  # a frame that took longer (a long computation, Ctrl-Z) does not skip a move


class Drawable(Protocol):
    """A picture: at most `height` lines of at most `width` columns."""

    def lines(self, width: int, height: int, now_ms: float) -> list[Text]: ...


class Screen:
    """The terminal: the trace, and below it the picture."""

    def __init__(self) -> None:
        # rich looks at standard output, and does not ask the console to read sequences
        is_legacy = sys.platform == "win32" and not reads_sequences(sys.stderr)
        self.console = Console(stderr=True, legacy_windows=is_legacy)
        self.frame = Frame(self.console)
        self.is_begun = False
        # If nothing can be redrawn, only the last picture is printed.
        self.is_still = self.console.legacy_windows or self.console.is_dumb_terminal
        self.last_picture = Text()
        self.lines: list[str] = []  # trace lines for the next frame
        self.frame_s = time.monotonic()
        # A trace that goes to the same terminal must be printed around the picture.
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
                    self.console.print(self.last_picture)
                else:
                    self.frame.end()

    def print_line(self, line: str) -> None:
        """Print a line of the trace, at the next frame at the latest."""
        if self.is_shared and self.is_begun and not self.is_still:
            self.lines.append(line)
        else:
            sys.stdout.write(f"{line}\n")

    def flush(self) -> None:
        sys.stdout.flush()
        if self.lines:
            text = Text("\n".join(self.lines)).plain
            self.lines = []
            self.frame.draw(self.frame.lines, text)

    def print_error(self, line: str) -> None:
        """Print a line on standard error, above the picture."""
        self.flush()
        if self.is_begun and not self.is_still:
            self.frame.draw(self.frame.lines, Text(line).plain)
        else:
            self.console.print(Text(line), soft_wrap=True)

    def wait_for_frame(self) -> float:
        """Wait for the next frame; return the seconds since the last one."""
        last_s = self.frame_s
        time.sleep(max(0.0, last_s + FRAME_S - time.monotonic()))
        self.frame_s = time.monotonic()
        return min(self.frame_s - last_s, SLOWEST_FRAME_S)

    def reset_frame_clock_if_late(self) -> bool:
        """Return whether a frame is overdue: much has happened that takes the robot no time."""
        now_s = time.monotonic()
        if now_s - self.frame_s < 2 * FRAME_S:
            return False
        self.frame_s = now_s
        return True

    def draw(self, picture: Drawable, now_ms: float) -> None:
        """Print the new text, and the picture below it."""
        width, height = self.console.size
        lines = picture.lines(width - 1, height - max(3, height // 4), now_ms)
        if not self.console.encoding.startswith("utf"):
            for line in lines:
                line.plain = "".join("*" if "⠀" <= c <= "⣿" else c for c in line.plain)
                line.plain = line.plain.translate(DRAWING_SUBSTITUTES)
        self.last_picture = Text("\n", no_wrap=True).join(lines)
        if not self.is_begun:
            self.flush()
            self.console.print(self.last_picture)
        elif not self.is_still:
            sys.stdout.flush()
            text = Text("\n".join(self.lines)).plain if self.lines else ""
            self.lines = []
            self.frame.draw(lines, text)


def _is_one_terminal() -> bool:
    """Return whether both streams of this command are the same terminal."""
    if sys.platform == "win32":  # a command has one console
        return True
    device_numbers = [os.fstat(stream.fileno()).st_rdev for stream in (sys.stdout, sys.stderr)]
    return device_numbers[0] == device_numbers[1]
