"""What the terminal shows while something takes longer than a moment: a bar, or what is awaited."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from time import monotonic
from typing import TYPE_CHECKING

from tiniscript.cli.inputs import shown
from tiniscript.cli.streams import are_read
from tiniscript.cli.texts import text

if TYPE_CHECKING:
    from threading import Timer

BLINK_S = 0.3
COLUMNS = 30
MOST_PERCENT = 99  # of what is not done


class Progress:
    """Draws nothing during the first moment, and nothing without a terminal.

    The last percent is there when the line is cleared: what has arrived is not done yet.
    """

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
        percent = min(100 * done // self.whole, MOST_PERCENT)
        full = COLUMNS * percent // 100
        line = f"{self.label} [{'#' * full}{'.' * (COLUMNS - full)}] {percent:3} %"
        if line != self._drawn:
            self._drawn = line
            print("\r" + line, end="", file=sys.stderr, flush=True)

    def end(self) -> None:
        """Clear the line of the bar."""
        if self._drawn:
            print("\r" + " " * len(self._drawn) + "\r", end="", file=sys.stderr, flush=True)
            self._drawn = ""


class Doing:
    """The line on the terminal that says what is done just now."""

    def __init__(self, is_shown: bool = True) -> None:
        self._is_shown = is_shown and are_read(sys.stderr)

    def tell(self, said: str) -> None:
        if self._is_shown:
            print(f"\r\x1b[K{said}", end="", file=sys.stderr, flush=True)

    def end(self) -> None:
        self.tell("")


MOMENT_S = 2.0
PAUSE_S = 0.5  # between two waits: the person has typed or read something, so a new one begins


class Silence:
    """Somebody waits, and has been told nothing yet. Where nobody looks on, nothing is imported."""

    def __init__(self, said: str) -> None:
        self._timer: Timer | None = None
        if sys.stderr.isatty():
            import threading

            say = partial(print, said, file=sys.stderr, flush=True)
            self._timer = threading.Timer(MOMENT_S, say)
            self._timer.daemon = True
            self._timer.start()

    def cancel(self) -> None:
        if self._timer is not None:
            self._timer.cancel()


class Quiet:
    """The same for waits that follow each other: said once, until something else came between."""

    def __init__(self, said: str, is_seen: bool) -> None:
        self.before: Callable[[], None] = lambda: None  # clears the line of a bar
        self._said = said
        self._is_seen = is_seen and sys.stderr.isatty()
        self._since_s = self._until_s = monotonic()
        self._is_told = False

    def begin(self) -> None:
        """A wait begins."""
        if monotonic() - self._until_s > PAUSE_S:
            self._is_told = False
            self.note_news()

    def note_news(self) -> None:
        self._since_s = self._until_s = monotonic()

    def look(self) -> None:
        """The wait goes on."""
        self._until_s = monotonic()
        if self._is_told or not self._is_seen or self._until_s - self._since_s < MOMENT_S:
            return
        self._is_told = True
        self.before()
        print(self._said, file=sys.stderr, flush=True)


@contextmanager
def waiting(key: str, language: str, port: str) -> Iterator[Silence]:
    """Say the sentence `key` if this has not ended, nor been cancelled, in a moment."""
    silence = Silence(text(key, language).format(port=shown(port)))
    try:
        yield silence
    finally:
        silence.cancel()
