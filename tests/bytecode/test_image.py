"""Images: packed ones are read back, and wrong ones are refused by name."""

from __future__ import annotations

import random
import re
import zlib
from pathlib import Path

import pytest

from tests.oracle import image as second_reader
from tests.support.casefile import all_cases
from tiniscript import compile_text, robots
from tiniscript.base.kit import NUMBER, YES_NO, Device, Kit
from tiniscript.bytecode import opcodes
from tiniscript.bytecode.image import (
    HEADER_BYTES,
    REFUSALS,
    Image,
    ImageRefused,
    checksum,
    pack,
    unpack,
    with_checksum,
)
from tiniscript.bytecode.opcodes import BY_CODE, FAULTS, ISA_MAJOR, ISA_MINOR, OPS
from tiniscript.bytecode.verify import RULES, Refused, check, load_image

KIT = robots.load("tinibot").kit
CODE = bytes.fromhex("448c50")
IMAGE = pack("SI", 0, CODE)
LATER = b"what a later version says"
SPEC = Path(__file__).parent.parent.parent / "bytecode_spec.md"
# `F(5, 80)`, as version 0.1.0 has compiled it.
OLD = bytes.fromhex("54530100000000000300101604fa443250")


def refusal(data: bytes) -> str:
    with pytest.raises(ImageRefused) as exception_info:
        unpack(data)
    return exception_info.value.name


def change_byte(offset: int, value: int, image: bytes = IMAGE) -> bytes:
    """Return an image with one byte changed and the checksum mended."""
    data = bytearray(image)
    data[offset] = value
    return with_checksum(bytes(data))


@pytest.mark.parametrize("start", ["SI", "SB", "PING"])
@pytest.mark.parametrize("code", [b"", CODE, bytes(32767)], ids=["empty", "short", "longest"])
@pytest.mark.parametrize("later_fields", [b"", b"?", bytes(240)], ids=["", "1", "240"])
def test_packed_images_are_unpacked_unchanged(start: str, code: bytes, later_fields: bytes) -> None:
    if start == "PING" and code:
        return
    data = pack(start, 0x1234, code, later_fields)
    assert unpack(data) == Image(start, 0x1234, code, checksum(data), (2, 0), later_fields)
    assert checksum(data) == zlib.crc32(data[:10] + data[14:])
    assert len(data) == data[5] + len(code) == HEADER_BYTES + len(later_fields) + len(code)


@pytest.mark.parametrize("image", [IMAGE, pack("SI", 0, CODE, LATER)], ids=["", "later"])
def test_every_changed_bit_is_noticed(image: bytes) -> None:
    for offset in range(len(image)):
        for bit in range(8):
            data = bytearray(image)
            data[offset] ^= 1 << bit
            expected = {"DAMAGED"}
            if offset < 2:
                expected = {"NOT_AN_IMAGE"}
            elif offset == 2 or (offset == 3 and data[3] > ISA_MINOR):
                expected = {"OTHER_VERSION"}
            elif offset in (5, 8, 9):
                expected = {"BAD_HEADER", "TRUNCATED", "TRAILING"}
            assert refusal(bytes(data)) in expected


def test_the_first_applicable_reason_is_reported() -> None:
    """Each reason takes precedence over later ones in the table, whatever else is wrong."""
    bad_start, bad_needs = change_byte(4, 3), change_byte(14, 4)
    doubly_changed = change_byte(4, 3, bad_needs)
    damaged_bytes = doubly_changed[:-1] + bytes([doubly_changed[-1] ^ 1])
    bad_header = change_byte(9, 0x80, damaged_bytes)
    other_header = change_byte(2, 3, bad_header)
    rows = [
        (b"S" + other_header[:1], "NOT_AN_IMAGE"), (other_header[:4], "OTHER_VERSION"),
        (other_header, "OTHER_VERSION"),
        (bad_header[:15], "BAD_HEADER"), (damaged_bytes[:-1], "TRUNCATED"),
        (damaged_bytes + b"?", "TRAILING"),
        (damaged_bytes, "DAMAGED"), (doubly_changed, "UNKNOWN_NEEDS"), (bad_start, "UNKNOWN_START"),
    ]  # fmt: skip
    for data, name in rows:
        assert refusal(data) == name
    numbers = [number for number, _ in REFUSALS.values()]
    assert numbers == list(range(1, 11))


def test_an_image_of_version_1_is_refused_with_its_version() -> None:
    """This holds for whole, cut and damaged images: the remedy is to compile again."""
    for data in (OLD, OLD[:9], OLD + b"?", OLD[:-1] + b"?", OLD[:4]):
        with pytest.raises(ImageRefused) as exception_info:
            unpack(data)
        assert exception_info.value.name == "OTHER_VERSION"
        assert exception_info.value.values == {"theirs": "1.0", "ours": f"{ISA_MAJOR}.{ISA_MINOR}"}


