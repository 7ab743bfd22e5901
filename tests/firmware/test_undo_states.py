"""UNDO in every state of the firmware: what comes back, that nothing starts, and that a pulled plug
leaves one of the two.

The states are those of the button. Before each of them the robot has saved one program more.
"""

from __future__ import annotations

import pytest

from tests.firmware.test_button_states import OTHER, SAVED, STATES, SmallRobot, Table
from tests.firmware.test_host_firmware import (
    KIT,
    computer,
    happened,
    held,
    outcome,
    stored,
    switched_on,
)
from tests.firmware.test_persistence import bytes_of
from tests.firmware.test_undo import undo
from tiniscript.link.messages import STATUSES
from tiniscript.link.requests import OK
from tiniscript.link.session import Session

EARLIER = 21  # the power of the program that was saved first
IN_MEMORY = {
    "holds a program in memory only", "holds a program that was typed", "runs a program in memory",
}  # fmt: skip
NO_PREVIOUS, NOT_OWNER = STATUSES["NO_PREVIOUS"], STATUSES["NOT_OWNER"]


def begun(state: str, has_draft: bool = True) -> tuple[Table, Session]:
    """Return a robot in a state, and who asks it: who talks with it, or another one."""
    table = Table(has_draft)
    table.robot.wait(200)
    table.is_ready(EARLIER)
    STATES[state](table)
    if table.talks is not None:
        return table, table.talks
    return table, table.session if state == "has an owner" else computer(9)


def after_power_off(table: Table) -> bytes:
    """Return the program that it holds at the next two starts, the same, for who has its key."""
    memory, found = table.robot.memory(), []
    for nonce in (31, 32):
        robot = switched_on(memory, seed=nonce)
        asks = Session(nonce, 9600, KIT.fingerprint, keys=table.keys)
        found.append(held(robot, asks))
        memory = robot.memory()
    assert found[0] == found[1]
    return found[0]


def program_of(power: int) -> bytes:
    return bytes_of(f"SB|F(600, {power})")


def back_in(state: str) -> int:
    """Return the power of the program that comes back."""
    if state == "holds no program":
        return 0  # EARLIER is the only one
    if state == "brings the program before back":
        return OTHER
    return SAVED if state in IN_MEMORY else EARLIER


@pytest.mark.parametrize("has_draft", [True, False])
@pytest.mark.parametrize("state", STATES)
def test_undo_in_every_state(state: str, has_draft: bool) -> None:
    table, session = begun(state, has_draft)
    robot, back = table.robot, back_in(state)
    was_running = not robot.is_latched
    robot.did.clear()
    status = undo(robot, session)
    assert status == (OK if back else NO_PREVIOUS)
    now = program_of(back or EARLIER)
    assert held(robot, session) == now
    assert robot.is_latched, "what runs ends"
    robot.talk(session, 1500)
    moves = {line for line in happened(robot) if line.startswith("MOTORS")}
    assert moves == ({"MOTORS 0 0"} if was_running else set()), "nothing starts"
    stored(robot, session)
    assert after_power_off(table) == now
    assert undo(robot, session) == (OK if back else NO_PREVIOUS)
    stored(robot, session)
    other = held(robot, session)
    assert after_power_off(table) == other
    assert (other != now) == bool(back), "a second one brings another"


@pytest.mark.parametrize("state", STATES)
def test_two_at_once_are_two(state: str) -> None:
    """The second request is on its way before the first is answered."""
    table, session = begun(state)
    robot, back = table.robot, back_in(state)
    requests = [session.undo(), session.undo()]
    found = [robot.until(session, each) for each in requests]
    assert found == [OK if back else NO_PREVIOUS] * 2
    programs = [outcome(each).values.program for each in requests if back]
    assert len(set(programs)) == len(programs)
    stored(robot, session)
    assert after_power_off(table) == held(robot, session)


@pytest.mark.sampled("cut_ms", keep=1)
@pytest.mark.parametrize("cut_ms", [0, 10, 20, 30, 60, 140])
@pytest.mark.parametrize("state", STATES)
def test_a_plug_that_is_pulled_leaves_a_program_that_was_there(state: str, cut_ms: int) -> None:
    table, session = begun(state)
    robot = table.robot
    kept = {after_power_off(table), program_of(EARLIER), program_of(SAVED)}
    kept |= {program_of(OTHER)} if state == "brings the program before back" else set()
    session.undo()
    robot.talk(session, cut_ms)
    assert after_power_off(table) in kept


def test_a_stranger_brings_nothing_back() -> None:
    table, _ = begun("has an owner")
    before = after_power_off(table)
    stranger = computer(9)
    assert undo(table.robot, stranger) == NOT_OWNER
    table.robot.wait(2000)
    assert after_power_off(table) == before


def test_the_small_robot_is_one() -> None:
    assert isinstance(begun("runs text", has_draft=False)[0].robot, SmallRobot)
