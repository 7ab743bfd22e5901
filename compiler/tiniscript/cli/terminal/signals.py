"""Signals that end this process work as Ctrl-C does."""

from __future__ import annotations

import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


class EndRequest:
    """A request by a signal to end the process."""

    def __init__(self) -> None:
        self.is_set = False

    def on_signal(self, *_: Any) -> None:
        """Handle a signal. A C callback may drop the exception, so a flag is set, too."""
        self.is_set = True
        raise KeyboardInterrupt


@contextmanager
def handle_signals() -> Iterator[EndRequest]:
    """A signal that ends this process works as Ctrl-C does, so that no files are left over."""
    end_request = EndRequest()
    signal_numbers = (signal.SIGTERM, signal.SIGINT)
    hook_before = sys.unraisablehook

    def on_unraisable(unraisable: sys.UnraisableHookArgs) -> None:
        # An interrupt only leaves its flag.
        if not issubclass(unraisable.exc_type, KeyboardInterrupt):
            hook_before(unraisable)

    sys.unraisablehook = on_unraisable
    handlers_before = [
        signal.signal(signal_number, end_request.on_signal) for signal_number in signal_numbers
    ]
    try:
        yield end_request
    finally:
        sys.unraisablehook = hook_before
        for signal_number, handler in zip(signal_numbers, handlers_before, strict=True):
            signal.signal(signal_number, handler)