def test_an_image_has_the_lowest_version_with_all_its_instructions() -> None:
    texts = [case.parts["tiniscript"] for case in all_cases() if "tiniscript" in case.parts]
    versions = set()
    for compilation in (compile_text(text, KIT) for text in texts):
        if compilation.verdict is not None:
            version = second_reader.version(compilation.code, compilation.verdict.needs)
            assert (*compilation.image[2:4],) == version
            versions.add(version)
    assert versions == {*second_reader.VERSIONS}


def test_each_instruction_can_raise_the_version(monkeypatch: pytest.MonkeyPatch) -> None:
    """This holds for whichever instruction is the newest, at any position."""
    for op in (op for op in OPS if not op.needs):
        others = b"".join(
            other_op.opcode + bytes(other_op.size - 1)
            for other_op in OPS
            if not other_op.needs | other_op.since_minor
        )
        code = others + op.opcode + bytes(op.size - 1) + others
        assert pack("SI", 0, code)[3] == op.since_minor
        with monkeypatch.context() as patch:
            later_ops = [
                op._replace(since_minor=9) if other_op == op else other_op for other_op in BY_CODE
            ]
            patch.setattr(opcodes, "BY_CODE", later_ops)
            assert pack("SI", 0, code)[3] == 9


# -- devices ------------------------------------------------------------------------------------


def test_an_image_that_uses_no_device_runs_anywhere() -> None:
    image = compile_text("SI|F(5,80)", KIT).image
    assert load_image(image, Kit((), ())).devices == 0
    using_image = compile_text("DISTANCE", KIT).image
    assert load_image(using_image, KIT).devices == KIT.hashes[2]
    with pytest.raises(ImageRefused, match="OTHER_KIT"):  # in this kit the word is a key
        load_image(using_image, Kit((), ()))
    with pytest.raises(Refused, match="NO_SUCH_DEVICE"):
        load_image(compile_text("PAD_Y", KIT).image, Kit(KIT.sensors * 3))
    # The code uses none, but the header claims some.
    with pytest.raises(ImageRefused, match="OTHER_KIT"):
        load_image(pack("SI", 1, CODE), KIT)


def test_unused_devices_of_the_kit_may_change() -> None:
    """Anything that a program does not use may change too."""
    image = compile_text("LOOP(FOREVER);IF(DISTANCE < 10);STOP;ENDIF;END_LOOP", KIT).image
    more_sensors = (*KIT.sensors, Device("SONAR", NUMBER, "cm", 0, 1000))
    other_sensors = (
        *(sensor._replace(name="X" + sensor.name) for sensor in KIT.sensors[:2]),
        KIT.sensors[2],
    )
    for sensors in (more_sensors, other_sensors):
        kit = KIT._replace(sensors=sensors)
        assert kit.fingerprint != KIT.fingerprint
        load_image(image, kit)
    grown_kit = KIT._replace(actuators=(Device("LAMP", YES_NO, "", 0, 1),))
    load_image(image, grown_kit)


@pytest.mark.parametrize(
    "change",
    [{"name": "DISTANCES"}, {"kind": YES_NO}, {"unit": ""}, {"low": 1}, {"high": 399_000}],
    ids=lambda change: next(iter(change)),
)
@pytest.mark.parametrize("use_count", [1, 2, 15, 16, 17, 255, 256, 1000])
def test_a_different_device_is_noticed(change: dict[str, object], use_count: int) -> None:
    """However often it is used: no number of uses makes two devices the same."""
    sensors = (*KIT.sensors[:2], KIT.sensors[2]._replace(**change))  # type: ignore[arg-type]
    code = bytes.fromhex("3802") * use_count
    image = pack("SI", KIT.hash_of_used([("sensor", 2)] * use_count), code)
    load_image(image, KIT)
    with pytest.raises(ImageRefused, match="OTHER_KIT"):
        load_image(image, Kit(sensors, ()))


def test_the_code_is_verified_before_its_devices() -> None:
    with pytest.raises(Refused, match="UNKNOWN_OPCODE"):
        load_image(pack("SI", 1, b"\xff"), KIT)
    verdict = check(unpack(compile_text("SHOW(1 + TIME)", KIT).image), KIT)
    assert verdict.stack_values == 2 and verdict.uses == ()
    assert check(unpack(compile_text("S", KIT).image), KIT).stack_values == 0


