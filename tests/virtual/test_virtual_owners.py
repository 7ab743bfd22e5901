"""The virtual robot has an owner like any other: its button is held, and it makes itself known."""

from __future__ import annotations

import itertools

import pytest

from tests.support.owners import Keys
from tests.support.virtual_robot import Talk, robot_in
from tiniscript.link.authority import OF_ANOTHER, YOUR_OWN, whose
from tiniscript.link.messages import KEY_OWNER, STATUSES
from tiniscript.virtual.simulator import HOLD_MS, PUSH_MS, Simulator
from tiniscript.virtual.transports import Transports


def owner_of(talk: Talk) -> str:
    talk.until(talk.session.hello())
    assert talk.session.robot
    return whose(talk.session.robot)


@pytest.mark.parametrize(("held_ms", "status"), [(HOLD_MS, "OK"), (PUSH_MS, "HOLD_BUTTON")])
def test_its_button_confirms_a_claim(held_ms: int, status: str) -> None:
    keys, robot = Keys(), robot_in()
    talk = Talk(robot, keys=keys)
    request = talk.session.claim(KEY_OWNER)
    talk.wait(500)
    robot.press()
    talk.wait(held_ms)
    robot.let_go()
    assert talk.until(request).status == STATUSES[status]
    if status == "OK":
        assert [key.seals for key in keys.found] == [True]
        robot.power_cycle()
        assert owner_of(Talk(robot, 6)) == OF_ANOTHER
        assert owner_of(Talk(robot, 7, keys)) == YOUR_OWN


def test_it_is_seen_and_heard_which_one_it_is() -> None:
    robot = robot_in()
    talk = Talk(robot)
    assert talk.until(talk.session.identify()).status == 0
    lights = []
    for _ in range(35):
        talk.wait(100)
        lights.append(robot.is_lit)
    assert sum(was != now for was, now in itertools.pairwise(lights)) >= 10
    assert [event.what for event in robot.take_events()] == ["BEEP"] * 3


def test_a_long_push_of_the_simulator_lasts(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = robot_in()
    transports = Transports()
    pushed: list[tuple[str, int]] = []
    monkeypatch.setattr(robot, "press", lambda: pushed.append(("down", robot.now_ms)))
    monkeypatch.setattr(robot, "let_go", lambda: pushed.append(("up", robot.now_ms)))
    try:
        simulator = Simulator(robot, transports)
        simulator.push(HOLD_MS)
        simulator.push()  # waits until the long one is over
        for _ in range(3000):
            simulator._step(1, False)
    finally:
        transports.close()
    (_, began_ms), (_, ended_ms), (_, again_ms), (_, over_ms) = pushed
    assert ended_ms - began_ms == HOLD_MS
    assert again_ms > ended_ms
    assert over_ms - again_ms == PUSH_MS
