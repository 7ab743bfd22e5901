"""What the terminal shows while something takes longer than a moment: a bar, or what is awaited."""

from __future__ import annotations

import sys
from _thread import allocate_lock, start_new_thread
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic

from tiniscript.base.bell import Bell
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.streams import reads_sequences
from tiniscript.cli.texts import text

BLINK_INTERVAL_S = 0.3
BAR_COLUMNS = 30
MOST_PERCENT = 99  # of what is not done


class Progress:
    """Draws nothing during the first moment, and nothing without a terminal.

    The last percent is there when the line is cleared: what has arrived is not done yet.
    """

    def __init__(self, language: str, total: int) -> None:
        """`total` is the total, in any unit."""
        self.label = text("sending", language)
        self.whole = total
        self._begin_s = monotonic()
        self._is_seen = sys.stderr.isatty()
        self._drawn = ""
        self._is_there = False  # in the terminal's line

    def draw(self, done_units: int) -> bool:
        """Draw it where it has grown; return whether it has."""
        if not self._is_seen or not self.whole or monotonic() - self._begin_s < BLINK_INTERVAL_S:
            return False
        percent = min(100 * done_units // self.whole, MOST_PERCENT)
        full_columns = BAR_COLUMNS * percent // 100
        line = (
            f"{self.label} [{'#' * full_columns}{'.' * (BAR_COLUMNS - full_columns)}] {percent:3} %"
        )
        if line == self._drawn:
            return False
        self._drawn, self._is_there = line, True
        print("\r" + line, end="", file=sys.stderr, flush=True)
        return True

    def end(self) -> None:
        """Clear the line of the bar."""
        if self._is_there:
            print("\r" + " " * len(self._drawn) + "\r", end="", file=sys.stderr, flush=True)
            self._is_there = False


class Doing:
    """The line on the terminal that says what is done just now."""

    def __init__(self, is_shown: bool = True) -> None:
        self._is_shown = is_shown and reads_sequences(sys.stderr)

    def tell(self, sentence: str) -> None:
        if self._is_shown:
            print(f"\r\x1b[K{sentence}", end="", file=sys.stderr, flush=True)

    def end(self) -> None:
        self.tell("")


SILENCE_LIMIT_S = 2.0
# Between two waits: the person has typed or read something, so a new one begins.
NEW_WAIT_PAUSE_S = 0.5


class Silence:
    """Somebody waits, and has been told nothing yet, or `is_told`."""

    def __init__(self, sentence: str) -> None:
        self.is_told = False
        self._said = sentence
        self._is_over = Bell()
        self._is_cancelled = False
        self._printing = allocate_lock()
        if sys.stderr.isatty():
            start_new_thread(self._print_wait, ())  # a Thread waits, in Python, until it runs

    def _print_wait(self) -> None:
        if self._is_cancelled or self._is_over.wait(SILENCE_LIMIT_S):
            return
        with self._printing:
            if not self._is_cancelled:
                self.is_told = True
                print(self._said, file=sys.stderr, flush=True)

    def cancel(self) -> None:
        """From now on nothing is said."""
        self._is_over.ring()
        with self._printing:
            self._is_cancelled = True


class Quiet:
    """The same for waits that follow each other: said once, until something else came between."""

    def __init__(self, sentence: str, is_seen: bool) -> None:
        self.before: Callable[[], None] = lambda: None  # clears the line of a bar
        self._said = sentence
        self._is_seen = is_seen and sys.stderr.isatty()
        self._since_s = self._until_s = monotonic()
        self.is_told = False

    def begin(self) -> None:
        """A wait begins."""
        if monotonic() - self._until_s > NEW_WAIT_PAUSE_S:
            self.note_words()

    def note_words(self) -> None:
        """Something else was said, or typed."""
        self.is_told = False
        self.note_news()

    def note_told(self) -> None:
        """Another wait has said the same."""
        self.is_told = True
        self.note_news()

    def note_news(self) -> None:
        self._since_s = self._until_s = monotonic()

    def go_on(self) -> None:
        """The wait has ended, and nothing was said: what comes next is the same silence."""
        self._until_s = monotonic()

    def with_words(self, sentence: str) -> Quiet:
        """Return the same silence, of which something else is said."""
        quiet = Quiet(sentence, self._is_seen)
        quiet._since_s = self._since_s
        return quiet

    def look(self) -> None:
        """The wait goes on."""
        self._until_s = monotonic()
        if self.is_told or not self._is_seen or self._until_s - self._since_s < SILENCE_LIMIT_S:
            return
        self.is_told = True
        self.before()
        print(self._said, file=sys.stderr, flush=True)


@contextmanager
def show_wait(key: str, language: str, port: str = "") -> Iterator[Silence]:
    """Say the sentence `key` if this has not ended, nor been cancelled, in a moment."""
    silence = Silence(text(key, language).format(port=printable_name(port)))
    try:
        yield silence
    finally:
        silence.cancel()
