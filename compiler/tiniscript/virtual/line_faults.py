"""A bad line on purpose: bytes get lost or change, come late, or a radio module writes among them.

Knows chance and bytes; time is an argument. As on a serial line, bytes are never duplicated or
reordered.
"""

from __future__ import annotations

from collections import deque
from random import Random

RADIO_TEXT = b"OK+LOST\r\n"  # what HC-06 and HM-10 modules write into the stream
LONGEST_LOSS = 4  # bytes in a row
LATEST_MS = 300


class BadLine:
    """One direction of a line. Of 1000 bytes about `rate` meet a fault."""

    def __init__(self, rate: float, chance: Random) -> None:
        self.rate = rate
        self.faults = 0  # count of faults so far
        self._chance = chance
        self._late: deque[tuple[int, int]] = deque()  # arrival time and byte
        self._lost = 0  # how many of the next bytes get lost

    def put(self, data: bytes, now_ms: int) -> None:
        """Send bytes."""
        if not self.rate:
            self._late.extend((now_ms, byte) for byte in data)
            return
        for byte in data:
            due_ms = max(now_ms, self._late[-1][0] if self._late else 0)
            if self._lost:
                self._lost -= 1
                continue
            if self._chance.random() * 1000 >= self.rate:
                self._late.append((due_ms, byte))
                continue
            self.faults += 1
            kind = self._chance.randrange(4)
            if kind == 0:
                self._lost = self._chance.randrange(LONGEST_LOSS)  # and this one
            elif kind == 1:
                self._late.append((due_ms, byte ^ 1 << self._chance.randrange(8)))
            elif kind == 2:
                self._late.extend((due_ms, each) for each in (*RADIO_TEXT, byte))
            else:
                self._late.append((due_ms + self._chance.randrange(LATEST_MS), byte))

    def take(self, now_ms: int) -> bytes:
        """Return the bytes that have arrived."""
        found = bytearray()
        while self._late and self._late[0][0] <= now_ms:
            found.append(self._late.popleft()[1])
        return bytes(found)

    @property
    def waiting(self) -> int:
        """Return how many bytes are in transit."""
        return len(self._late)

    def clear(self) -> None:
        """Drop the bytes in transit."""
        self._late.clear()
        self._lost = 0
