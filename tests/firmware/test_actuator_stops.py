"""Actuators at the end of a program: in the firmware, and in the virtual robot."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.machines.host_firmware import HostFirmware
from tests.support.edited_robots import TEXTS
from tests.support.images import image_of
from tests.support.virtual_robot import Talk
from tiniscript import robots
from tiniscript.cli.terminal.run_drawing import Picture
from tiniscript.link.requests import OK
from tiniscript.link.session import Session
from tiniscript.robots.reader import read
from tiniscript.virtual import worlds
from tiniscript.virtual.robot import VirtualRobot

GRABBER = robots.load("grabber")
KIT = GRABBER.kit
WAITING_PROGRAM = "SI|LED(TRUE);GRIPPER(90);W(60)"
SET_ACTIONS = ["SET 1 1", "SET 0 90000"]


def start_program(text: str, **options: bool) -> tuple[HostFirmware, Session]:
    robot = HostFirmware(KIT)
    robot.wait(200)
    session = Session(1, 9600, KIT.fingerprint)
    assert robot.until(session, session.upload(image_of(text, KIT), **options)) == OK
    robot.talk(session, 50)
    return robot, session


def send_stop_sequence(robot: HostFirmware, session: Session) -> None:
    robot.talk(session, 1)
    robot.wait(50, bytes(8))


def send_stop_message(robot: HostFirmware, session: Session) -> None:
    session.stop(robot.now_ms)
    robot.talk(session, 300)


def replace_program(robot: HostFirmware, session: Session) -> None:
    assert robot.until(session, session.upload(image_of("SI|W(60)"))) == OK


END_ACTIONS: dict[str, Callable[[HostFirmware, Session], object]] = {
    "the stop sequence": send_stop_sequence,
    "a stop of the computer": send_stop_message,
    "the button": lambda robot, session: robot.push(),
    "a lost link": lambda robot, session: robot.wait(1200),
    "nobody connected": lambda robot, session: robot.step(flags=8),
    "a stall": lambda robot, session: robot.step(flags=4),
    "another program": replace_program,
}


@pytest.mark.parametrize("end", END_ACTIONS)
def test_an_interrupted_program_releases_the_actuators(end: str) -> None:
    robot, session = start_program(WAITING_PROGRAM)
    END_ACTIONS[end](robot, session)
    robot.wait(5)
    actions = [line.split(" ", 1)[1] for line in robot.did]
    assert [line for line in actions if "SET" in line or "ACT" in line] == [
        *SET_ACTIONS,
        "ACTUATORS OFF",
    ]


@pytest.mark.parametrize(("text", "lets_go"), [
    ("SI|LED(TRUE);GRIPPER(90);W(0.1)", False),
    ("SI|LED(TRUE);GRIPPER(90);X = 0;SHOW(1 / X)", True),
])  # fmt: skip
def test_a_normal_end_keeps_the_actuators_and_a_fault_releases_them(
    text: str, lets_go: bool
) -> None:
    robot, session = start_program(text)
    robot.talk(session, 500)
    assert ("ACTUATORS OFF" in "".join(robot.did)) == lets_go
    assert any("FINISHED" in line or "FAULTED" in line for line in robot.did)
    send_stop_sequence(robot, session)  # a stop also reaches a robot at rest
    assert "ACTUATORS OFF" in "".join(robot.did)


# -- the virtual robot

HOLDING_GRABBER = read(TEXTS["grabber"].replace('at_stop = "release"', 'at_stop = "hold"'), "holds")


@pytest.mark.parametrize(("robot_name", "sentences", "drawn_values"), [
    ("grabber", ["RELEASE GRIPPER", "SET LED FALSE"], {1: 0}),
    ("holds", ["SET LED FALSE"], {0: 90000, 1: 0}),
])  # fmt: skip
def test_the_virtual_robot_prints_and_draws_the_release(
    robot_name: str, sentences: list[str], drawn_values: dict[int, int]
) -> None:
    profile = {"grabber": GRABBER, "holds": HOLDING_GRABBER}[robot_name]
    robot = VirtualRobot(profile, worlds.load("obstacles"))
    talk = Talk(robot)
    assert talk.upload(WAITING_PROGRAM).status == 0
    talk.wait(100)
    robot.press()
    robot.let_go()
    events = robot.take_events()
    assert [event.text for event in events][-len(sentences) - 1 :] == [*sentences, "STOP"]
    picture = Picture(profile, "en")
    for event in events:
        if event.kind != "START":
            picture.add_event(event)
    assert picture.value_by_actuator == drawn_values == robot.actuators
    robot.press()
    assert not [event for event in robot.take_events() if event.kind in ("SET", "RELEASE")]
