"""A progress bar on the terminal for tasks that take longer than a moment."""

from __future__ import annotations

import sys
from time import monotonic

from tiniscript.cli.texts.common import text

BLINK_S = 0.3
COLUMNS = 30


class Progress:
    """Draws nothing during the first moment, and nothing without a terminal."""

    def __init__(self, language: str, whole: int) -> None:
        """`whole` is the total, in any unit."""
        self.label = text("sending", language)
        self.whole = whole
        self._begin_s = monotonic()
        self._is_seen = sys.stderr.isatty()
        self._drawn = ""

    def draw(self, done: int) -> None:
        if not self._is_seen or not self.whole or monotonic() - self._begin_s < BLINK_S:
            return
        full = COLUMNS * done // self.whole
        percent = 100 * done // self.whole
        line = f"{self.label} [{'#' * full}{'.' * (COLUMNS - full)}] {percent:3} %"
        if line != self._drawn:
            self._drawn = line
            print("\r" + line, end="", file=sys.stderr, flush=True)

    def end(self) -> None:
        """Clear the line of the bar."""
        if self._drawn:
            print("\r" + " " * len(self._drawn) + "\r", end="", file=sys.stderr, flush=True)
            self._drawn = ""
