"""Puts a 0x00 before frames where the robot may not be waiting for one.

After a second of silence a robot takes all bytes for text, and the last bytes that it received may
be half a frame. It knows no clock and no frames.
"""

from __future__ import annotations

from tiniscript.link.messages import ZERO_MS


class Sender:
    def __init__(self) -> None:
        self._sent_ms: int | None = None  # time of the last transmission
        self._are_zeros = False  # whether it was a stop sequence

    def prepare_frames(self, frames: bytes, now_ms: int, is_repeated: bool = False) -> bytes:
        """Return the bytes to send now for frames that each end with a 0x00.

        `is_repeated`: the first was sent before, or is HELLO, which begins anew.
        """
        sent_ms, are_zeros = self._sent_ms, self._are_zeros
        self._sent_ms, self._are_zeros = now_ms, False
        is_silent = sent_ms is None or now_ms - sent_ms >= ZERO_MS
        return b"\0" + frames if is_silent or (is_repeated and not are_zeros) else frames

    def prepare_stop(self, zeros: bytes, now_ms: int) -> bytes:
        """Return a stop sequence, sent now: no further 0x00 is needed after it."""
        self._sent_ms, self._are_zeros = now_ms, True
        return zeros
