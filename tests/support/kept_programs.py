"""Programs that a robot keeps without power."""

from __future__ import annotations

from tests.machines.host_firmware import EMPTY_EEPROM, HostFirmware
from tests.support.images import image_of
from tests.support.robot_on_host import computer, outcome, switched_on
from tiniscript.bytecode.image import pack, with_checksum
from tiniscript.link.messages import SAVED_STATES
from tiniscript.link.requests import OK
from tiniscript.link.session import Session

DRIVE_PROGRAM = "SI|LOOP(FOREVER);F(1, 80);END_LOOP"
# offsets of the program's slots, and bytes of a record
FIRST_SLOT, SECOND_SLOT, RECORD_BYTES = 128, 576, 31


def read_saved_state(robot: HostFirmware, session: Session) -> str:
    return SAVED_STATES[robot.complete(session, session.status()).saved][0]


def name_after_power_off(robot: HostFirmware) -> str:
    restarted_robot, session = switched_on(robot.memory()), computer(77)
    assert restarted_robot.until(session, session.hello()) == OK
    assert session.robot is not None
    return session.robot.name


def program_after_power_off(robot: HostFirmware) -> bytes:
    restarted_robot, session = switched_on(robot.memory()), computer(78)
    request = session.fetch()
    if restarted_robot.until(session, request) != OK:
        return b""
    return outcome(request).values.image


def bytes_of(text: str) -> bytes:
    image = image_of(text)
    return pack(image.start, image.devices, image.code)


def later_version_image(code: bytes, start: str = "SI") -> bytes:
    """Return an image of a later version, 3.0."""
    image = pack(start, 0, code)
    return with_checksum(image[:2] + b"\3\0" + image[4:])


LATER_VERSION_IMAGE = later_version_image(b"\x44\x32\x50")


def eeprom_with(*slots: tuple[int, int, bytes]) -> bytes:
    """Return an EEPROM with images: the place of each slot, its generation, and its content."""
    memory = bytearray(EMPTY_EEPROM)
    for place, generation, image in slots:
        mark = generation ^ 0xA5
        body = bytes([image[0] ^ generation]) + image[1:]
        memory[place : place + 4 + len(image)] = bytes([generation, mark, mark, mark]) + body
    return bytes(memory)