def test_the_polynomial_is_primitive() -> None:
    """Therefore 65,535 uses of one device are the first number that could hide it."""
    kit = Kit((), (Device("A", YES_NO, "", 0, 1),))
    single_hash = kit.hash_of_used([("actuator", 0)])
    period_later = kit.hash_of_used([("actuator", 0)] * 65_536)
    assert single_hash == period_later
    hashes = {
        kit.hash_of_used([("actuator", 0)] * use_count) for use_count in (1, 3, 5, 15, 17, 255, 257)
    }
    assert len(hashes) == 7
    assert all(kit.hash_of_used([("actuator", 0)] * (65_535 // prime)) for prime in (3, 5, 17, 257))


def test_the_spec_has_an_example_of_hashes() -> None:
    """The hashed lines and the result are those of `bytecode_spec.md`."""
    text = SPEC.read_text(encoding="utf-8")
    kit = robots.load("grabber").kit
    rows = re.findall(
        r"^\| `grabber` \| \d \| `(sensor|actuator) (.*)` \| `([0-9a-f]{4})` \|$", text, flags=re.M
    )
    lines = [f"{device_text} {rest}" for device_text, rest, _ in rows]
    assert lines == [line.rstrip("\n") for line in kit.lines()]
    hashes = dict(zip(kit.device_lines(), kit.hashes, strict=True))
    assert [int(number, 16) for _, _, number in rows] == [hashes[line] for line in kit.lines()]
    joined_lines = "".join(f"{line}\n" for line in lines).encode()
    assert f"`{zlib.crc32(joined_lines) & 0xFFFF:04x}`" in text
    assert kit.fingerprint == zlib.crc32(joined_lines) & 0xFFFF
    source = re.search(r"```tiniscript\n(.*DISTANCE.*GRIPPER.*)\n```", text)
    assert source
    image = compile_text(source[1], kit).image
    assert f"`{unpack(image).devices:04x}`" in text


def test_the_spec_has_the_devices_of_every_robot() -> None:
    text = SPEC.read_text(encoding="utf-8")
    for name in robots.names():
        kit = robots.load(name).kit
        for line, number in zip(kit.device_lines(), kit.hashes, strict=True):
            assert f"| `{line.rstrip()}` | `{number:04x}` |" in text
        assert f"`{name}`" in text


def test_the_spec_promises_no_number_that_is_in_use() -> None:
    text = SPEC.read_text(encoding="utf-8")
    section = text[text.index("### Room to grow") :]
    promised = dict(re.findall(r"(NO_PLACE|LIST_FULL|NO_ROOM)\s+\((\d+)\)", section))
    assert int(promised.pop("NO_ROOM")) not in {number for number, _ in REFUSALS.values()}
    assert not {int(number) for number in promised.values()} & {number for number, *_ in FAULTS}
    assert len(promised) == 2
    first = re.search(r"for\s+rules,\s+these\s+start\s+at\s+(\d+)", section)
    assert first
    assert int(first[1]) == 1 + max(number for number, *_ in RULES.values())


def test_the_spec_has_a_whole_image() -> None:
    text = SPEC.read_text(encoding="utf-8")
    match = re.search(r"The whole image:\n\n```\n([0-9a-f \n]+)```", text)
    assert match
    data = bytes.fromhex(match[1])
    source = (
        "SI|START;LOOP(FOREVER);F(1, 80);DISTANCE;IF(DISTANCE < 10);STOP;R(1, 60);ENDIF;END_LOOP"
    )
    assert data == compile_text(source, KIT).image


def test_a_reader_made_from_the_specification_gives_the_same_reasons() -> None:
    """The inputs are random bytes and changed images, half of them with a correct checksum."""
    rng = random.Random("images")
    found_reasons = set()
    for _ in range(20_000):
        begun_bytes = b"TS\2\0" + rng.randbytes(20)
        data = bytearray(
            rng.choice(
                (IMAGE, pack("SI", 0, CODE, LATER), rng.randbytes(rng.randrange(40)), begun_bytes)
            )
        )
        for _ in range(rng.randrange(4)):
            if data:
                data[rng.randrange(min(len(data), 20))] = rng.choice(
                    (0, 1, 2, 3, rng.randrange(256))
                )
        image = bytes(data[: rng.choice((len(data), rng.randrange(len(data) + 1)))])
        if len(image) >= HEADER_BYTES and rng.randrange(2):
            image = with_checksum(image)
        expected = second_reader.refusal(image)
        found_reasons.add(expected)
        assert expected == (refusal(image) if expected else "")
        if not expected:
            parsed, unpacked = second_reader.IMAGE.parse(image), unpack(image)
            assert (parsed.later, parsed.code) == (unpacked.later_fields, unpacked.code)
            assert (parsed.devices, parsed.checksum) == (unpacked.devices, unpacked.checksum)
    assert found_reasons == {*REFUSALS, ""} - {"OTHER_KIT"}
