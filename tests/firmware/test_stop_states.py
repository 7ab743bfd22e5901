"""A stop in every state of the firmware, in every way, once, twice and again and again.

The states are those of the button: what the robot holds is still there, and its button starts it.
"""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.firmware.test_button_states import STATES, Table, keeps_trim, saves
from tests.firmware.test_host_firmware import KIT, computer, happened
from tests.machines.host_firmware import HostFirmware
from tiniscript.link.frames import Frame, encoded
from tiniscript.link.messages import BY_NAME
from tiniscript.link.requests import OK

ZEROS = bytes(4)
MESSAGE = b"\0" + encoded(Frame(BY_NAME["STOP"].number, 99, 0))
WAYS: dict[str, Callable[[HostFirmware], bytes]] = {
    "four zeros": lambda robot: robot.step(ZEROS),
    "eight zeros": lambda robot: robot.step(ZEROS + ZEROS),
    "two": lambda robot: robot.step(ZEROS) + robot.wait(30) + robot.step(ZEROS),
    "for a second": lambda robot: b"".join(robot.wait(100, ZEROS) for _ in range(10)),
    "a message": lambda robot: robot.wait(3, MESSAGE),
    "a message and zeros": lambda robot: robot.wait(3, MESSAGE) + robot.step(ZEROS),
    "a line": lambda robot: robot.wait(3, b"\0S\n"),
}
# The push that follows means nothing where the button is down from the reset on; in an open block
# a line S belongs to the program.
NOT_HERE = (("was reset with the button down", None), ("has an open block of text", "a line"))
PAIRS = [
    (state, way)
    for state in STATES
    for way in WAYS
    if not {(state, way), (state, None)} & set(NOT_HERE)
]


def begun(state: str) -> Table:
    table = Table()
    STATES[state](table)
    table.robot.did.clear()
    return table


@pytest.mark.parametrize(("state", "way"), PAIRS)
def test_a_stop_in_every_state(state: str, way: str) -> None:
    table = begun(state)
    robot = table.robot
    was_running = not robot.is_latched
    WAYS[way](robot)
    moves = [line for line in happened(robot) if line.startswith("MOTORS")]
    assert set(moves) <= {"MOTORS 0 0"} and (moves or not was_running)
    assert robot.is_latched
    before = len(robot.did)
    table.talk(1500)
    later = [line for line in happened(robot)[before:] if line.startswith("MOTORS")]
    assert set(later) <= {"MOTORS 0 0"}, "nothing begins by itself"
    robot.push()
    table.talk(50)
    if table.program:
        assert happened(robot)[-1] == f"MOTORS {table.program} {table.program}"
    else:
        assert robot.is_latched


@pytest.mark.parametrize("way", WAYS)
def test_a_program_that_is_being_saved_is_saved_all_the_same(way: str) -> None:
    table = begun("saves its program")
    WAYS[way](table.robot)
    table.robot.wait(1500)
    later = HostFirmware(KIT, table.robot.memory())
    later.wait(100)
    later.push()
    later.wait(50)
    assert happened(later)[-1] == f"MOTORS {table.program} {table.program}"


@pytest.mark.parametrize("after_ms", [0, 1, 2, 3, 5, 8, 13, 21, 34, 55, 89])
@pytest.mark.parametrize("state", [saves, keeps_trim])
def test_a_stop_at_any_time_of_a_save(state: Callable[[Table], None], after_ms: int) -> None:
    table = Table()
    state(table)
    table.talk(after_ms)
    table.robot.step(ZEROS)
    assert table.robot.is_latched
    table.robot.wait(1500)
    later = HostFirmware(KIT, table.robot.memory())
    later.wait(100)
    session = computer(7)
    if state is keeps_trim:
        request = session.trim()
        assert later.until(session, request) == OK
        assert request.outcome and request.outcome.values.least in (0, 1)
    later.push()
    later.talk(session, 50)
    assert happened(later)[-1] == f"MOTORS {table.program} {table.program}"
