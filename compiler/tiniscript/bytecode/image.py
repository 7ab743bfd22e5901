"""An image: code with the header that shows a robot whether it may run it.

FIELDS is the one declaration of the header.
It knows nothing of what the code does: `verify` does. `pack` is told what the code needs: an image
names the smallest minor version that has these features and its instructions.
"""

from __future__ import annotations

import zlib
from struct import pack as struct_pack
from struct import unpack as struct_unpack
from typing import NamedTuple

from tiniscript.base.limits import CODE_BYTES
from tiniscript.bytecode.opcodes import (
    ISA_MAJOR,
    ISA_MINOR,
    NEEDS_GO,
    NEEDS_TASKS,
    SINCE_OF_NEED,
    ops_in,
)


class Field(NamedTuple):
    """`layout` is a letter of the module struct; everything is little-endian."""

    name: str
    layout: str
    size: int
    meaning: str


MAGIC = b"TS"
# Features that code may need, and a machine may lack.
TASKS, GO = NEEDS_TASKS, NEEDS_GO
ALL_NEEDS = TASKS | GO
MIN_ISA = ISA_MAJOR, 0  # the version of code whose instructions all machines have
STARTS = ("SI", "SB", "PING")

# The first fields are where they were in version 1, so that the length and the integrity of a
# stored program of any version can be checked.
# fmt: off
FIELDS = (
    Field("magic",         "2s", 2, "The letters `TS`."),
    Field("isa_major",     "B",  1, "Instruction set, major version: a machine runs only its own."),
    Field("isa_minor",     "B",  1, "Minor version: a machine runs its own and earlier ones."),
    Field("start",         "B",  1, "How the program starts: 0 `SI`, 1 `SB`, 2 `PING`."),
    Field("header_length", "B",  1, "Bytes before the code, 15 to 255."),
    Field("devices",       "H",  2, "A [hash](#devices) of the code's devices; 0 for none."),
    Field("code_length",   "H",  2, "Bytes of code that follow the header, 0 to 32767."),
    Field("checksum",      "I",  4, "CRC-32 (zlib) of all bytes before and after it."),
    Field("needs",         "B",  1, "Required: 1 for tasks, 2 for moves by distance or angle."),
)
HEADER_BYTES = sum(field.size for field in FIELDS)

# In the order in which they are looked for; the code is verified before the last one.
REFUSALS = {
    # name            number, reason of the refusal
    "NOT_AN_IMAGE":   (1, "It does not begin with `TS`, so it is not a TiniScript program."),
    "OTHER_VERSION":  (2, "It is for another version of the machine."),
    "BAD_HEADER":     (3, "Its header has fewer than 15 bytes, or its code has more than 32767."),
    "TRUNCATED":      (4, "Bytes are missing at its end."),
    "TRAILING":       (5, "There are bytes after its end."),
    "DAMAGED":        (6, "Its checksum does not match: a byte has changed."),
    "UNKNOWN_NEEDS":  (7, "It needs something that this machine does not have."),
    "UNKNOWN_START":  (8, "Its start mode is not known."),
    "PING_WITH_CODE": (9, "It starts with PING, but has code."),
    "OTHER_KIT":      (10, "It uses a sensor or an actuator that is different here."),
}
# fmt: on

_VERSION_BYTES = 4  # bytes that identify an image of any version
_LAYOUT = "<" + "".join(field.layout for field in FIELDS)
_CHECKSUM_OFFSET = sum(field.size for field in FIELDS[:-2])
_CHECKSUM_END = _CHECKSUM_OFFSET + 4


class Image(NamedTuple):
    """`devices` is the hash of those that the code uses; `later_fields` are those of later
    versions.

    `checksum` names the program wherever it goes.
    """

    start: str
    devices: int
    code: bytes
    checksum: int
    isa: tuple[int, int]
    later_fields: bytes = b""
    needs: int = 0


