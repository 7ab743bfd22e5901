"""Saying what a command waits for, where that takes longer than a moment and a person looks on."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from typing import TYPE_CHECKING

from tiniscript.cli.inputs import shown
from tiniscript.cli.texts.common import text

if TYPE_CHECKING:
    from threading import Timer

MOMENT_S = 2.0


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


@contextmanager
def waiting(key: str, language: str, port: str) -> Iterator[Silence]:
    """Say the sentence `key` if this has not ended, nor been cancelled, in a moment."""
    silence = Silence(text(key, language).format(port=shown(port)))
    try:
        yield silence
    finally:
        silence.cancel()
