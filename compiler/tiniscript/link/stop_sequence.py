"""The stop sequence: repeated until the robot confirms it or a timeout has passed.

Knows when its bytes are due. `session` knows how a stop affects requests.
"""

from __future__ import annotations

from tiniscript.link.messages import STOP_BYTES

STOP_MS = 100  # between two stop sequences
CONFIRM_MS = 6000  # timeout: then other frames are sent again


class StopSequence:
    """`due_ms` is the time of the next stop sequence, or None if there is nothing to stop."""

    def __init__(self) -> None:
        self.due_ms: int | None = None
        self._began_ms = 0

    def begin(self, now_ms: int) -> None:
        self.due_ms = self._began_ms = now_ms

    def end(self) -> None:
        self.due_ms = None

    @property
    def is_sent(self) -> bool:
        """Whether a stop is active and was sent: an earlier event does not confirm it."""
        return self.due_ms is not None and self.due_ms > self._began_ms

    def is_due(self, now_ms: int) -> bool:
        return self.due_ms is not None and now_ms >= self.due_ms

    def is_over(self, now_ms: int) -> bool:
        return now_ms >= self._began_ms + CONFIRM_MS

    def sent(self, now_ms: int) -> bytes:
        """Return the bytes to send now."""
        self.due_ms = now_ms + STOP_MS
        return bytes(STOP_BYTES)