class ImageRefused(Exception):
    """Bytes that are no image for this machine; `name` is in REFUSALS."""

    def __init__(self, name: str, **values: str) -> None:
        super().__init__(name)
        self.name = name
        self.number, self.meaning = REFUSALS[name]
        self.values = values


def pack(start: str, devices: int, code: bytes, later_fields: bytes = b"", needs: int = 0) -> bytes:
    """Return the image of `code` (0 to 32767 bytes); `devices` is the hash of those it uses.

    `later_fields` (0 to 240 bytes) are fields that this version does not know; `needs` is that of
    its verdict.
    """
    assert len(code) <= CODE_BYTES
    values = (MAGIC, *isa_of(code, needs), STARTS.index(start), HEADER_BYTES + len(later_fields),
              devices, len(code), 0, needs)  # fmt: skip
    return with_checksum(struct_pack(_LAYOUT, *values) + later_fields + code)


def isa_of(code: bytes, needs: int) -> tuple[int, int]:
    """Return the smallest version of the instruction set that has all instructions and features of
    the code.

    Instructions that need more than `needs` do not count: the reader of the image refuses them.
    """
    needed_since = (since for need, since in SINCE_OF_NEED.items() if needs & need)
    had_since = (op.since_minor for op in ops_in(code) if not op.needs & ~needs)
    return ISA_MAJOR, max((0, *needed_since, *had_since))


def with_checksum(image: bytes) -> bytes:
    """Return an image with the checksum that fits the rest of it."""
    bytes_before, bytes_after = image[:_CHECKSUM_OFFSET], image[_CHECKSUM_END:]
    return bytes_before + struct_pack("<I", zlib.crc32(bytes_before + bytes_after)) + bytes_after


def checksum(image: bytes) -> int:
    """Return the checksum in the header of a whole image."""
    return int.from_bytes(image[_CHECKSUM_OFFSET:_CHECKSUM_END], "little")


def unpack(data: bytes, capabilities: int = ALL_NEEDS) -> Image:
    """Return the image in `data`, whose code and devices are not verified yet.

    `capabilities` are the `needs` that the machine can fulfil. Raises ImageRefused, which names the
    reason.
    """
    if data[: len(MAGIC)] != MAGIC[: len(data)] or not data:
        raise ImageRefused("NOT_AN_IMAGE")
    if len(data) < _VERSION_BYTES:
        raise ImageRefused("TRUNCATED")
    isa = data[2], data[3]
    if isa[0] != ISA_MAJOR or isa[1] > ISA_MINOR:
        image_version, own_version = f"{isa[0]}.{isa[1]}", f"{ISA_MAJOR}.{ISA_MINOR}"
        raise ImageRefused("OTHER_VERSION", theirs=image_version, ours=own_version)
    if len(data) < HEADER_BYTES:
        raise ImageRefused("TRUNCATED")
    values = struct_unpack(_LAYOUT, data[:HEADER_BYTES])
    _, _, _, start, header_length, devices, code_length, stored_checksum, needs = values
    if header_length < HEADER_BYTES or code_length > CODE_BYTES:
        raise ImageRefused("BAD_HEADER")
    if len(data) < header_length + code_length:
        raise ImageRefused("TRUNCATED")
    if len(data) > header_length + code_length:
        raise ImageRefused("TRAILING")
    if checksum(with_checksum(data)) != stored_checksum:
        raise ImageRefused("DAMAGED")
    if needs & ~capabilities:
        raise ImageRefused("UNKNOWN_NEEDS", found=f"{needs:02x}")
    if start >= len(STARTS):
        raise ImageRefused("UNKNOWN_START", found=str(start))
    if STARTS[start] == "PING" and code_length:
        raise ImageRefused("PING_WITH_CODE")
    later_fields, code = data[HEADER_BYTES:header_length], data[header_length:]
    return Image(STARTS[start], devices, code, stored_checksum, isa, later_fields, needs)
