"""The reading half of a port whose bytes another thread brings: of a radio, of a broker.

Knows what a `PortConnection` uses of a serial port to read, and no way by which bytes come.
"""

from __future__ import annotations

from threading import Lock

from tiniscript.base.bell import Bell
from tiniscript.link.transports import READ_S

KEPT_BYTES = 65_536  # of somebody who sends more than is read; more is lost
END_REASON = "the connection has ended"


class PushedTransport:
    """`in_waiting`, `read`, `cancel_read` are as in pyserial; any thread may `bring` and `end`."""

    def __init__(self) -> None:
        self._turn = Lock()
        self._news = Bell()
        self._heard = bytearray()
        self._gone = ""  # why the connection has ended
        self._is_cancelled = False

    @property
    def in_waiting(self) -> int:
        return len(self._heard)

    def read(self, size: int) -> bytes:
        """Return what has arrived, at most `size` bytes, or nothing after READ_S.

        Raises OSError where the connection has ended and all of it was read.
        """
        if not (self._heard or self._gone or self._is_cancelled):
            self._news.wait(READ_S)
        with self._turn:
            self._is_cancelled = False
            result = bytes(self._heard[:size])
            del self._heard[:size]
            if self._gone and not result:
                raise OSError(self._gone)
            return result

    def cancel_read(self) -> None:
        with self._turn:
            self._is_cancelled = True
            self._news.ring()

    def bring(self, data: bytes | bytearray) -> None:
        """Bytes have come."""
        with self._turn:
            self._heard += data[: KEPT_BYTES - len(self._heard)]
            self._news.ring()

    def end(self, why: str) -> None:
        """The connection has ended; the first reason counts."""
        with self._turn:
            self._gone = self._gone or why or END_REASON
            self._news.ring()
