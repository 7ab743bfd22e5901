"""Splits bytes into packets: frames, lines of text, and the run of zeros that stops a robot.

Knows where a packet begins and ends; `frames` checks whether a frame is undamaged. Holds one packet
until it is taken, or several frames; packets that find no place are dropped, a stop is not.
The C++ version is `vm_arduino/src/link/receiver.cpp`.
"""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

from tiniscript.link.messages import (
    HEAD_BYTES,
    LARGE_FRAME,
    SILENCE_MS,
    SMALL_FRAME,
    STOP_RUN,
    TEXT_FROM,
)

# A frame and the first byte of its COBS. A packet that begins with a byte of more than LARGE_FIRST
# is no large frame.
SMALL_PACKET, LARGE_PACKET = SMALL_FRAME + 1, LARGE_FRAME + 1
LARGE_FIRST = HEAD_BYTES + 1
LONGEST = 255  # a longer text counts as this long

# places in the stream
_BEGIN = "begin"  # the next byte begins a packet
_AFTER_TEXT = "after text"  # the same, but white space is skipped
_BLANK = "blank"  # after white space, which may also be the first byte of a frame
_CR, _CR_LF = "cr", "cr lf"  # the same after CR, and after CR and LF
_HEAD = "head"  # after the first byte of a frame or of a line of text
_LINE = "line"  # probably in a line of text; otherwise in a frame
_FRAME = "frame"
_OTHER = "other"  # probably in a line of text; otherwise in noise
_TEXT = "text"
_SKIP = "skip"  # in noise, up to the next 0x00

_BLANKS = (_BLANK, _CR, _CR_LF)
_MAYBE_FRAME = (*_BLANKS, _HEAD, _LINE, _FRAME)
_LETTERS = b"abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
_DELETE = 0x7F


class Packet(NamedTuple):
    """A frame before it is decoded, or the beginning of a line of text of `length` bytes."""

    is_text: bool
    data: bytes
    length: int


class Receiver:
    def __init__(self, most_bytes: int = LARGE_PACKET, window: int = 1) -> None:
        """A frame has `most_bytes` on the wire, without its 0x00; `window` of them may wait."""
        self.packet: Packet | None = None
        self.damaged = 0  # packets that were cut, too long, or invalid
        self.dropped = 0  # packets that arrived while one was waiting
        self._place = _BEGIN
        self._data = bytearray()
        self._length = 0
        self._is_dropping = False
        self._most_bytes = most_bytes
        self._window = window
        self._behind: deque[Packet] = deque()  # frames behind the packet that waits
        self._zeros = 0
        self._last_ms = 0

    def take(self) -> Packet | None:
        """Return the waiting packet, if there is one, and make room for the next."""
        packet, self.packet = self.packet, self._behind.popleft() if self._behind else None
        return packet

    def put(self, byte: int, now_ms: int) -> bool:
        """Take a byte; return whether it completes a run of four zeros, which is a stop.

        Eight zeros are two stops. A byte with a framing error counts as 0.
        """
        is_quiet = (now_ms - self._last_ms) % 0x10000 >= SILENCE_MS
        self._last_ms = now_ms
        if is_quiet:
            self._cut()
            self._zeros = 0
        if byte == 0:
            return self._zero()
        self._zeros = 0
        if self._place in _BLANKS:
            # the second byte of a request is its type, and no frame of a robot begins like this
            if _is_printable(byte) and byte < 0x80:
                self._place = _AFTER_TEXT
            elif self._place == _CR and byte == 0x0A:
                self._place = _CR_LF
                self._add(byte)
                return False
            else:
                self._place = _FRAME
                self.dropped += self._is_dropping
        if self._place == _AFTER_TEXT and byte in b" \t\r\n":
            return False
        if self._place in (_BEGIN, _AFTER_TEXT):
            self._begin(byte)
        else:
            self._go_on(byte)
        return False

    def _begin(self, byte: int) -> None:
        """Classify a packet by its first byte, as far as possible."""
        self._is_dropping = not self._has_place()
        self._data.clear()
        self._length = 0
        if byte == _DELETE:
            self._skip()
            return
        if byte in _LETTERS:
            self._place = _TEXT
        elif byte >= TEXT_FROM:
            self._place = _OTHER
        elif byte in b" \t\r\n":
            self._place = _CR if byte == 0x0D else _BLANK
        else:
            self._place = _HEAD if byte > 0x20 else _FRAME
        self.dropped += self._place not in _BLANKS and self._is_dropping
        self._add(byte)

    def _go_on(self, byte: int) -> None:
        """Take a byte of a packet that has begun."""
        is_text = _is_printable(byte) or byte == 0x09
        if self._place == _SKIP:
            return
        if self._place == _HEAD:  # the type of a request is smaller
            self._place = _LINE if _is_printable(byte) else _FRAME
        elif self._place != _FRAME and byte in b"\r\n":
            self._end(is_text=True)
            self._place = _AFTER_TEXT
            return
        elif self._place == _LINE and not is_text:
            self._place = _FRAME
        elif self._place == _OTHER and not is_text:
            self._skip()
            return
        if self._length == self._room() and not self._is_dropping:
            if self._place == _FRAME:
                self._skip()
                return
            self._place = _TEXT
        self._add(byte)

    def _skip(self) -> None:
        self.damaged += 1
        self._place = _SKIP

    def _add(self, byte: int) -> None:
        if len(self._data) < self._room():
            self._data.append(byte)
        self._length = min(self._length + 1, LONGEST)

    def _zero(self) -> bool:
        if self._place in _MAYBE_FRAME:
            self._end(is_text=False)
            self._place = _BEGIN
        else:
            self._cut()
        self._zeros = (self._zeros + 1) % STOP_RUN  # the next four are another stop
        return self._zeros == 0

    def _cut(self) -> None:
        """Drop the open packet, which has not ended, and begin a new one."""
        self.damaged += self._place in (*_MAYBE_FRAME, _OTHER, _TEXT)
        self._place = _BEGIN

    def _end(self, is_text: bool) -> None:
        if self._is_dropping:
            return
        packet = Packet(is_text, bytes(self._data), self._length)
        if self.packet is None:
            self.packet = packet
        elif is_text:  # it would come before its turn
            self.dropped += 1
        else:
            self._behind.append(packet)

    def _has_place(self) -> bool:
        """Return whether a packet that begins now may wait: frames do, and nothing behind text."""
        if self.packet is None:
            return True
        return not self.packet.is_text and len(self._behind) < self._window - 1

    def _room(self) -> int:
        return self._most_bytes if self._data[:1] <= bytes([LARGE_FIRST]) else SMALL_PACKET


def _is_printable(byte: int) -> bool:
    """Return whether a byte may be in a line of text; bytes beyond ASCII are UTF-8."""
    return byte >= 0x20 and byte != _DELETE
