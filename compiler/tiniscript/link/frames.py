"""Encodes and decodes frames: a head, a payload and a checksum, in COBS.

A large frame has a 0 after its head: so its first byte on the wire is 4 at most. In a sealed one
that is the 0 of the seal, which belongs to the payload.

It does not know the meaning of messages. The C++ version is `vm_arduino/src/link/frames.cpp`.
"""

from __future__ import annotations

import zlib
from typing import NamedTuple

from cobs import cobs

from tiniscript.link.messages import (
    BY_NAME,
    CRC_BYTES,
    HEAD_BYTES,
    LARGE_FRAME,
    MAJOR,
    REPLY,
    SEALED,
    SMALL_FRAME,
)

_HELLO = BY_NAME["HELLO"].number


class Frame(NamedTuple):
    """`number` is a message's number; `epoch` is the session's epoch as the sender knows it."""

    number: int
    seq: int
    epoch: int
    payload: bytes = b""
    is_reply: bool = False
    is_sealed: bool = False


def encode_frame(frame: Frame) -> bytes:
    """Return the bytes on the wire, including the 0x00 at the end."""
    type_byte = frame.number | REPLY * frame.is_reply | SEALED * frame.is_sealed
    data = bytes((type_byte, frame.seq, frame.epoch))
    is_large = HEAD_BYTES + len(frame.payload) + CRC_BYTES > SMALL_FRAME
    data += b"\0" * (is_large and not frame.is_sealed) + frame.payload
    data += checksum(data).to_bytes(CRC_BYTES, "little")
    assert len(data) <= LARGE_FRAME
    wire: bytes = cobs.encode(data)
    return wire + b"\0"


def decode_frame(wire: bytes) -> Frame | None:
    """Return the frame in a packet's bytes (without the 0x00), or None if it is damaged."""
    try:
        data: bytes = cobs.decode(wire)
    except cobs.DecodeError:
        return None
    body, crc = data[:-CRC_BYTES], data[-CRC_BYTES:]
    if len(body) < HEAD_BYTES or checksum(body) != int.from_bytes(crc, "little"):
        return None
    type_byte, seq, epoch = body[:HEAD_BYTES]
    number, is_sealed = type_byte & ~(REPLY | SEALED), bool(type_byte & SEALED)
    payload = body[HEAD_BYTES:]
    if len(data) > SMALL_FRAME:
        if payload[0] != 0:
            return None
        payload = payload if is_sealed else payload[1:]
    return Frame(number, seq, epoch, payload, bool(type_byte & REPLY), is_sealed)


def checksum(data: bytes) -> int:
    """Return the CRC-32 of a frame.

    The CRC starts with 256 times the major version, so that frames of another version are
    rejected. For HELLO it starts with 0, because every version must understand HELLO. (A start
    below 256 would meet the type's byte: with 2, one damaged bit made a HELLO of a STATUS.)
    """
    is_hello = data[0] & ~(REPLY | SEALED) == _HELLO
    return zlib.crc32(data, 0 if is_hello else MAJOR << 8)
