"""A virtual robot has the room for programs, the frames and the reader of text of its chip."""

from __future__ import annotations

import pytest

from tests.support.virtual_robot import Talk, robot_in
from tiniscript.bytecode.image import pack, unpack
from tiniscript.link.messages import LARGE_FRAME, LARGE_WINDOW, SAVED_STORED, SMALL_FRAME, STATUSES
from tiniscript.robots.text_levels import LEVELS
from tools.bench import large_upload

OK, TOO_LARGE = STATUSES["OK"], STATUSES["TOO_LARGE"]
LARGEST = {"grabber": 1900, "tinibot32": 8192, "tinibotc3": 8192}  # bytes of code


@pytest.mark.parametrize(("name", "sizes", "level"), [
    ("tinibot", (SMALL_FRAME, 1), "uno"), ("grabber", (SMALL_FRAME, 1), "mega"),
    ("tinibot32", (LARGE_FRAME, LARGE_WINDOW), "esp32"),
    ("tinibotc3", (LARGE_FRAME, LARGE_WINDOW), "esp32"),
])  # fmt: skip
def test_it_says_the_sizes_of_its_chip(name: str, sizes: tuple[int, int], level: str) -> None:
    talk = Talk(robot_in(name=name))
    found = talk.until(talk.session.hello()).values
    assert (found.largest, found.window) == sizes
    assert list(LEVELS)[(found.features & 3) - 1] == level
    assert found.room >= talk.robot.profile.board.program_bytes


@pytest.mark.parametrize("is_all", [False, True])
@pytest.mark.parametrize("name", LARGEST)
def test_it_keeps_what_its_board_promises_and_what_it_says_itself(name: str, is_all: bool) -> None:
    robot = robot_in(name=name)
    assert robot.profile.board.program_bytes == LARGEST[name]
    talk = Talk(robot)
    room = talk.until(talk.session.hello()).values.room
    image = pack("SI", 0, large_upload.program(room if is_all else LARGEST[name]).code)
    assert talk.until(talk.session.upload(unpack(image), runs=False)).status == OK
    talk.wait(20_000)
    assert talk.until(talk.session.status()).values.saved == SAVED_STORED
    robot.power_cycle()
    again = Talk(robot, nonce=6)
    assert again.until(again.session.hello()).values.program == unpack(image).checksum
    assert again.until(again.session.fetch()).values.image == image


def test_what_it_does_not_hold_is_refused() -> None:
    talk = Talk(robot_in(name="grabber"))
    room = talk.until(talk.session.hello()).values.room
    image = unpack(pack("SI", 0, large_upload.program(room + 1).code))
    assert talk.until(talk.session.upload(image, runs=False)).status == TOO_LARGE
    assert len(talk.robot.memory) == 4096  # bytes of a Mega's EEPROM


def test_it_runs_a_long_live_line() -> None:
    talk = Talk(robot_in(name="tinibot32"))
    talk.until(talk.session.hello())
    assert talk.until(talk.session.live(large_upload.program(240).code)).status == OK
    assert talk.robot.is_running
