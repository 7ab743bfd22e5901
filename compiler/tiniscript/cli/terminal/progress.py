"""Progress on the terminal during long operations: a bar, or the name of the wait."""

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

DRAW_DELAY_S = 0.3
BAR_COLUMNS = 30
MAX_PERCENT = 99  # percent shown until the work is done


class Progress:
    """Draws nothing during the first moment, and nothing without a terminal.

    The line is cleared instead of showing 100 %: arrived data still has to be processed.
    """

    def __init__(self, language: str, total: int) -> None:
        """`total` is the total, in any unit."""
        self.label = text("sending", language)
        self.total = total
        self._begin_s = monotonic()
        self._is_terminal = sys.stderr.isatty()
        self._drawn_line = ""
        self._is_drawn = False  # whether the terminal's line shows it

    def draw(self, done_units: int) -> bool:
        """Draw it where it has grown; return whether it has."""
        if not self._is_terminal or not self.total or monotonic() - self._begin_s < DRAW_DELAY_S:
            return False
        percent = min(100 * done_units // self.total, MAX_PERCENT)
        full_columns = BAR_COLUMNS * percent // 100
        line = (
            f"{self.label} [{'#' * full_columns}{'.' * (BAR_COLUMNS - full_columns)}] {percent:3} %"
        )
        if line == self._drawn_line:
            return False
        self._drawn_line, self._is_drawn = line, True
        print("\r" + line, end="", file=sys.stderr, flush=True)
        return True

    def end(self) -> None:
        """Clear the line of the bar."""
        if self._is_drawn:
            print("\r" + " " * len(self._drawn_line) + "\r", end="", file=sys.stderr, flush=True)
            self._is_drawn = False


class StatusLine:
    """The line on the terminal about the current action."""

    def __init__(self, is_shown: bool = True) -> None:
        self._is_shown = is_shown and reads_sequences(sys.stderr)

    def show(self, sentence: str) -> None:
        if self._is_shown:
            print(f"\r\x1b[K{sentence}", end="", file=sys.stderr, flush=True)

    def end(self) -> None:
        self.show("")


SILENCE_LIMIT_S = 2.0
# After the person has typed or read something, the next wait counts as a new one.
NEW_WAIT_PAUSE_S = 0.5


class WaitNotice:
    """A person waits, and has seen no message yet, or `is_told`."""

    def __init__(self, sentence: str) -> None:
        self.is_told = False
        self._sentence = sentence
        self._end_bell = Bell()
        self._is_cancelled = False
        self._print_lock = allocate_lock()
        self._thread_lock = allocate_lock()  # held until the thread has ended
        if sys.stderr.isatty():
            self._thread_lock.acquire()
            start_new_thread(self._run, ())  # a Thread waits, in Python, until it runs

    def _run(self) -> None:
        try:
            self._print_wait()
        finally:
            self._thread_lock.release()

    def _print_wait(self) -> None:
        if self._is_cancelled or self._end_bell.wait(SILENCE_LIMIT_S):
            return
        with self._print_lock:
            if not self._is_cancelled:
                self.is_told = True
                print(self._sentence, file=sys.stderr, flush=True)

    def cancel(self) -> None:
        """Print nothing from now on."""
        self._end_bell.ring()
        with self._print_lock:
            self._is_cancelled = True
        with self._thread_lock:  # a thread that starts while Python exits crashes it (3.11)
            pass


class RepeatedWaitNotice:
    """A notice for successive waits, printed again only after other output."""

    def __init__(self, sentence: str, is_seen: bool) -> None:
        self.before_print: Callable[[], None] = lambda: None  # clears the line of a bar
        self._sentence = sentence
        self._is_terminal = is_seen and sys.stderr.isatty()
        self._since_s = self._until_s = monotonic()
        self.is_told = False

    def begin(self) -> None:
        """A wait begins."""
        if monotonic() - self._until_s > NEW_WAIT_PAUSE_S:
            self.note_other_output()

    def note_other_output(self) -> None:
        """Call this when other output was printed, or something was typed."""
        self.is_told = False
        self.restart()

    def note_told(self) -> None:
        """Another wait has said the same."""
        self.is_told = True
        self.restart()

    def restart(self) -> None:
        self._since_s = self._until_s = monotonic()

    def end_wait(self) -> None:
        """End the wait without a message, so that the next silence continues it."""
        self._until_s = monotonic()

    def with_sentence(self, sentence: str) -> RepeatedWaitNotice:
        """Return a notice about the same silence with another sentence."""
        notice = RepeatedWaitNotice(sentence, self._is_terminal)
        notice._since_s = self._since_s
        return notice

    def poll(self) -> None:
        """Continue the wait."""
        self._until_s = monotonic()
        if self.is_told or not self._is_terminal or self._until_s - self._since_s < SILENCE_LIMIT_S:
            return
        self.is_told = True
        self.before_print()
        print(self._sentence, file=sys.stderr, flush=True)


@contextmanager
def show_wait(key: str, language: str, port: str = "") -> Iterator[WaitNotice]:
    """Say the sentence `key` if this has not ended, nor been cancelled, in a moment."""
    notice = WaitNotice(text(key, language).format(port=printable_name(port)))
    try:
        yield notice
    finally:
        notice.cancel()
