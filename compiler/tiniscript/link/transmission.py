"""A request in flight: one frame, repeated until it is answered. `window` has those of more.

Derives the timeout from the baud rate. Does not know what an answer means.
"""

from __future__ import annotations

from tiniscript.link.frames import Frame, encoded
from tiniscript.link.messages import BY_NAME, LARGE_FRAME, SMALL_FRAME
from tiniscript.link.seal import Seal

ROUND_MS = 120  # round trip through two radios and a robot, without the bytes
RETRY_MS = 80  # added for each try,
RETRY_STEPS = 6  # for this many tries at most
TRIES = 30


class Transmission:
    def __init__(self, baud: int, largest: int = SMALL_FRAME) -> None:
        """`largest` is how many bytes the frame of an answer has at most, before COBS."""
        self._baud = baud
        self._largest = min(max(largest, SMALL_FRAME), LARGE_FRAME)
        self.frame: Frame | None = None
        self.seal: Seal | None = None
        self.epoch = 0  # that the frame bears
        self.tries = 0
        self.due_ms = 0  # when the frame is sent or repeated

    def begin(self, frame: Frame, due_ms: int, seal: Seal | None = None) -> None:
        """Send a frame from then on: sealed anew, with a counter of its own, at each try."""
        self.frame = frame
        self.epoch = frame.epoch
        self.begin_again(due_ms, seal)

    def begin_again(self, due_ms: int, seal: Seal | None) -> None:
        """Send the same from then on, sealed otherwise."""
        self.seal = seal
        self.tries = 0
        self.due_ms = due_ms

    def end(self) -> None:
        self.frame = None

    @property
    def is_under_way(self) -> bool:
        return self.frame is not None

    def is_due(self, now_ms: int) -> bool:
        return self.is_under_way and now_ms >= self.due_ms

    def is_answered_by(self, frame: Frame) -> bool:
        """Return whether a reply belongs to this request; others are repeated answers."""
        ours = self.frame
        return ours is not None and (frame.number, frame.seq) == (ours.number, ours.seq)

    def sent(self, now_ms: int) -> bytes:
        """Return the bytes to send now."""
        assert self.frame is not None
        wire = encoded(self.frame if self.seal is None else self.seal.closed(self.frame))
        wait_ms = ROUND_MS + RETRY_MS * min(self.tries, RETRY_STEPS)
        wait_ms += -(-(len(wire) + self._largest + 2) * 10_000 // self._baud)
        # a 0x00 before a retry and before HELLO ends any partial item in the robot's receiver
        is_first = self.tries == 0 and self.frame.number != BY_NAME["HELLO"].number
        self.tries += 1
        self.due_ms = now_ms + wait_ms
        return wire if is_first else b"\0" + wire
