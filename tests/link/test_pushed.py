"""The reading half of a radio's port: after any history, a read waits if there are no bytes and no
cancellation, once for each cancellation.
"""

from __future__ import annotations

import random

import pytest

from tiniscript.link.transports import READ_S
from tiniscript.link.transports.pushed import END_REASON, MAX_BUFFERED_BYTES, PushedTransport


class Bell:
    """The bell of one thread, which counts how many times it would have waited.

    `late_pieces` are bytes that arrive while it waits, the last one first.
    """

    def __init__(self) -> None:
        self.count = self.ring_count = 0
        self.late_pieces: list[bytes] = []
        self.port: PushedTransport | None = None

    def ring(self) -> None:
        self.ring_count += 1

    def wait(self, timeout_s: float) -> None:
        assert timeout_s == READ_S
        self.count += 1
        if self.late_pieces and self.port is not None:
            self.port.add_received(self.late_pieces.pop())


def port_and_waits(monkeypatch: pytest.MonkeyPatch) -> tuple[PushedTransport, Bell]:
    port, bell = PushedTransport(), Bell()
    monkeypatch.setattr(port, "_bell", bell)
    bell.port = port
    return port, bell


@pytest.mark.parametrize("seed", range(60))
def test_a_read_waits_like_on_a_fresh_port(monkeypatch: pytest.MonkeyPatch, seed: int) -> None:
    rng = random.Random(seed)
    port, bell = port_and_waits(monkeypatch)
    unread, is_cancelled, failure = b"", False, ""
    for _ in range(200):
        action = rng.choice(("read", "read", "read", "bring", "cancel", "while it waits"))
        if rng.random() < (0.1 if failure else 0.002):
            action = "end"
        ring_count_before = bell.ring_count
        if action == "bring":
            data = rng.randbytes(rng.choice((1, 20, 300)))
            port.add_received(data)
            unread += data
        elif action == "cancel":
            port.cancel_read()
            is_cancelled = True
        elif action == "end":
            reason = rng.choice(("", "the first one", "another one"))
            port.end(reason)
            failure = failure or reason or END_REASON
        else:
            size = rng.choice((1, 20, 4096))
            late_bytes = rng.randbytes(5) if action == "while it waits" else b""
            bell.late_pieces = [late_bytes] if late_bytes else []
            has_to_wait = not (unread or is_cancelled or failure)
            if has_to_wait:
                unread += late_bytes
            count_before = bell.count
            if failure and not unread:
                with pytest.raises(OSError, match=failure):
                    port.read(size)
            else:
                assert port.read(size) == unread[:size]
            unread = unread[size:]
            assert bell.count - count_before == has_to_wait, "it waits once, or not at all"
            is_cancelled = False
        is_woken = action in ("bring", "cancel", "end")
        assert not is_woken or bell.ring_count > ring_count_before, "a read that waits goes on"
        assert port.in_waiting == len(unread)


@pytest.mark.parametrize(
    "count",
    [
        MAX_BUFFERED_BYTES - 1,
        MAX_BUFFERED_BYTES,
        MAX_BUFFERED_BYTES + 1,
        3 * MAX_BUFFERED_BYTES,
    ],
)
def test_read_bytes_free_their_space(monkeypatch: pytest.MonkeyPatch, count: int) -> None:
    port, _ = port_and_waits(monkeypatch)
    for _ in range(3):
        for _ in range(count // 1000):
            port.add_received(bytes(1000))
        port.add_received(bytes(count % 1000))
        assert port.in_waiting == min(count, MAX_BUFFERED_BYTES)
        assert len(port.read(10 * MAX_BUFFERED_BYTES)) == min(count, MAX_BUFFERED_BYTES)
        assert port.in_waiting == 0
