"""Splits bytes into packets: frames, lines of text, and the zeros that stop a robot.

Everything is text until a 0x00. After a 0x00 everything is frames, until a second passes without a
byte. A frame ends with 0x00. In frames, CR or LF after one or more bytes that since the last 0x00
are all 0x20 to 0x7e ends a line of text, and more text may follow.

Knows where a packet begins and ends; `frames` checks whether a frame is undamaged. Holds one packet
until it is taken, or several frames; packets that find no place are dropped, a stop is not. In C++
it is `vm_arduino/src/link/receiver.cpp`, where bytes come in an interrupt; members with the same
name do the same, and `tests/project/test_twins.py` lists the rest.
"""

from __future__ import annotations

from collections import deque
from enum import Enum, auto
from typing import NamedTuple

from tiniscript.link.messages import HEAD_BYTES, LARGE_FRAME, SILENCE_MS, SMALL_FRAME, STOP_ZEROS

# A frame and the first byte of its COBS. A packet that begins with a byte of more than LARGE_FIRST
# is no large frame.
SMALL_PACKET, LARGE_PACKET = SMALL_FRAME + 1, LARGE_FRAME + 1
LARGE_FIRST = HEAD_BYTES + 1
BYTE_ORDER_MARK = b"\xef\xbb\xbf"
LINE_ENDS = b"\r\n"


class Mode(Enum):
    TEXT = auto()  # text, between lines or inside one
    LOST = auto()  # a text line that is too long to keep
    BEGIN = auto()  # after a 0x00, before the next byte
    LINE = auto()  # only printable bytes since a 0x00, so a line of text or a frame
    FRAME = auto()  # inside a frame


class Packet(NamedTuple):
    """A frame before it is decoded, or the beginning of a line of text of `length` bytes."""

    is_text: bool
    data: bytes
    length: int


class Receiver:
    def __init__(self, most_bytes: int = LARGE_PACKET, window: int = 1) -> None:
        """A frame has `most_bytes` on the wire, without its 0x00; `window` of them may wait."""
        self.packet: Packet | None = None
        self.damaged_count = 0  # packets that were cut, too long, or ended by silence
        self.dropped_count = 0  # packets that arrived while one was waiting
        self._mode = Mode.TEXT
        self._zeros = StopSequence()
        self._keys = KeySequence()
        self._data = bytearray()  # bytes of the open packet that fit
        self._length = 0  # length of the open packet; 0 between packets
        self._is_dropping = False  # the open packet has found no place, or is too long for a frame
        self._is_cut = False  # a 0x00 has cut a line: the rest of it is lost
        self._frame_bytes = most_bytes
        self._window = window
        self._waiting_frames: deque[Packet] = deque()  # frames after the packet that waits
        self._last_ms = 0

    def take(self) -> Packet | None:
        """Return the waiting packet, if there is one, and make room for the next."""
        packet = self.packet
        self.packet = self._waiting_frames.popleft() if self._waiting_frames else None
        return packet

    def put(self, byte: int, now_ms: int) -> bool:
        """Take a byte; return whether it completes a stop sequence.

        A byte with a framing error counts as 0.
        """
        if now_ms - self._last_ms >= SILENCE_MS:
            self._end_silence()
        self._last_ms = now_ms
        if byte == 0:
            self._put_zero()
        elif self._mode in (Mode.TEXT, Mode.LOST):
            self._put_text(byte)
        else:
            self._put_packet(byte)
        return self._zeros.put(byte)

    def _end_silence(self) -> None:
        self._zeros.begin()
        self._keys.begin()
        if self._mode not in (Mode.TEXT, Mode.LOST):
            self._cut_packet()
            self._mode, self._is_cut = Mode.TEXT, False

    def _put_zero(self) -> None:
        if self._mode is Mode.FRAME:
            self._end_packet(is_text=False)
            self._is_cut = False
        elif self._length:  # a line, which no 0x00 ends
            self._cut_packet()
            self._is_cut = True
        self._mode = Mode.BEGIN

    def _put_text(self, byte: int) -> None:
        if byte in LINE_ENDS:
            self._end_line()
        elif not self._keys.put(byte) and (self._length or not _is_skipped(byte)):
            if not self._length:
                self._begin_packet()
                self._mode = Mode.LOST if self._is_dropping else Mode.TEXT
            self._add(byte)

    def _put_packet(self, byte: int) -> None:
        if self._mode is Mode.LINE and byte in LINE_ENDS:
            self._end_line()
            return
        if self._mode is Mode.BEGIN:
            self._begin_packet()
            self._mode = Mode.LINE
        if not _is_printable(byte):
            self._mode = Mode.FRAME
        self._add(byte)
        if self._length > self._most_bytes() and not self._is_dropping:
            self._is_dropping = True
            self.damaged_count += 1

    def _begin_packet(self) -> None:
        self._is_dropping = not self._has_place()
        self.dropped_count += self._is_dropping
        self._data.clear()

    def _add(self, byte: int) -> None:
        if not self._data or len(self._data) < self._most_bytes():
            self._data.append(byte)
        self._length += 1

    def _end_line(self) -> None:
        if self._length and not self._is_cut:
            self._end_packet(is_text=True)
        self._mode, self._length, self._is_cut = Mode.TEXT, 0, False
        self._keys.begin()

    def _end_packet(self, is_text: bool) -> None:
        packet = Packet(is_text, bytes(self._data), self._length)
        self._length = 0
        if self._is_dropping:
            return
        if self.packet is None:
            self.packet = packet
        elif is_text:  # it would overtake other text
            self.dropped_count += 1
        else:
            self._waiting_frames.append(packet)

    def _cut_packet(self) -> None:
        """End the open packet, if there is one, before its end."""
        self.damaged_count += self._length > 0
        self._length = 0

    def _has_place(self) -> bool:
        """Return whether a packet that begins now may wait: frames may, but nothing after text."""
        if self.packet is None:
            return True
        return not self.packet.is_text and len(self._waiting_frames) < self._window - 1

    def _most_bytes(self) -> int:
        return self._frame_bytes if self._data[0] <= LARGE_FIRST else SMALL_PACKET


class StopSequence:
    """The stop sequence: four zeros in a row are a stop, eight are two."""

    def __init__(self) -> None:
        self._count = 0

    def begin(self) -> None:
        self._count = 0

    def put(self, byte: int) -> bool:
        """Take a byte; return whether it completes one."""
        self._count = (self._count + 1) % STOP_ZEROS if byte == 0 else 0
        return byte == 0 and self._count == 0


class KeySequence:
    """Finds the sequences that a terminal sends for a cursor key: ESC [ A, ESC O A, ESC [ 1 ; 5
    C."""

    def __init__(self) -> None:
        self._is_escape = False  # an ESC alone is no sequence yet
        self._is_inside = False

    def begin(self) -> None:
        self._is_escape = self._is_inside = False

    def put(self, byte: int) -> bool:
        """Take a byte; return whether it belongs to a key, or may."""
        was_escape, was_inside = self._is_escape, self._is_inside
        self._is_escape = byte == 0x1B
        is_begun = was_escape and byte in b"[O"
        self._is_inside = is_begun or (was_inside and 0x20 <= byte < 0x40)
        return self._is_escape or is_begun or (was_inside and _is_printable(byte))


def _is_printable(byte: int) -> bool:
    return 0x20 <= byte <= 0x7E


def _is_skipped(byte: int) -> bool:
    """Return whether a byte between two lines belongs to neither."""
    return byte <= 0x20 or byte == 0x7F or byte in BYTE_ORDER_MARK
