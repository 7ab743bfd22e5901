"""The seal of a session: a key that both ends have derived, and a counter for each direction.

Knows the bytes of a sealed frame, and no message; the algorithm is SipHash.
`docs/develop/owners.md` describes what they protect. The C++ version is
`vm_arduino/src/link/seal.cpp`.
"""

from __future__ import annotations

from hmac import compare_digest

from tiniscript.link.frames import Frame
from tiniscript.link.messages import BY_NAME, COUNTER_BYTES, REPLY, SEALED, TAG_BYTES

_MASK = (1 << 64) - 1
_INITIAL_STATE = 0x736F6D6570736575, 0x646F72616E646F6D, 0x6C7967656E657261, 0x7465646279746573


def siphash(key: bytes, message: bytes) -> bytes:
    """Return the hash of a message under a key of 16 bytes: 8 bytes, little-endian."""
    halves = [int.from_bytes(key[offset : offset + 8], "little") for offset in (0, 8)]
    state = [word ^ halves[k % 2] for k, word in enumerate(_INITIAL_STATE)]
    length = len(message)
    padded_bytes = message + bytes(7 - length % 8) + bytes([length & 0xFF])
    for offset in range(0, len(padded_bytes), 8):
        word = int.from_bytes(padded_bytes[offset : offset + 8], "little")
        state[3] ^= word
        state = _sip_rounds(state, 2)
        state[0] ^= word
    state[2] ^= 0xFF
    state = _sip_rounds(state, 4)
    return (state[0] ^ state[1] ^ state[2] ^ state[3]).to_bytes(8, "little")


def _sip_rounds(state: list[int], rounds: int) -> list[int]:
    a, b, c, d = state
    for _ in range(rounds):
        a = (a + b) & _MASK
        b = _rotate_left(b, 13) ^ a
        a = _rotate_left(a, 32)
        c = (c + d) & _MASK
        d = _rotate_left(d, 16) ^ c
        a = (a + d) & _MASK
        d = _rotate_left(d, 21) ^ a
        c = (c + b) & _MASK
        b = _rotate_left(b, 17) ^ c
        c = _rotate_left(c, 32)
    return [a, b, c, d]


def _rotate_left(word: int, bits: int) -> int:
    return (word << bits | word >> 64 - bits) & _MASK


LAST_COUNTER = (1 << 8 * COUNTER_BYTES) - 1
_PREFIX_BYTES = 1 + COUNTER_BYTES  # bytes before the payload
_WIFI_NUMBER = BY_NAME["WIFI"].number
_BLOCK_BYTES = 8  # bytes that are covered at once


def session_key(
    key: bytes, challenge: bytes, nonce: int, robot_nonce: int, epoch: int, kind: int
) -> bytes:
    """Derive the key of a seal from a key of the robot and the nonces of both sides: 16 bytes."""
    nonces = nonce.to_bytes(4, "little") + robot_nonce.to_bytes(4, "little")
    origin = challenge + nonces + bytes([epoch, kind])
    return siphash(key, b"\1" + origin) + siphash(key, b"\2" + origin)


class Seal:
    def __init__(self, key: bytes) -> None:
        self._key = key
        self.sent_counter = 0  # the last counter to the robot
        self.heard_counter = 0  # the last one from it

    def __repr__(self) -> str:  # a key is in no message
        return f"Seal({self.sent_counter}, {self.heard_counter})"

    @property
    def is_spent(self) -> bool:
        """Return whether no more frames can be sealed, because a counter is never used twice."""
        return self.sent_counter >= LAST_COUNTER

    def seal_frame(self, frame: Frame) -> Frame:
        """Return a frame with the next counter and its MAC, ready to be encoded."""
        assert not self.is_spent
        self.sent_counter += 1
        counter = self.sent_counter.to_bytes(COUNTER_BYTES, "little")
        body = frame.payload
        if (
            frame.number == _WIFI_NUMBER and not frame.is_reply
        ):  # the only one with a secret: a password
            body = body[:1] + self._mask(counter, body[1:])
        payload = b"\0" + counter + body
        sealed_frame = frame._replace(payload=payload, is_sealed=True)
        return sealed_frame._replace(payload=payload + self._mac(sealed_frame))

    def open_frame(self, frame: Frame) -> Frame | None:
        """Return the content of a robot's sealed frame, or None if it is not the next one."""
        if (
            not (frame.is_sealed and frame.is_reply)
            or len(frame.payload) < _PREFIX_BYTES + TAG_BYTES
        ):
            return None
        payload, mac = frame.payload[:-TAG_BYTES], frame.payload[-TAG_BYTES:]
        counter = int.from_bytes(payload[1:_PREFIX_BYTES], "little")
        is_right = compare_digest(self._mac(frame._replace(payload=payload)), mac)
        if not is_right or payload[0] != 0 or counter <= self.heard_counter:
            return None
        self.heard_counter = counter
        return frame._replace(payload=payload[_PREFIX_BYTES:])

    def _mask(self, counter: bytes, data: bytes) -> bytes:
        """Cover bytes of the frame with this counter: only the other side can read them."""
        stream = b"".join(
            siphash(self._key, counter + bytes([k])) for k in range(-(-len(data) // _BLOCK_BYTES))
        )
        return bytes(a ^ b for a, b in zip(data, stream, strict=False))

    def _mac(self, frame: Frame) -> bytes:
        type_byte = frame.number | REPLY * frame.is_reply | SEALED
        return siphash(self._key, bytes((type_byte, frame.seq, frame.epoch)) + frame.payload)
