"""Signals that end this process work as Ctrl-C does."""

from __future__ import annotations

import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


class EndRequest:
    """Whether a signal has asked the process to end."""

    def __init__(self) -> None:
        self.is_set = False

    def ask(self, *_: Any) -> None:
        """Handle a signal. A C callback may drop the exception, so a flag is set, too."""
        self.is_set = True
        raise KeyboardInterrupt


@contextmanager
def handle_signals() -> Iterator[EndRequest]:
    """A signal that ends this process works as Ctrl-C does, so that no files are left over."""
    end_request = EndRequest()
    numbers = (signal.SIGTERM, signal.SIGINT)
    hook_before = sys.unraisablehook

    def tell_others(dropped: sys.UnraisableHookArgs) -> None:
        if not issubclass(dropped.exc_type, KeyboardInterrupt):  # of which the flag is left
            hook_before(dropped)

    sys.unraisablehook = tell_others
    handlers_before = [signal.signal(number, end_request.ask) for number in numbers]
    try:
        yield end_request
    finally:
        sys.unraisablehook = hook_before
        for number, handler in zip(numbers, handlers_before, strict=True):
            signal.signal(number, handler)
