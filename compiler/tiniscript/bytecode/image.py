"""An image: code with the header that tells a robot whether it may run it.

FIELDS is the one declaration of the header. `pack` writes it with the standard library alone;
reading, documents and tests use the `construct` format that is made from the same table.
Knows nothing of what the code does: `verify` does.
"""

from __future__ import annotations

import zlib
from functools import lru_cache
from struct import pack as struct_pack
from typing import TYPE_CHECKING, Any, NamedTuple

from tiniscript.bytecode.opcodes import CODE_BYTES, ISA_MAJOR, ISA_MINOR

if TYPE_CHECKING:
    from construct import Construct


class Field(NamedTuple):
    """`layout` is a letter of the module struct; everything is little-endian."""

    name: str
    layout: str
    size: int
    meaning: str


MAGIC = b"TS"
STARTS = ("SI", "SB", "PING")

# fmt: off
FIELDS = (
    Field("magic",       "2s", 2, "The letters `TS`."),
    Field("isa_major",   "B",  1, "Instruction set: a machine runs its own major version only,"),
    Field("isa_minor",   "B",  1, "and its own minor version or an earlier one."),
    Field("start",       "B",  1, "How the program starts: 0 `SI`, 1 `SB`, 2 `PING`."),
    Field("needs",       "B",  1, "What the machine must be able to do beyond this version: 0."),
    Field("kit",         "H",  2, "Fingerprint of the kit whose words it uses, or 0 for none."),
    Field("code_length", "H",  2, "Bytes of code that follow the header, 0 to 32767."),
    Field("checksum",    "I",  4, "CRC-32 (zlib) of the ten bytes before it and the code."),
)
HEADER_BYTES = sum(field.size for field in FIELDS)

REFUSALS = {
    # name           number, what is refused
    "NOT_AN_IMAGE":  (1, "It does not begin with `TS`: it is no TiniScript program."),
    "TRUNCATED":     (2, "Bytes are missing at its end."),
    "TRAILING":      (3, "There are bytes after its end."),
    "DAMAGED":       (4, "Its checksum does not fit: a byte has changed."),
    "OTHER_VERSION": (5, "It is for another version of the machine."),
    "UNKNOWN_START": (6, "Its start mode is not known."),
    "UNKNOWN_NEEDS": (7, "It needs something that this machine does not have."),
    "OTHER_KIT":     (8, "It uses words of another robot's kit."),
    "PING_WITH_CODE": (9, "It starts with PING, and yet has code."),
}
# fmt: on

_LAYOUT = "<" + "".join(field.layout for field in FIELDS)
_CHECKED = HEADER_BYTES - FIELDS[-1].size  # bytes before the checksum


class Image(NamedTuple):
    """`kit` is a fingerprint, or 0; `checksum` names the program wherever it goes."""

    start: str
    kit: int
    code: bytes
    checksum: int
    isa: tuple[int, int]


class ImageRefused(Exception):
    """Bytes that are no image for this machine; `name` is in REFUSALS."""

    def __init__(self, name: str, **values: str) -> None:
        super().__init__(name)
        self.name = name
        self.number, self.meaning = REFUSALS[name]
        self.values = values


def pack(start: str, kit: int, code: bytes) -> bytes:
    """Return the image of `code` (0 to 32767 bytes); `kit` is a fingerprint, or 0."""
    assert len(code) <= CODE_BYTES
    values = (MAGIC, ISA_MAJOR, ISA_MINOR, STARTS.index(start), 0, kit, len(code))
    head = struct_pack(_LAYOUT[:-1], *values)
    return head + struct_pack("<I", zlib.crc32(head + code)) + code


def checksum(image: bytes) -> int:
    """Return the checksum in the header of a whole image."""
    return int.from_bytes(image[_CHECKED:HEADER_BYTES], "little")


@lru_cache(maxsize=1)
def image_format() -> Construct[Any, Any]:
    """Return the `construct` format of an image, made from FIELDS."""
    import construct as c

    kinds = {"B": c.Int8ul, "H": c.Int16ul, "I": c.Int32ul, "2s": c.Bytes(2)}
    fields = [field.name / kinds[field.layout] for field in FIELDS]
    return c.Struct(*fields, "code" / c.Bytes(c.this.code_length), "rest" / c.GreedyBytes)


def unpack(data: bytes, kit: int | None = None) -> Image:
    """Return the image in `data`. Its code is not verified yet.

    `kit` is the fingerprint of the robot that shall run it; None accepts every kit. Raises
    ImageRefused with the name of the reason.
    """
    from construct import StreamError

    if data[: len(MAGIC)] != MAGIC[: len(data)] or not data:
        raise ImageRefused("NOT_AN_IMAGE")
    try:
        parsed = image_format().parse(data)
    except StreamError:
        raise ImageRefused("TRUNCATED") from None
    if parsed.rest:
        raise ImageRefused("TRAILING")
    if zlib.crc32(data[:_CHECKED] + data[HEADER_BYTES:]) != parsed.checksum:
        raise ImageRefused("DAMAGED")
    if parsed.isa_major != ISA_MAJOR or parsed.isa_minor > ISA_MINOR:
        theirs = f"{parsed.isa_major}.{parsed.isa_minor}"
        raise ImageRefused("OTHER_VERSION", theirs=theirs, ours=f"{ISA_MAJOR}.{ISA_MINOR}")
    if parsed.start >= len(STARTS):
        raise ImageRefused("UNKNOWN_START", found=str(parsed.start))
    if parsed.needs:
        raise ImageRefused("UNKNOWN_NEEDS", found=f"{parsed.needs:02x}")
    if kit is not None and parsed.kit not in (0, kit):
        raise ImageRefused("OTHER_KIT", theirs=f"{parsed.kit:04x}", ours=f"{kit:04x}")
    if STARTS[parsed.start] == "PING" and parsed.code_length:
        raise ImageRefused("PING_WITH_CODE")
    isa = (parsed.isa_major, parsed.isa_minor)
    return Image(STARTS[parsed.start], parsed.kit, bytes(parsed.code), parsed.checksum, isa)
