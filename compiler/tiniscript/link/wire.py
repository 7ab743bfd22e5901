"""A port as a wire: bytes that are sent and heard, at a speed that can change.

For callers that need to know what is at the other end before a session is possible. Knows no frame,
no robot and no clock: the port itself waits.
"""

from __future__ import annotations

from contextlib import suppress
from typing import Any

MAX_BYTES = 1024  # most bytes of one answer, in case the sender never stops
QUIET_MS = 60  # silence that ends an answer
RESET_MS = 100  # time for which the lines hold a board in reset


class Wire:
    """A port that `link.ports` has opened. All but `close` raise OSError if it is lost."""

    def __init__(self, port: Any) -> None:
        self._port = port

    def send(self, data: bytes) -> None:
        try:
            self._port.write(data)
        except TypeError as error:  # pyserial raises this if the port is closed
            raise OSError(str(error)) from None

    def receive(self, wait_ms: int, quiet_ms: int = QUIET_MS) -> bytes:
        """Wait `wait_ms` for a byte at most; return it and the following bytes until a silence."""
        data = b""
        limit_ms = wait_ms
        while len(data) < MAX_BYTES:
            piece = self._read(limit_ms)
            if not piece:
                break
            data += piece
            limit_ms = quiet_ms
        return data

    def _read(self, wait_ms: int) -> bytes:
        try:
            self._port.timeout = wait_ms / 1000
            data = bytes(self._port.read(1))
            waiting_bytes = self._port.in_waiting if data else 0
            if waiting_bytes:
                self._port.timeout = 0
                data += self._port.read(waiting_bytes)
            return data
        except TypeError as error:  # pyserial raises this if the port is closed
            raise OSError(str(error)) from None

    def set_baud(self, baud: int) -> None:
        try:
            self._port.baudrate = baud
        except (ValueError, NotImplementedError) as error:  # the port does not support this speed
            raise OSError(str(error)) from None
        self._drop_input()

    def reset_board(self) -> None:
        """Restart a board on a USB cable, as opening its port does."""
        for is_on in (False, True):
            with suppress(OSError, NotImplementedError, TypeError):  # the port has no such lines
                self._port.dtr = self._port.rts = is_on
            if not is_on:
                self.receive(RESET_MS, RESET_MS)
        self._drop_input()

    def _drop_input(self) -> None:
        with suppress(OSError, TypeError, AttributeError):
            self._port.reset_input_buffer()

    def close(self) -> None:
        with suppress(OSError):
            self._port.close()
