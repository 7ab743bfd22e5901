"""What is sent until it is answered: one frame, the pieces of a program, or a stop.

Derives the timeouts from the baud rate. Does not know what an answer means.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import NamedTuple

from tiniscript.link.frames import Frame, encoded
from tiniscript.link.messages import (
    BY_NAME,
    LARGE_FRAME,
    LARGE_WINDOW,
    SMALL_FRAME,
    STOP_BYTES,
    payload_bytes,
    written,
)
from tiniscript.link.requests import OFFSET_BYTES, Pieces
from tiniscript.link.seal import Seal
from tiniscript.link.sender import Sender

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
        self.is_sent = False  # a byte of it
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

    def renew(self, epoch: int, seq: int | None = None) -> None:
        """Give a frame of which no byte was sent the epoch in which it will be sent, and the
        number behind that of a frame which came before it.
        """
        if self.frame is not None and not (self.is_sent or self.is_of("AUTHENTICATE")):
            self.frame = self.frame._replace(
                epoch=epoch, seq=self.frame.seq if seq is None else seq
            )
            self.epoch = epoch

    def end(self) -> None:
        self.frame = None

    def is_of(self, name: str) -> bool:
        """Return whether a request of this name is under way."""
        return self.frame is not None and self.frame.number == BY_NAME[name].number

    @property
    def is_under_way(self) -> bool:
        return self.frame is not None

    def is_due(self, now_ms: int) -> bool:
        return self.is_under_way and now_ms >= self.due_ms

    def is_answered_by(self, frame: Frame) -> bool:
        """Return whether a reply belongs to this request; others are repeated answers."""
        ours = self.frame
        return ours is not None and (frame.number, frame.seq) == (ours.number, ours.seq)

    def sent(self, now_ms: int, sender: Sender) -> bytes:
        """Return the bytes to send now."""
        assert self.frame is not None
        wire = encoded(self.frame if self.seal is None else self.seal.closed(self.frame))
        wait_ms = ROUND_MS + RETRY_MS * min(self.tries, RETRY_STEPS)
        wait_ms += -(-(len(wire) + self._largest + 2) * 10_000 // self._baud)
        is_repeated = self.tries > 0 or self.frame.number == BY_NAME["HELLO"].number
        self.tries += 1
        self.is_sent = True
        self.due_ms = now_ms + wait_ms
        return sender.frames(wire, now_ms, is_repeated)


AHEAD_MS = 200  # a stop waits behind so much of the line's time at most
REPLY_BYTES = 32  # of DATA on the wire, and more
FRAME_BYTES = 24  # of DATA on the wire beside its piece, and more
_DATA = BY_NAME["DATA"]


class SentPiece(NamedTuple):
    seq: int
    end: int  # offset of the byte behind it


class Window(Transmission):
    def __init__(self, baud: int, pieces: Pieces, epoch: int, number: Callable[[], int]) -> None:
        """`number` returns the number of each frame: another one each time."""
        super().__init__(baud)
        self._data = pieces.data
        ahead = baud * AHEAD_MS // 10_000  # bytes
        small = payload_bytes(SMALL_FRAME) - OFFSET_BYTES
        self._most = min(pieces.most, max(small, ahead // 2 - FRAME_BYTES))
        fitting = ahead // (self._most + FRAME_BYTES)
        self._window = max(1, min(pieces.window, LARGE_WINDOW, fitting))
        self.epoch = epoch
        self._number = number
        self._next = 0  # what the robot wants next
        self._sent = 0  # offset of the byte behind the last one that was sent
        self._under_way: deque[SentPiece] = deque()
        self._lost_ms = 0  # when what is under way is taken for lost
        self._is_again = False
        self._is_over = False

    def begin_again(self, due_ms: int, seal: Seal | None) -> None:
        """Send what the robot has not taken, from then on."""
        super().begin_again(due_ms, seal)
        self._under_way.clear()
        self._sent = self._next

    @property
    def is_under_way(self) -> bool:
        return not self._is_over

    def end(self) -> None:
        self._is_over = True

    def is_answered_by(self, frame: Frame) -> bool:
        is_data = frame.number == _DATA.number and not self._is_over
        return is_data and any(piece.seq == frame.seq for piece in self._under_way)

    def sent(self, now_ms: int, sender: Sender) -> bytes:
        """Return the frames that may be sent now."""
        self.is_sent = True
        if self._under_way and now_ms >= self._lost_ms:
            self._go_back()
        wire = b""
        while self._sent < len(self._data) and len(self._under_way) < self._window:
            if self.seal is not None and self.seal.is_spent:
                break
            frame = self._frame(self._sent)
            wire += encoded(frame if self.seal is None else self.seal.closed(frame))
            self._sent = min(self._sent + self._most, len(self._data))
            self._under_way.append(SentPiece(frame.seq, self._sent))
        self._wait(now_ms)
        if not wire:
            return b""
        is_again, self._is_again = self._is_again, False
        return sender.frames(wire, now_ms, is_again)

    def take(self, frame: Frame, next_offset: int | None, now_ms: int) -> bool:
        """Take the reply to a frame that is under way; return whether all has arrived.

        `next_offset` of None: the robot has not looked at the frame, as a later one came before it.
        """
        if next_offset is not None and next_offset != self._next:
            self._next = next_offset
            self.tries = 0
        while self._under_way and self._under_way[0].end <= self._next:
            self._under_way.popleft()
        if any(piece.seq == frame.seq for piece in self._under_way):
            self._go_back()  # this one, or one before it, was not taken
        self._wait(now_ms)
        if self._sent < len(self._data) and len(self._under_way) < self._window:
            self.due_ms = now_ms
        return self._next >= len(self._data)

    def _go_back(self) -> None:
        self._under_way.clear()
        self._sent = self._next
        self._is_again = True
        self.tries += 1

    def _frame(self, at: int) -> Frame:
        values: dict[str, int | bytes] = {"offset": at, "bytes": self._data[at : at + self._most]}
        return Frame(_DATA.number, self._number(), self.epoch, written(_DATA.request, values))

    def _wait(self, now_ms: int) -> None:
        count = len(self._under_way)
        wire_ms = count * (self._most + FRAME_BYTES + REPLY_BYTES) * 10_000 // self._baud
        wait_ms = ROUND_MS + RETRY_MS * min(self.tries, RETRY_STEPS) + wire_ms
        self._lost_ms = self.due_ms = now_ms + wait_ms


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

    def sent(self, now_ms: int, sender: Sender) -> bytes:
        """Return the bytes to send now."""
        self.due_ms = now_ms + STOP_MS
        return sender.zeros(bytes(STOP_BYTES), now_ms)
