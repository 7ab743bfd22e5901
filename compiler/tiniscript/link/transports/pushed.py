"""The reading half of a port whose bytes another thread delivers: of a radio, of a broker.

It knows which reading methods of a serial port a `PortConnection` uses, but not how bytes arrive.
"""

from __future__ import annotations

from threading import Lock

from tiniscript.base.bell import Bell
from tiniscript.link.transports import READ_S

MAX_BUFFERED_BYTES = 65_536  # most bytes that wait to be read; more are dropped
END_REASON = "the connection has ended"


class PushedTransport:
    """`in_waiting`, `read`, `cancel_read` are as in pyserial; any thread may `bring` and `end`."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._bell = Bell()
        self._buffer = bytearray()
        self._end_reason = ""  # why the connection has ended
        self._is_cancelled = False

    @property
    def in_waiting(self) -> int:
        return len(self._buffer)

    def read(self, size: int) -> bytes:
        """Return received bytes, at most `size`, or none after READ_S.

        Raises OSError if the connection has ended and all of it was read.
        """
        if not (self._buffer or self._end_reason or self._is_cancelled):
            self._bell.wait(READ_S)
        with self._lock:
            self._is_cancelled = False
            data = bytes(self._buffer[:size])
            del self._buffer[:size]
            if self._end_reason and not data:
                raise OSError(self._end_reason)
            return data

    def cancel_read(self) -> None:
        with self._lock:
            self._is_cancelled = True
            self._bell.ring()

    def add_received(self, data: bytes | bytearray) -> None:
        """Add received bytes."""
        with self._lock:
            self._buffer += data[: MAX_BUFFERED_BYTES - len(self._buffer)]
            self._bell.ring()

    def end(self, reason: str) -> None:
        """The connection has ended; the first reason counts."""
        with self._lock:
            self._end_reason = self._end_reason or reason or END_REASON
            self._bell.ring()
