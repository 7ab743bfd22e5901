"""Saying what a command waits for, where that takes longer than a moment and a person looks on."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Timer

from tiniscript.cli.inputs import shown
from tiniscript.cli.texts.common import text

MOMENT_S = 2.0


@contextmanager
def waiting(key: str, language: str, port: str) -> Iterator[Timer]:
    """Say the sentence `key` if this has not ended, nor been cancelled, in a moment."""
    said = text(key, language).format(port=shown(port))
    timer = Timer(MOMENT_S, lambda: print(said, file=sys.stderr, flush=True))
    timer.daemon = True
    if sys.stderr.isatty():
        timer.start()
    try:
        yield timer
    finally:
        timer.cancel()
