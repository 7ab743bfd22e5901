"""The computer's receiver after any history: a second of silence makes it like a fresh one, and
what waits leaves it once, in its order.
"""

from __future__ import annotations

import random
from collections import deque
from itertools import pairwise
from typing import Any, NamedTuple

import pytest

from tiniscript.link.frames import Frame, encode_frame
from tiniscript.link.messages import LARGE_FRAME, SILENCE_MS
from tiniscript.link.receiver import LARGE_PACKET, SMALL_PACKET, Receiver

# Each beginning and end of a packet, a key or a stop, and bytes of neither.
PIECES = (
    b"\0", b"\0" * 3, b"\r", b"\n", b"\r\n", b"\x1b", b"\x1b[", b"\x1bO", b"\x1b[A", b"\x1bOP",
    b"\x1b[1;5", b"[", b"O", b"A", b";", b" ", b"\x7f", b"\xef\xbb\xbf", b"\xc3\xb1", b"F(1)",
    b"x" * (SMALL_PACKET + 1), b"\x05" + b"y" * LARGE_FRAME, b"\x05y", b"\xff",
)  # fmt: skip
# Pieces after the end of a line that leave no line of text open.
PIECES_BETWEEN_LINES = (
    b"", b" ", b"\x1b", b"\x1b[", b"\x1bO", b"\x1b[1;", b"\xef\xbb\xbf", b"\0", b"\0" * 3,
    b"\0F(1)", b"\0\x05y", b"F(1)\0",
)  # fmt: skip


def random_bytes(rng: random.Random) -> bytes:
    return b"".join(rng.choice(PIECES) for _ in range(rng.randrange(8)))


def found_by(receiver: Receiver, data: bytes, now_ms: int) -> list[Any]:
    """Return the stops and packets, and how many packets were damaged and dropped."""
    counts_before = (receiver.damaged_count, receiver.dropped_count)
    found: list[Any] = []
    for byte in data:
        if receiver.put(byte, now_ms):
            found.append("stop")
        while packet := receiver.take():
            found.append(packet)
    counts = (receiver.damaged_count - counts_before[0], receiver.dropped_count - counts_before[1])
    return [*found, counts]


@pytest.mark.parametrize("seed", range(10))
def test_after_a_silence_nothing_is_left_of_what_was_before(seed: int) -> None:
    """A packet that the silence cuts is counted; a line of text stays open, so there is none."""
    rng = random.Random(seed)
    for _ in range(60):
        receiver, now_ms = Receiver(rng.choice((SMALL_PACKET, LARGE_PACKET))), 0
        for _ in range(rng.randrange(4)):
            found_by(receiver, random_bytes(rng), now_ms)
            now_ms += rng.choice((1, SILENCE_MS - 1, SILENCE_MS))
        found_by(receiver, b"\r\n" + rng.choice(PIECES_BETWEEN_LINES), now_ms)
        is_open = receiver._length > 0
        now_ms += SILENCE_MS
        fresh_receiver, data = Receiver(receiver._frame_bytes), random_bytes(rng) + b"\n"
        *found, (damaged_count, dropped_count) = found_by(receiver, data, now_ms)
        *expected, expected_counts = found_by(fresh_receiver, data, now_ms)
        assert found == expected
        assert (damaged_count - is_open, dropped_count) == expected_counts


class Sent(NamedTuple):
    """A packet, and the numbers of its first byte and of the one that ends it."""

    data: bytes
    is_text: bool
    first: int
    last: int


class Client:
    """Sends packets to a receiver, and takes them again, sometimes later."""

    def __init__(self, window: int) -> None:
        self.receiver = Receiver(window=window)
        self.byte_count = 0
        self.sent: list[Sent] = []
        self.taken: list[tuple[Sent, int]] = []  # and the number of the last byte before that
        self._not_taken: deque[Sent] = deque()

    def send(self, data: bytes, is_text: bool, rng: random.Random, take_share: float) -> None:
        bytes_before = self.byte_count + (not is_text)
        for byte in b"\0" * (not is_text) + data + (b"\n" if is_text else b"\0"):
            if rng.random() < take_share:
                self.take()
            self.byte_count += 1
            self.receiver.put(byte, 1)
        self.sent.append(Sent(data, is_text, bytes_before + 1, self.byte_count))
        self._not_taken.append(self.sent[-1])

    def take(self) -> bool:
        packet = self.receiver.take()
        if packet is None:
            return False
        while (sent := self._not_taken.popleft()).data != packet.data:
            pass  # it was dropped
        self.taken.append((sent, self.byte_count))
        return True


@pytest.mark.parametrize("seed", range(10))
def test_waiting_packets_leave_once_in_their_order(seed: int) -> None:
    """No more wait than the window has room for; none overtakes text, or is overtaken by it."""
    rng = random.Random(seed)
    for _ in range(10):
        window, take_share = rng.choice((1, 2, 4)), rng.choice((0.005, 0.05, 0.5))
        client = Client(window)
        for k in range(60):
            is_text = rng.random() < 0.3
            data = b"F(%d)" % k if is_text else encode_frame(Frame(1, k, 0, bytes(k % 7)))[:-1]
            client.send(data, is_text, rng, take_share)
            waiting_count = len(client.receiver._waiting_frames) + (
                client.receiver.packet is not None
            )
            assert waiting_count <= window
        while client.take():
            pass
        assert len(client.taken) + client.receiver.dropped_count == len(client.sent)
        for (earlier, taken_at), (later, _) in pairwise(client.taken):
            assert not earlier.is_text or later.first > taken_at, "it began while text waited"
            assert not later.is_text or later.last > taken_at, "text waited behind a frame"
