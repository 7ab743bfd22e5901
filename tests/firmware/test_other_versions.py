"""A robot whose EEPROM holds a program of another version says so, and starts nothing."""

from __future__ import annotations

import random
import zlib
from struct import pack as struct_pack

import pytest

from tests.machines.host_firmware import EMPTY_EEPROM, HostFirmware
from tests.support.images import image_of
from tests.support.kept_programs import (
    FIRST_SLOT,
    LATER_VERSION_IMAGE,
    RECORD_BYTES,
    SECOND_SLOT,
    bytes_of,
    eeprom_with,
    later_version_image,
    read_saved_state,
)
from tests.support.robot_on_host import actions_of, computer, send, switched_on
from tiniscript.bytecode.image import REFUSALS, pack, unpack, with_checksum
from tiniscript.link.requests import OK
from tiniscript.link.session import Session

OTHER_VERSION = REFUSALS["OTHER_VERSION"][0]
# `F(5, 80)`, as version 0.1.0 has compiled it: it does not say how long its header is.
VERSION_1 = bytes.fromhex("54530100000000000300101604fa443250")


def open_session(memory: bytes) -> tuple[HostFirmware, Session]:
    robot, session = switched_on(memory), computer(5)
    robot.wait(200)
    assert robot.until(session, session.hello()) == OK
    return robot, session


@pytest.mark.parametrize("place", [FIRST_SLOT, SECOND_SLOT])
@pytest.mark.parametrize("length", [0, 3, 389])
def test_a_program_of_another_version_is_reported(place: int, length: int) -> None:
    memory = eeprom_with((place, 7, later_version_image(random.Random(length).randbytes(length))))
    robot, session = open_session(memory)
    assert read_saved_state(robot, session) == "OTHER_VERSION"
    for ask in (session.start, session.fetch):
        assert robot.until(session, ask()) == OTHER_VERSION
    assert not robot.is_lit
    robot.did.clear()
    robot.push()
    robot.wait(500)
    assert not [line for line in robot.did if "MOTORS" in line]
    assert robot.memory()[place : place + length + 19] == memory[place : place + length + 19]


def test_the_next_program_replaces_it() -> None:
    robot, session = open_session(
        eeprom_with(
            (FIRST_SLOT, 0, later_version_image(bytes(20), "SB")),
            (SECOND_SLOT, 1, LATER_VERSION_IMAGE),
        )
    )
    assert read_saved_state(robot, session) == "OTHER_VERSION"
    image = image_of("SB|F(0.1, 60)")
    assert robot.until(session, session.upload(image)) == OK
    robot.talk(session, 1000)
    assert read_saved_state(robot, session) == "STORED"
    restarted_robot, session = open_session(robot.memory())
    assert read_saved_state(restarted_robot, session) == "STORED"
    assert restarted_robot.complete(session, session.fetch()).image[15:] == image.code


@pytest.mark.parametrize("place", [FIRST_SLOT, SECOND_SLOT])
def test_a_program_of_version_1_is_ignored(place: int) -> None:
    robot, session = open_session(eeprom_with((place, 7, VERSION_1)))
    assert read_saved_state(robot, session) == "NOTHING"
    assert robot.memory()[place : place + 2] == b"\xff\xff", "the slot is empty"


def test_an_older_program_of_this_version_is_used() -> None:
    own_image = bytes_of("SB|F(0.1, 60)")
    robot, session = open_session(
        eeprom_with((FIRST_SLOT, 3, own_image), (SECOND_SLOT, 4, LATER_VERSION_IMAGE))
    )
    assert read_saved_state(robot, session) == "STORED"
    later_image = with_checksum(own_image[:3] + b"\2" + own_image[4:])  # a later minor version
    robot, session = open_session(
        eeprom_with((FIRST_SLOT, 3, later_image), (SECOND_SLOT, 2, LATER_VERSION_IMAGE))
    )
    assert read_saved_state(robot, session) == "OTHER_VERSION"


def test_a_program_with_a_longer_header_is_run() -> None:
    image = unpack(bytes_of("SB|F(0.1, 60)"))
    longer = pack("SB", image.devices, image.code, b"what a later version says")
    robot, session = open_session(eeprom_with((FIRST_SLOT, 3, longer)))
    assert read_saved_state(robot, session) == "STORED"
    assert robot.complete(session, session.fetch()).image == longer
    robot.push()
    robot.wait(300)
    assert actions_of(robot)[:2] == ["MOTORS 60 60", "MOTORS 0 0"]


def test_name_and_trim_survive_an_update() -> None:
    """Their places do not depend on the program's version."""
    robot, session = open_session(eeprom_with((FIRST_SLOT, 0, LATER_VERSION_IMAGE)))
    assert robot.until(session, session.name(b"Ada")) == OK
    memory = bytearray(robot.memory())
    assert memory[4 : 4 + RECORD_BYTES] != EMPTY_EEPROM[4 : 4 + RECORD_BYTES]
    restarted_robot, session = open_session(bytes(memory))
    assert session.robot is not None and session.robot.name == "Ada"
    assert read_saved_state(restarted_robot, session) == "OTHER_VERSION"


@pytest.mark.parametrize("trim", [b"\x08\0\0", b"\0\x29\0", b"\0\xd7\0", b"\0\0\x29", b"\xff" * 3])
def test_a_trim_stored_by_other_firmware_is_ignored(trim: bytes) -> None:
    """Numbers that no trim of this version has would make levels beyond those of a motor."""
    body = struct_pack("<I16s3s", 77, b"Ada", trim)
    robot, session = open_session(eeprom_with((4, 3, struct_pack("<I", zlib.crc32(body)) + body)))
    assert session.robot is not None
    assert (session.robot.id, session.robot.name) == (77, "Ada")
    values = robot.complete(session, session.trim())
    assert (values.wheels, values.balance, values.least) == (0, 0, 0)
    sound = body[:-3] + b"\1\5\7"
    robot, session = open_session(eeprom_with((4, 3, struct_pack("<I", zlib.crc32(sound)) + sound)))
    assert robot.complete(session, session.trim()).least == 7


@pytest.mark.parametrize("pace", [(0xFFFF, 0xFFFF), (900, 100), (500, 500), (0, 0)])
def test_a_pace_stored_by_other_firmware_is_ignored(pace: tuple[int, int]) -> None:
    """Impossible values would end a move too early, so the kit's speed is used."""
    body = bytes(15) + struct_pack("<4H", *pace, *pace)
    record = struct_pack("<I", zlib.crc32(body)) + body
    robot, session = open_session(eeprom_with((4 + 2 * RECORD_BYTES, 3, record)))
    values = robot.complete(session, session.trim())
    assert values.pace == struct_pack("<4H", *pace, *pace), "it is read"
    send(robot, session, "SI|F(20 CM, 60)", saves=False)
    robot.talk(session, 1000)
    start_ms, end_ms = [int(line.split()[0]) for line in robot.did if "MOTORS" in line][-2:]
    assert end_ms - start_ms == pytest.approx(741, abs=2)
