"""A robot in a hurry, and a computer that is not: the seconds of both are reconciled here.

A robot stops what was started over its link when it has heard nothing for a second of its own
time. Where that is a hundredth of a real one, no computer is quick enough. So it hears the
computer's last frame again: a request that comes again is answered again and never done twice.
When the computer itself is silent for a second on the wall, there is nothing more to hear, and
the robot stops.
"""

from __future__ import annotations

BEAT_MS = 300  # of the robot's time
SILENT_S = 1.0
LONGEST = 100  # bytes of a frame on the wire, and some


class Heartbeat:
    def __init__(self) -> None:
        self._frame = b""  # the last one
        self._open = b""  # what has begun
        self._heard_s = 0.0
        self._beat_ms = 0

    def hear(self, data: bytes, wall_s: float) -> None:
        """The computer has sent bytes."""
        self._heard_s = wall_s
        *whole, self._open = (self._open + data).split(b"\0")
        self._open = self._open[:LONGEST]
        for each in whole:
            if each and len(each) < LONGEST:
                self._frame = each + b"\0"

    def forget(self) -> None:
        """Another computer comes."""
        self._frame = self._open = b""

    def due(self, now_ms: int, wall_s: float) -> bytes:
        """Return what the robot shall hear at its time `now_ms`, most often nothing."""
        is_silent = wall_s - self._heard_s > SILENT_S
        if self._open or is_silent or now_ms < self._beat_ms + BEAT_MS:
            return b""
        self._beat_ms = now_ms
        return self._frame
