"""The bytes that a UART at one speed receives from another speed: bit by bit, 8N1."""

from __future__ import annotations


def at_speed(data: bytes, sent_baud: int, heard_baud: int) -> bytes:
    """Return the bytes received at `heard_baud` from bytes sent at `sent_baud`, back to back.

    A byte is sampled in the middle of its bits from the edge of its start bit on. One whose stop
    bit is low is passed on, as adapters do.
    """
    levels: list[int] = [1]
    for byte in data:
        levels += [0, *((byte >> bit) & 1 for bit in range(8)), 1]
    levels += [1] * 4
    length = (
        len(levels) * heard_baud
    )  # times on the line in units of 1 / (sent * heard) s; a bit takes `heard`
    slowed_bytes = bytearray()
    tick = 0
    while True:
        while tick < length and levels[tick // heard_baud]:  # skips to the next falling edge
            tick = (tick // heard_baud + 1) * heard_baud
        if tick >= length:
            return bytes(slowed_bytes)
        samples = []
        for bit in range(9):
            place = tick + sent_baud + bit * sent_baud + sent_baud // 2
            samples.append(levels[place // heard_baud] if place < length else 1)
        slowed_bytes.append(sum(level << bit for bit, level in enumerate(samples[:8])))
        tick += sent_baud * 9 + sent_baud // 2
        while tick < length and not levels[tick // heard_baud]:  # a break
            tick = (tick // heard_baud + 1) * heard_baud
