"""Virtual robots with an ESP32: they have its room for programs, its frames and its reader."""

from __future__ import annotations

import pytest

from tests.support.virtual_robot import Talk, robot_in
from tiniscript.bytecode.image import pack, unpack
from tiniscript.link.messages import LARGE_FRAME, LARGE_WINDOW, SAVED_STORED, SMALL_FRAME, STATUSES
from tools.bench import large_upload

OK = STATUSES["OK"]


@pytest.mark.parametrize(
    ("name", "sizes"),
    [
        ("tinibot", (SMALL_FRAME, 1, 1)),
        ("tinibot32", (LARGE_FRAME, LARGE_WINDOW, 3)),
        ("tinibotc3", (LARGE_FRAME, LARGE_WINDOW, 3)),
    ],
)
def test_it_says_the_sizes_of_its_chip(name: str, sizes: tuple[int, int, int]) -> None:
    talk = Talk(robot_in(name=name))
    found = talk.until(talk.session.hello()).values
    assert (found.largest, found.window, found.features & 3) == sizes
    assert found.room >= talk.robot.profile.board.program_bytes


@pytest.mark.parametrize("name", ["tinibot32", "tinibotc3"])
def test_it_keeps_the_largest_program(name: str) -> None:
    robot = robot_in(name=name)
    talk = Talk(robot)
    code = large_upload.program(robot.profile.board.program_bytes).code
    image = pack("SI", 0, code)
    assert len(code) == 8192
    assert talk.until(talk.session.upload(unpack(image), runs=False)).status == OK
    talk.wait(4000)
    assert talk.until(talk.session.status()).values.saved == SAVED_STORED
    robot.power_cycle()
    again = Talk(robot, nonce=6)
    assert again.until(again.session.hello()).values.program == unpack(image).checksum
    assert again.until(again.session.fetch()).values.image == image


def test_it_runs_a_long_live_line() -> None:
    robot = robot_in(name="tinibot32")
    talk = Talk(robot)
    talk.until(talk.session.hello())
    assert talk.until(talk.session.live(large_upload.program(240).code)).status == OK
    assert robot.is_running
