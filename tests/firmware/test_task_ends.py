"""The end of a program ends all its tasks, whatever each of them does: on a simulated ESP32."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.machines.esp32 import Esp32Robot
from tests.support.edited_robots import TEXTS
from tests.support.images import image_of
from tests.support.robot_on_host import actions_of
from tests.support.task_states import STATES
from tiniscript.link.messages import STATE_FAULTED, STATE_STOPPED
from tiniscript.link.requests import OK
from tiniscript.link.session import Session
from tiniscript.robots.reader import read

LIGHT_L = 35  # pin of LIGHT_L
MAX_RUN = TEXTS["tinibot32"].replace("max_run_seconds = 600", "max_run_seconds = 1")
# Ways to end a run, and the fault that the robot stores.
END_ACTIONS: dict[str, tuple[Callable[[Esp32Robot, Session], object], int]] = {
    "a stop": (lambda robot, session: robot.step(bytes(4)), 0),
    "the button": (lambda robot, session: robot.talk(session, 50, flags=1), 0),
    "a lost link": (lambda robot, session: robot.wait(1100), 64),
    "max_run": (lambda robot, session: robot.talk(session, 1000), 65),
    "a stall": (lambda robot, session: robot.hang(150), 66),
    "a fault": (lambda robot, session: robot.set_analog(LIGHT_L, 4095), 2),
}


def count_shows(session: Session) -> int:
    """Return the number of values that the robot has sent since the last call."""
    return sum(event.name == "SHOW" for event in session.events())


@pytest.mark.sampled("end", keep=3)
@pytest.mark.parametrize("end", END_ACTIONS)
@pytest.mark.parametrize("state", STATES)
def test_all_ways_to_end_a_run_end_all_tasks(state: str, end: str) -> None:
    """No task continues, even in the next program."""
    robot = Esp32Robot(read(MAX_RUN, "mine"))
    robot.wait(200)
    session = Session(1, 9600, robot.robot.kit.fingerprint)

    def send(state: str) -> None:
        image = image_of(STATES[state], robot.robot.kit)
        request = session.upload(image, is_detached=end == "max_run")
        assert robot.until(session, request) == OK
        robot.talk(session, 200)

    send(state)
    driven = {"a task waits": [], "the body of a WHEN moves": ["MOTORS -40 -40"]}
    first_actions = driven.get(state, ["MOTORS 80 80"])
    assert actions_of(robot) == first_actions
    # fewer than all 400
    assert (0 < count_shows(session) < 300) == (state == "a SHOW finds no room")
    robot.did.clear()

    ended, fault = END_ACTIONS[end]
    ended(robot, session)
    robot.talk(session, 100)
    assert robot.is_latched
    count_shows(session)
    robot.talk(session, 2000)
    moves = [line for line in actions_of(robot) if line.startswith("MOTORS")]
    assert moves == ["MOTORS 0 0"] * len(first_actions)
    assert count_shows(session) == 0
    values = robot.complete(session, session.status())
    assert (values.state, values.fault) == (STATE_FAULTED if fault else STATE_STOPPED, fault)

    robot.set_analog(LIGHT_L, 0)
    robot.did.clear()
    send("the main task moves")
    assert actions_of(robot) == ["MOTORS 80 80"] and not robot.is_latched
