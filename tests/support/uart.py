"""What a UART at one speed hears of bytes that were sent at another: bit by bit, 8N1."""

from __future__ import annotations


def at_speed(data: bytes, sent: int, heard: int) -> bytes:
    """Return what is heard at `heard` baud of bytes that were sent at `sent`, one after another.

    A byte is sampled in the middle of its bits from the edge of its start bit on. One whose stop
    bit is low is passed on, as adapters do.
    """
    levels: list[int] = [1]
    for byte in data:
        levels += [0, *((byte >> bit) & 1 for bit in range(8)), 1]
    levels += [1] * 4
    length = len(levels) * heard  # of the line in units of 1 / (sent * heard) s; a bit has `heard`
    slowed = bytearray()
    at = 0
    while True:
        while at < length and levels[at // heard]:  # to the next falling edge
            at = (at // heard + 1) * heard
        if at >= length:
            return bytes(slowed)
        samples = []
        for bit in range(9):
            place = at + sent + bit * sent + sent // 2
            samples.append(levels[place // heard] if place < length else 1)
        slowed.append(sum(level << bit for bit, level in enumerate(samples[:8])))
        at += sent * 9 + sent // 2
        while at < length and not levels[at // heard]:  # a break
            at = (at // heard + 1) * heard
