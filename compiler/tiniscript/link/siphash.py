"""SipHash-2-4, the keyed hash with which a computer shows a robot that it has its key.

Jean-Philippe Aumasson and Daniel J. Bernstein describe it in "SipHash: a fast short-input PRF".
The robot's version is `vm_arduino/src/link/siphash.cpp`.
"""

from __future__ import annotations

_MASK = (1 << 64) - 1
_BEGIN = 0x736F6D6570736575, 0x646F72616E646F6D, 0x6C7967656E657261, 0x7465646279746573


def siphash(key: bytes, message: bytes) -> bytes:
    """Return the hash of a message under a key of 16 bytes: 8 bytes, little-endian."""
    halves = [int.from_bytes(key[at : at + 8], "little") for at in (0, 8)]
    state = [word ^ halves[k % 2] for k, word in enumerate(_BEGIN)]
    length = len(message)
    padded = message + bytes(7 - length % 8) + bytes([length & 0xFF])
    for at in range(0, len(padded), 8):
        word = int.from_bytes(padded[at : at + 8], "little")
        state[3] ^= word
        state = _stirred(state, 2)
        state[0] ^= word
    state[2] ^= 0xFF
    state = _stirred(state, 4)
    return (state[0] ^ state[1] ^ state[2] ^ state[3]).to_bytes(8, "little")


def _stirred(state: list[int], rounds: int) -> list[int]:
    a, b, c, d = state
    for _ in range(rounds):
        a = (a + b) & _MASK
        b = _left(b, 13) ^ a
        a = _left(a, 32)
        c = (c + d) & _MASK
        d = _left(d, 16) ^ c
        a = (a + d) & _MASK
        d = _left(d, 21) ^ a
        c = (c + b) & _MASK
        b = _left(b, 17) ^ c
        c = _left(c, 32)
    return [a, b, c, d]


def _left(word: int, bits: int) -> int:
    return (word << bits | word >> 64 - bits) & _MASK
