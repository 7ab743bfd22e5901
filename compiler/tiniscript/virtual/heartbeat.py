"""Keeps the dead-man timer of a robot alive whose time runs faster than real time.

A robot stops a tethered program after a second of its own time without a frame. If its second is
a hundredth of a real one, no computer is fast enough. So the computer's last frame is repeated:
the robot answers a repeated request again but never executes it twice. After a real second
without bytes from the computer the repetition ends, and the robot stops.
"""

from __future__ import annotations

HEARTBEAT_MS = 300  # of the robot's time
SILENT_S = 1.0
LONGEST = 100  # bytes of a frame on the wire, and some


class Heartbeat:
    def __init__(self) -> None:
        self._frame = b""  # the last one
        self._open = b""  # what has begun
        self._heard_s = 0.0
        self._heartbeat_ms = 0

    def hear(self, data: bytes, wall_s: float) -> None:
        """Take bytes that the computer has sent."""
        self._heard_s = wall_s
        *whole, self._open = (self._open + data).split(b"\0")
        self._open = self._open[:LONGEST]
        for each in whole:
            if each and len(each) < LONGEST:
                self._frame = each + b"\0"

    def forget(self) -> None:
        """Forget the last frame, because another client connects."""
        self._frame = self._open = b""

    def due(self, now_ms: int, wall_s: float) -> bytes:
        """Return the bytes to repeat at the robot's time `now_ms`, usually none."""
        is_silent = wall_s - self._heard_s > SILENT_S
        if self._open or is_silent or now_ms < self._heartbeat_ms + HEARTBEAT_MS:
            return b""
        self._heartbeat_ms = now_ms
        return self._frame
