"""Bytes to items: frames, lines of text, and the run of zeros that stops a robot.

Knows where an item begins and ends; not whether a frame is whole: `frames` does. Holds one item
until it is taken; what comes meanwhile is dropped, but for a stop.
The same as `vm_arduino/src/link/receiver.cpp`.
"""

from __future__ import annotations

from typing import NamedTuple

from tiniscript.link.messages import LARGEST, SILENCE_MS, STOP_RUN, TEXT_FROM

ITEM_BYTES = LARGEST + 1  # a frame and the first byte of its COBS
LONGEST = 255  # a longer text counts as this long

# places in the stream
_BEGIN = "begin"  # the next byte begins an item
_AFTER_TEXT = "after text"  # the same, but for white space
_FRAME = "frame"
_TEXT = "text"
_SKIP = "skip"  # in something that is no item, up to the next 0x00


class Item(NamedTuple):
    """A frame before it is decoded, or the beginning of a line of text of `length` bytes."""

    is_text: bool
    data: bytes
    length: int


class Receiver:
    def __init__(self) -> None:
        self.item: Item | None = None
        self.damaged = 0  # items that were cut, too long, or none
        self.dropped = 0  # items that came while one was waiting
        self._place = _BEGIN
        self._data = bytearray()
        self._length = 0
        self._is_dropping = False
        self._zeros = 0
        self._last_ms = 0

    def take(self) -> Item | None:
        """Return the item that is waiting, if there is one, and make room for the next."""
        item, self.item = self.item, None
        return item

    def put(self, byte: int, now_ms: int) -> bool:
        """Take a byte; return whether it completes a run of zeros that means stop.

        A byte that came damaged (a framing error) is 0.
        """
        is_quiet = (now_ms - self._last_ms) % 0x10000 >= SILENCE_MS
        self._last_ms = now_ms
        if is_quiet:
            self._cut()
            self._zeros = 0
        if byte == 0:
            return self._zero()
        self._zeros = 0
        if self._place == _AFTER_TEXT and byte in b" \t\r\n":
            return False
        if self._place in (_BEGIN, _AFTER_TEXT):
            self._begin(byte)
        if self._place == _FRAME:
            if self._length == ITEM_BYTES and not self._is_dropping:
                self.damaged += 1
                self._place = _SKIP
                return False
            self._add(byte)
        elif self._place == _TEXT:
            if byte in b"\r\n":
                self._end(is_text=True)
                self._place = _AFTER_TEXT
            else:
                self._add(byte)
        return False

    def _begin(self, byte: int) -> None:
        self._is_dropping = self.item is not None
        self._data.clear()
        self._length = 0
        if byte < TEXT_FROM:
            self._place = _FRAME
        elif chr(byte).isascii() and chr(byte).isalpha():
            self._place = _TEXT
        else:
            self.damaged += 1
            self._place = _SKIP
            return
        self.dropped += self._is_dropping

    def _add(self, byte: int) -> None:
        if len(self._data) < ITEM_BYTES:
            self._data.append(byte)
        self._length = min(self._length + 1, LONGEST)

    def _zero(self) -> bool:
        if self._place == _FRAME:
            self._end(is_text=False)
            self._place = _BEGIN
        else:
            self._cut()
        self._zeros = min(self._zeros + 1, STOP_RUN + 1)
        return self._zeros == STOP_RUN

    def _cut(self) -> None:
        """Begin anew; what is open has no end of its own."""
        self.damaged += self._place in (_FRAME, _TEXT)
        self._place = _BEGIN

    def _end(self, is_text: bool) -> None:
        if not self._is_dropping:
            self.item = Item(is_text, bytes(self._data), self._length)
