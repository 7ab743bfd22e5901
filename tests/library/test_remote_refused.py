"""A program that reads a remote control is refused before a robot without one gets a byte of it."""

from __future__ import annotations

import pytest

from tests.support.session_frames import DESCRIPTION
from tiniscript import robots
from tiniscript.bytecode.image import pack, unpack
from tiniscript.bytecode.opcodes import BY_NAME
from tiniscript.library.refusing import lacks_remote, reads_remote, refusal
from tiniscript.link.messages import PLACES, REMOTE, STATUSES
from tiniscript.link.payloads import HelloReply
from tiniscript.link.requests import DeviceInfo, device_info_of
from tiniscript.link.statuses import status_text

ROBOT = robots.load("tinibot")
OWN = len(ROBOT.kit.sensors)
READ, PUSH_SENSOR, PUSH_READ = (BY_NAME[name].code for name in ("READ", "PUSH_SENSOR", "PUSH_READ"))


def device_info(features: int) -> DeviceInfo:
    values = {**DESCRIPTION, "kit": ROBOT.kit.fingerprint, "features": features}
    return device_info_of(HelloReply(**values))  # type: ignore[arg-type]


CODES = {
    "none": (b"", False),
    "its own": (bytes((READ, OWN - 1)), False),
    "the first key": (bytes((READ, OWN)), True),
    "kept": (bytes((READ, 0, PUSH_SENSOR, OWN + 7)), True),
    "in an expression": (bytes((PUSH_READ, OWN + 3)), True),
    "in one byte": (bytes((BY_NAME[f"READ_{OWN}"].code,)), True),
    "its own in one byte": (bytes((BY_NAME[f"READ_{OWN - 1}"].code,)), False),
}


@pytest.mark.parametrize("name", CODES)
def test_code_that_reads_a_remote_control_is_recognized(name: str) -> None:
    code, does = CODES[name]
    assert reads_remote(code, ROBOT.kit) == does
    assert lacks_remote(code, ROBOT.kit, device_info(PLACES)) == does
    assert not lacks_remote(code, ROBOT.kit, device_info(PLACES | REMOTE))


def test_the_refusal_names_the_next_step() -> None:
    image = unpack(pack("SI", 0, bytes((READ, OWN))))
    refusal_found = refusal(image, ROBOT, device_info(PLACES))
    assert refusal_found is not None and refusal_found.status == STATUSES["NO_REMOTE"]
    assert refusal(image, ROBOT, device_info(PLACES | REMOTE)) is None
    for language in ("en", "es", "pt"):
        sentence, advice = status_text(refusal_found.status, 0, language)
        assert "KEY_UP" in sentence and "tsc firmware" in advice and "Nano" in advice
