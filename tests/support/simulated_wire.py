"""A wire in simulated time: what is at its other end is stepped millisecond by millisecond."""

from __future__ import annotations

import random
from typing import Protocol

from tiniscript.link.wire import MOST_BYTES, QUIET_MS, Wire


class OtherEnd(Protocol):
    """Something on a wire. `baud` is its speed, bytes are those of the last millisecond."""

    baud: int

    def step(self, data: bytes) -> bytes: ...

    def restart(self) -> None: ...


def garbled(data: bytes, sent: int, heard: int) -> bytes:
    """Return what an UART at one speed hears of bytes that were sent at another one."""
    if sent == heard or not data:
        return data
    chance = random.Random(f"{data!r} {sent} {heard}")
    count = max(1, len(data) * heard // sent)
    return bytes(chance.choice((0x00, 0x80, 0xE0, 0xF8, 0xFE, 0x98)) for _ in range(count))


class SimulatedWire(Wire):
    """A wire without a port, and the time that goes by on it."""

    def __init__(self, end: OtherEnd, baud: int = 9600) -> None:
        super().__init__(None)
        self.end = end
        self.baud = baud
        self.now_ms = 0
        self.restarts = 0
        self.sent: list[tuple[int, bytes]] = []  # each with its speed
        self.is_gone = False
        self._there = b""
        self._back = b""

    def send(self, data: bytes) -> None:
        if self.is_gone:
            raise OSError("gone")
        self.sent.append((self.baud, data))
        self._there += garbled(data, self.baud, self.end.baud)

    def heard(self, wait_ms: int, quiet_ms: int = QUIET_MS) -> bytes:
        if self.is_gone:
            raise OSError("gone")
        found, left = b"", wait_ms
        while left > 0 and len(found) < MOST_BYTES:
            data = self._step()
            found += data
            left = quiet_ms if data else left - 1
        return found

    def _step(self) -> bytes:
        self.now_ms += 1
        speed = self.end.baud  # an answer has the speed of before the command
        data, self._there = self._there, b""
        return garbled(self.end.step(data), speed, self.baud)

    def set_baud(self, baud: int) -> None:
        self.baud = baud

    def restart(self) -> None:
        self.restarts += 1
        self.end.restart()

    def close(self) -> None:
        self.is_gone = True
