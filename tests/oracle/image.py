"""A second reader of images, written from the words of `bytecode_spec.md` alone.

It shares nothing with the package. If it gives another reason, the page is unclear, or one of them
is wrong. It knows only the names of the instructions, and no robot.
"""

from __future__ import annotations

import zlib

from construct import Bytes, Int8ul, Int16ul, Int32ul, Struct, this

from tests.oracle import spec_tables

HEADER = Struct(
    "magic" / Bytes(2),
    "isa_major" / Int8ul,
    "isa_minor" / Int8ul,
    "start" / Int8ul,
    "header_length" / Int8ul,
    "devices" / Int16ul,
    "code_length" / Int16ul,
    "checksum" / Int32ul,
    "needs" / Int8ul,
)
IMAGE = Struct(
    *HEADER.subcons,
    "later" / Bytes(this.header_length - HEADER.sizeof()),
    "code" / Bytes(this.code_length),
)
NEEDS, STARTS, PING, MAX_BYTES = 3, 3, 2, 32767
VERSIONS = spec_tables.versions()
MAJOR, MINOR = max(VERSIONS)


def version(code: bytes, needs: int) -> tuple[int, int]:
    """Return the lowest version that has all instructions and needs of verified code."""
    offset, names = 0, set()
    while offset < len(code):
        name, offset = (
            spec_tables.instruction_at(code, offset).name,
            spec_tables.decode(code, offset)[2],
        )
        names.add(name)
    added = (
        number
        for number, (its_names, bits) in VERSIONS.items()
        if names & its_names or any(needs & bit for bit in bits)
    )
    return max((min(VERSIONS), *added))


def refusal(data: bytes) -> str:
    """Return the first reason for which a machine refuses an image, or an empty text."""
    if not data or data[:2] != b"TS"[: len(data)]:
        return "NOT_AN_IMAGE"
    if len(data) < 4:
        return "TRUNCATED"
    if data[2] != MAJOR or data[3] > MINOR:
        return "OTHER_VERSION"
    if len(data) < HEADER.sizeof():
        return "TRUNCATED"
    head = HEADER.parse(data)
    if head.header_length < HEADER.sizeof() or head.code_length > MAX_BYTES:
        return "BAD_HEADER"
    whole_length = head.header_length + head.code_length
    if len(data) != whole_length:
        return "TRUNCATED" if len(data) < whole_length else "TRAILING"
    reasons = {
        "DAMAGED": zlib.crc32(data[:10] + data[14:]) != head.checksum,
        "UNKNOWN_NEEDS": head.needs & ~NEEDS,
        "UNKNOWN_START": head.start >= STARTS,
        "PING_WITH_CODE": head.start == PING and head.code_length,
    }
    return next((name for name, applies in reasons.items() if applies), "")
