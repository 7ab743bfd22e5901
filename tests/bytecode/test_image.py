"""Images: what is packed is read back, and what is wrong is refused by name."""

from __future__ import annotations

import random
import zlib
from struct import pack as struct_pack

import pytest

from tiniscript import compile_text, robots
from tiniscript.bytecode.image import (
    FIELDS,
    HEADER_BYTES,
    ImageRefused,
    checksum,
    image_format,
    pack,
    unpack,
)

KIT = robots.load("tinibot").kit
CODE = bytes.fromhex("443250")
IMAGE = pack("SI", 0, CODE)


def refusal(data: bytes, kit: int | None = KIT.fingerprint) -> str:
    with pytest.raises(ImageRefused) as refused:
        unpack(data, kit)
    return refused.value.name


def changed(offset: int, value: int) -> bytes:
    """Return IMAGE with one byte changed and the checksum mended."""
    data = bytearray(IMAGE)
    data[offset] = value
    data[10:14] = struct_pack("<I", zlib.crc32(data[:10] + data[14:]))
    return bytes(data)


@pytest.mark.parametrize("start", ["SI", "SB", "PING"])
@pytest.mark.parametrize("code", [b"", CODE, bytes(32767)], ids=["empty", "short", "longest"])
def test_what_is_packed_is_read_back(start: str, code: bytes) -> None:
    if start == "PING" and code:
        return
    data = pack(start, 0x1234, code)
    image = unpack(data, 0x1234)
    assert (image.start, image.kit, image.code, image.isa) == (start, 0x1234, code, (1, 0))
    assert image.checksum == checksum(data) == zlib.crc32(data[:10] + code)
    assert len(data) == HEADER_BYTES + len(code)


def test_the_table_and_the_format_agree() -> None:
    """`pack` and `construct` are made from the same fields."""
    parsed = image_format().parse(IMAGE)
    for field in FIELDS:
        assert field.name in parsed
    assert image_format().build(parsed) == IMAGE
    assert image_format().parse(IMAGE).checksum == checksum(IMAGE)


@pytest.mark.parametrize("length", range(len(IMAGE)))
def test_every_shorter_one_is_truncated(length: int) -> None:
    assert refusal(IMAGE[:length]) == ("TRUNCATED" if length else "NOT_AN_IMAGE")


@pytest.mark.parametrize("offset", range(len(IMAGE)))
def test_every_changed_bit_is_noticed(offset: int) -> None:
    for bit in range(8):
        data = bytearray(IMAGE)
        data[offset] ^= 1 << bit
        expected = {"DAMAGED"}
        if offset < 2:
            expected = {"NOT_AN_IMAGE"}
        elif offset in (8, 9):
            expected = {"TRUNCATED", "TRAILING"}
        assert refusal(bytes(data)) in expected


def test_each_reason() -> None:
    assert refusal(b"") == "NOT_AN_IMAGE"
    assert refusal(b"SI|F(2,80)") == "NOT_AN_IMAGE"
    assert refusal(IMAGE + b"\0") == "TRAILING"
    assert refusal(changed(2, 2)) == "OTHER_VERSION"
    assert refusal(changed(3, 1)) == "OTHER_VERSION"
    assert refusal(changed(4, 3)) == "UNKNOWN_START"
    assert refusal(changed(5, 1)) == "UNKNOWN_NEEDS"
    assert refusal(changed(6, 1)) == "OTHER_KIT"
    assert refusal(changed(4, 2)) == "PING_WITH_CODE"
    assert unpack(changed(6, 1), None).kit == 1


def test_an_image_that_uses_no_word_of_a_kit_runs_anywhere() -> None:
    assert unpack(compile_text("SI|F(5,80)", KIT).image, 0x4321).kit == 0
    used = compile_text("DISTANCE", KIT).image
    assert unpack(used, KIT.fingerprint).kit == KIT.fingerprint
    assert refusal(used, KIT.fingerprint ^ 1) == "OTHER_KIT"


def test_random_bytes_are_refused_and_nothing_else() -> None:
    rng = random.Random("images")
    for _ in range(20_000):
        data = bytearray(
            rng.choice((IMAGE, rng.randbytes(rng.randrange(40)), b"TS" + rng.randbytes(20)))
        )
        for _ in range(rng.randrange(4)):
            if data:
                data[rng.randrange(len(data))] = rng.randrange(256)
        try:
            unpack(bytes(data), KIT.fingerprint)
        except ImageRefused as refused:
            assert refused.name
