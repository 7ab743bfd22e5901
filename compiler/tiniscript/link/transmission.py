"""Transmissions that wait for an answer: a frame, the pieces of a program, or a stop.

Does not know the meaning of answers; `round_trips` knows how long one may take.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import NamedTuple

from tiniscript.link.frames import Frame, encode_frame
from tiniscript.link.messages import (
    BY_NAME,
    CRC_BYTES,
    HEAD_BYTES,
    LARGE_FRAME,
    LARGE_WINDOW,
    SMALL_FRAME,
    STOP_BYTES,
    encode_payload,
    payload_bytes,
)
from tiniscript.link.requests import OFFSET_BYTES, Pieces
from tiniscript.link.round_trips import RoundTrips
from tiniscript.link.seal import Seal
from tiniscript.link.sender import Sender

TRIES = 30  # tries without progress
LONG_TRIES = 1  # tries of a long frame before several are sent at a time


class Transmission:
    def __init__(
        self,
        round_trips: RoundTrips,
        answer_bytes: int = SMALL_FRAME,
        ends_when_silent: bool = False,
    ) -> None:
        """`answer_bytes` is the maximum length of the frame of an answer, before COBS;
        `ends_when_silent`: the robot runs a program that ends in silence.
        """
        self._round_trips = round_trips
        self._ends_when_silent = ends_when_silent
        self._answer_bytes = min(max(answer_bytes, SMALL_FRAME), LARGE_FRAME)
        self.frame: Frame | None = None
        self.seal: Seal | None = None
        self.epoch = 0  # epoch in the frame
        self.tries = 0
        self.is_sent = False  # a byte of it
        self.due_ms = 0  # when the frame is sent or repeated
        self._began_ms = 0  # when the frame was first sent
        self._wire_bytes = 0

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
        """Set the epoch of an unsent frame, and its number after that of an earlier frame."""
        if self.frame is not None and not (self.is_sent or self.is_of("AUTHENTICATE")):
            self.frame = self.frame._replace(
                epoch=epoch, seq=self.frame.seq if seq is None else seq
            )
            self.epoch = epoch

    def set_payload(self, payload: bytes) -> None:
        """Set the payload, of which no byte has been sent."""
        assert self.frame is not None and not self.is_sent
        self.frame = self.frame._replace(payload=payload)

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

    def is_late(self, now_ms: int) -> bool:
        """Return whether its answer has not come in time."""
        return self.is_sent and self.is_due(now_ms)

    def is_answered_by(self, frame: Frame) -> bool:
        """Return whether a reply belongs to this request; others are repeated answers."""
        own_frame = self.frame
        return own_frame is not None and (frame.number, frame.seq) == (
            own_frame.number,
            own_frame.seq,
        )

    def learn_round_trip(self, reply: Frame, now_ms: int) -> None:
        """Learn from an answer how long one takes."""
        if self.tries == 0:
            return  # no part of the frame was sent, so this answers another one
        byte_count = self._wire_bytes + HEAD_BYTES + len(reply.payload) + CRC_BYTES
        self._round_trips.add_round_trip(now_ms - self._began_ms, byte_count, self.tries == 1)

    def bytes_to_send(self, now_ms: int, sender: Sender) -> bytes:
        """Return the bytes to send now."""
        assert self.frame is not None
        wire = encode_frame(self.frame if self.seal is None else self.seal.seal_frame(self.frame))
        is_hello = self.is_of("HELLO")  # HELLO may look for a robot that is not there yet
        if self.tries > 0:
            self._round_trips.back_off()
        else:
            self._began_ms, self._wire_bytes = now_ms, len(wire)
        self.tries += 1
        self.is_sent = True
        for _ in range(self._copy_count(len(wire))):
            wire += encode_frame(
                self.frame if self.seal is None else self.seal.seal_frame(self.frame)
            )
        byte_count = len(wire) + self._answer_bytes + 2
        self.due_ms = now_ms + self._round_trips.wait_ms(
            byte_count, self._ends_when_silent or is_hello
        )
        return sender.prepare_frames(wire, now_ms, self.tries > 1 or is_hello)

    def _copy_count(self, wire_bytes: int) -> int:
        """Return the number of extra copies of a frame. On a line that loses bytes, few long frames
        arrive whole, so it sends as many as fit into half the wait; the robot executes one and
        answers each.
        """
        if wire_bytes <= SMALL_FRAME + WIRE_BYTES or self.tries <= LONG_TRIES:
            return 0
        wait_ms = self._round_trips.wait_ms(
            wire_bytes + self._answer_bytes + 2, self._ends_when_silent
        )
        return max(0, self._round_trips.bytes_in(wait_ms // 2) // wire_bytes - 1)


WIRE_BYTES = 4  # extra bytes of a frame on the wire: COBS and the zeros
MAX_QUEUED_MS = 200  # longest wait of a stop, in terms of the port's time
SLOW_MS = 1000  # extra time for a slow line after its port
REPLY_BYTES = 32  # bytes of a DATA reply on the wire, at most
FRAME_BYTES = 24  # bytes of DATA on the wire beside its piece, at most
MIN_BYTES = 8  # shortest piece, for lines that lose longer ones
MORE_BYTES = 8  # bytes by which the next piece grows after a success
MAX_REMEMBERED_PIECES = 64  # pieces that were sent last: their answers may be late
_DATA = BY_NAME["DATA"]


class SentPiece(NamedTuple):
    seq: int
    end: int  # offset of the byte after it
    sent_ms: int
    wire_bytes: int  # including the bytes of its answer


class Window(Transmission):
    """The pieces of a program. A late answer counts like one in time: if the line is slower than
    expected, only one piece is sent twice, not everything under way.
    """

    def __init__(
        self,
        baud: int,
        round_trips: RoundTrips,
        pieces: Pieces,
        epoch: int,
        next_number: Callable[[], int],
    ) -> None:
        """`next_number` returns the number of each frame: another one each time."""
        super().__init__(round_trips)
        self._data = pieces.data
        queued_bytes = baud * MAX_QUEUED_MS // 10_000  # bytes
        small_piece_bytes = payload_bytes(SMALL_FRAME) - OFFSET_BYTES
        self._longest_piece_bytes = self._piece_bytes = min(
            pieces.piece_bytes, max(small_piece_bytes, queued_bytes // 2 - FRAME_BYTES)
        )
        fitting_count = queued_bytes // (self._piece_bytes + FRAME_BYTES)
        self._window = self._allowed_count = max(1, min(pieces.window, LARGE_WINDOW, fitting_count))
        self.epoch = epoch
        self._next_number = next_number
        # Room for data under way, including its answers.
        self._room_bytes = round_trips.bytes_in(SLOW_MS)
        self._next_offset = 0  # the offset that the robot expects next
        self._sent_offset = 0  # offset of the byte after the last one that was sent
        self._sent_pieces: deque[SentPiece] = deque()
        self._lost_pieces: deque[SentPiece] = deque(maxlen=MAX_REMEMBERED_PIECES)  # taken for lost
        self._lost_ms = 0  # when data under way counts as lost
        self._is_repeated = False
        self._is_over = False

    def begin_again(self, due_ms: int, seal: Seal | None) -> None:
        """From then on, send the bytes that the robot has not accepted."""
        super().begin_again(due_ms, seal)
        self._sent_pieces.clear()
        self._lost_pieces.clear()
        self._sent_offset = self._next_offset

    @property
    def is_under_way(self) -> bool:
        return not self._is_over

    def end(self) -> None:
        self._is_over = True

    def is_answered_by(self, frame: Frame) -> bool:
        is_data = frame.number == _DATA.number and not self._is_over
        return is_data and any(
            piece.seq == frame.seq for piece in (*self._sent_pieces, *self._lost_pieces)
        )

    def learn_round_trip(self, reply: Frame, now_ms: int) -> None:
        """Learn from an answer how long one takes: each sending has a number of its own."""
        for piece in (*self._lost_pieces, *self._sent_pieces):
            if piece.seq == reply.seq:
                took_ms = now_ms - piece.sent_ms
                self._round_trips.add_round_trip(took_ms, piece.wire_bytes, is_certain=True)
                is_quick = took_ms <= (self._round_trips.least_ms or 0) + SLOW_MS
                self._room_bytes = max(
                    0, self._room_bytes + (piece.wire_bytes if is_quick else -piece.wire_bytes)
                )

    def bytes_to_send(self, now_ms: int, sender: Sender) -> bytes:
        """Return the frames that may be sent now."""
        self.is_sent = True
        if self._sent_pieces and now_ms >= self._lost_ms:
            self._go_back()
            self._allowed_count = 1
            self._round_trips.back_off()
        wire = b""
        while (length := self._next_bytes()) > 0:
            if self.seal is not None and self.seal.is_spent:
                break
            frame = self._frame(self._sent_offset, length)
            wire += encode_frame(frame if self.seal is None else self.seal.seal_frame(frame))
            self._sent_offset += length
            wire_bytes = len(frame.payload) + FRAME_BYTES + REPLY_BYTES
            self._sent_pieces.append(SentPiece(frame.seq, self._sent_offset, now_ms, wire_bytes))
        self._set_due_time(now_ms)
        if not wire:
            return b""
        is_repeated, self._is_repeated = self._is_repeated, False
        return sender.prepare_frames(wire, now_ms, is_repeated)

    def take_reply(self, frame: Frame, next_offset: int | None, now_ms: int) -> bool:
        """Take the reply to a frame that was sent; return whether all has arrived.

        A `next_offset` of None: the robot has not processed the frame, because a later one arrived
        before it.
        """
        has_come = next_offset is not None and next_offset > self._next_offset
        if next_offset is not None and has_come:
            self._next_offset = next_offset
            self._sent_offset = max(self._sent_offset, next_offset)
            self.tries = 0
            self._piece_bytes = min(self._piece_bytes + MORE_BYTES, self._longest_piece_bytes)
            self._allowed_count = min(self._allowed_count + 1, self._window)
        while self._sent_pieces and self._sent_pieces[0].end <= self._next_offset:
            self._sent_pieces.popleft()
        if any(piece.seq == frame.seq for piece in self._sent_pieces):
            self._go_back()  # this one, or one before it, was not taken
        elif not has_come:
            return False  # late, and known
        self._set_due_time(now_ms)
        if self._next_bytes() > 0:
            self.due_ms = now_ms
        return self._next_offset >= len(self._data)

    def _go_back(self) -> None:
        self._lost_pieces += self._sent_pieces
        self._sent_pieces.clear()
        self._sent_offset = self._next_offset
        self._is_repeated = True
        self.tries += 1
        if self.tries > 1:
            self._piece_bytes = max(
                min(MIN_BYTES, self._longest_piece_bytes), self._piece_bytes // 2
            )

    def _next_bytes(self) -> int:
        """Return the length of the next piece, or 0 while none may be sent."""
        length = min(self._piece_bytes, len(self._data) - self._sent_offset)
        room = (
            self._room_bytes
            - self._count_bytes_under_way()
            - FRAME_BYTES
            - REPLY_BYTES
            - OFFSET_BYTES
        )
        if not self._sent_pieces:
            return min(length, max(room, MIN_BYTES))
        return length if len(self._sent_pieces) < self._allowed_count and room >= length else 0

    def _frame(self, offset: int, length: int) -> Frame:
        values: dict[str, int | bytes] = {
            "offset": offset,
            "bytes": self._data[offset : offset + length],
        }
        return Frame(
            _DATA.number, self._next_number(), self.epoch, encode_payload(_DATA.request, values)
        )

    def _count_bytes_under_way(self) -> int:
        """Return the bytes under way, including their answers."""
        return sum(piece.wire_bytes for piece in self._sent_pieces)

    def _set_due_time(self, now_ms: int) -> None:
        wait_ms = self._round_trips.wait_ms(self._count_bytes_under_way())
        self._lost_ms = self.due_ms = now_ms + wait_ms


STOP_MS = 100  # between two stop sequences
CONFIRM_MS = 6000  # timeout: then other frames are sent again


class StopSender:
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
        """Return whether a stop was sent and is active, so that earlier events do not confirm
        it.
        """
        return self.due_ms is not None and self.due_ms > self._began_ms

    def is_due(self, now_ms: int) -> bool:
        return self.due_ms is not None and now_ms >= self.due_ms

    def is_over(self, now_ms: int) -> bool:
        return now_ms >= self._began_ms + CONFIRM_MS

    def bytes_to_send(self, now_ms: int, sender: Sender) -> bytes:
        """Return the bytes to send now."""
        self.due_ms = now_ms + STOP_MS
        return sender.prepare_stop(bytes(STOP_BYTES), now_ms)
