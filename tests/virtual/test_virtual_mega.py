"""A virtual robot with a Mega: it has a Mega's room for programs, and its reader of text."""

from __future__ import annotations

from tests.support.virtual_robot import Talk, robot_in
from tiniscript import robots
from tiniscript.bytecode.image import pack, unpack
from tiniscript.link.messages import SAVED_STORED, SMALL_FRAME, STATUSES
from tiniscript.robots.text_levels import LEVELS
from tools.bench import large_upload

OK, TOO_LARGE = STATUSES["OK"], STATUSES["TOO_LARGE"]
NAME = "grabber"
EEPROM_BYTES = 4096


def test_it_says_the_sizes_of_its_chip() -> None:
    assert robots.load(NAME).board.chip == "mega"
    robot = robot_in(name=NAME)
    talk = Talk(robot)
    found = talk.until(talk.session.hello()).values
    assert (found.largest, found.window) == (SMALL_FRAME, 1)
    assert list(LEVELS)[(found.features & 3) - 1] == "mega"
    assert len(robot.memory) == EEPROM_BYTES


def test_it_keeps_what_a_mega_promises_and_says_what_it_holds() -> None:
    """The promise of `boards.py` and what HELLO says: a program of either is stored and kept."""
    robot = robot_in(name=NAME)
    promised = robot.profile.board.program_bytes
    assert promised == 1900
    for nonce, code_bytes in ((5, promised), (7, None)):
        talk = Talk(robot, nonce=nonce)
        room = talk.until(talk.session.hello()).values.room
        assert promised <= room
        image = pack("SI", 0, large_upload.program(code_bytes or room).code)
        assert talk.until(talk.session.upload(unpack(image), runs=False)).status == OK
        talk.wait(20_000)
        assert talk.until(talk.session.status()).values.saved == SAVED_STORED
        robot.power_cycle()
        again = Talk(robot, nonce=nonce + 1)
        assert again.until(again.session.fetch()).values.image == image


def test_what_it_does_not_hold_is_refused() -> None:
    talk = Talk(robot_in(name=NAME))
    room = talk.until(talk.session.hello()).values.room
    image = unpack(pack("SI", 0, large_upload.program(room + 1).code))
    assert talk.until(talk.session.upload(image, runs=False)).status == TOO_LARGE
