"""An event that wakes a thread waiting for another one, even when a signal interrupts it.

A Condition and an Event of `threading` are written in Python: a Ctrl-C inside them leaves their
lock held, or released twice. The main thread waits at a Bell, and holds a Lock or an RLock, which
are of the interpreter.
"""

from __future__ import annotations

# Threading has the same function, but takes a millisecond to import.
from _thread import allocate_lock
from collections.abc import Callable
from contextlib import suppress
from time import monotonic


class Bell:
    """Wakes one waiting thread; a ring without a waiting thread is kept for the next wait."""

    def __init__(self) -> None:
        self._silence = allocate_lock()
        self._silence.acquire()

    def ring(self) -> None:
        with suppress(RuntimeError):  # the bell has already rung, and no thread has heard it yet
            self._silence.release()

    def wait(self, timeout_s: float) -> bool:
        """Wait for a ring, at most so long; return whether there was one."""
        return self._silence.acquire(timeout=timeout_s)

    def wait_until(self, condition: Callable[[], bool], timeout_s: float) -> bool:
        """Wait for a condition, which a ring reports, until a timeout; return whether it is
        true.
        """
        end_s = monotonic() + timeout_s
        while not condition():
            left_s = end_s - monotonic()
            if left_s <= 0:
                return False
            self.wait(left_s)
        return True
