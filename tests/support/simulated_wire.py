"""A wire in simulated time: the device at its other end is stepped millisecond by millisecond."""

from __future__ import annotations

from typing import Protocol

from tests.support.uart import at_speed
from tiniscript.link.wire import MAX_BYTES, QUIET_MS, Wire


class OtherEnd(Protocol):
    """Something on a wire. `baud` is its speed, bytes are those of the last millisecond."""

    baud: int

    def step(self, data: bytes) -> bytes: ...

    def restart(self) -> None: ...


def garble(data: bytes, sent_baud: int, heard_baud: int) -> bytes:
    """Return the bytes that a UART at one speed receives from another speed."""
    return at_speed(data, sent_baud, heard_baud) if sent_baud != heard_baud else data


class SimulatedWire(Wire):
    """A wire without a port, and the time that goes by on it."""

    def __init__(self, end: OtherEnd, baud: int = 9600) -> None:
        super().__init__(None)
        self.end = end
        self.baud = baud
        self.now_ms = 0
        self.restarts = 0
        self.sent_pieces: list[tuple[int, bytes]] = []  # each with its speed
        self.is_gone = False
        self._to_device = b""
        self._from_device = b""

    def send(self, data: bytes) -> None:
        if self.is_gone:
            raise OSError("gone")
        self.sent_pieces.append((self.baud, data))
        self._to_device += garble(data, self.baud, self._speed())

    def receive(self, wait_ms: int, quiet_ms: int = QUIET_MS) -> bytes:
        if self.is_gone:
            raise OSError("gone")
        received_bytes, wait_left_ms = b"", wait_ms
        while wait_left_ms > 0 and len(received_bytes) < MAX_BYTES:
            data = self._step()
            received_bytes += data
            wait_left_ms = quiet_ms if data else wait_left_ms - 1
        return received_bytes

    def _step(self) -> bytes:
        self.now_ms += 1
        speed = self._speed()  # an answer has the speed of before the command
        data, self._to_device = self._to_device, b""
        return garble(self.end.step(data), speed, self.baud)

    def _speed(self) -> int:
        """Return the speed of the device at the other end; a bare wire has that of its bytes."""
        return self.baud if getattr(self.end, "is_bare", False) else self.end.baud

    def set_baud(self, baud: int) -> None:
        self.baud = baud

    def reset_board(self) -> None:
        self.restarts += 1
        self.end.restart()

    def close(self) -> None:
        self.is_gone = True
