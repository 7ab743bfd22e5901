"""Lines typed while `tsc live` runs a line on the same robot.

A robot with room for two programs drives what was typed. An Uno and a Nano have no such room: they
read only stops, and the live line continues to its end.
"""

from __future__ import annotations

import pytest

from tests.machines.host_firmware import HostFirmware
from tests.support.button_states import SmallRobot
from tests.support.images import image_of
from tests.support.robot_on_host import KIT, computer
from tiniscript.link.requests import OK
from tiniscript.link.session import Session

LIVE = "SI|F(1, 80)"
TYPED = ("SI|F(0.5, 30)", "F(0.5, 30)", "SI|W(0.1);F(0.5, 30)")


def running(kind: type[HostFirmware], after_ms: int) -> tuple[HostFirmware, Session]:
    """Return a robot that has run a live line for a while, and its session."""
    robot, session = kind(KIT), computer()
    robot.wait(100)
    assert robot.until(session, session.live(image_of(LIVE).code)) == OK
    robot.talk(session, after_ms)
    assert "MOTORS 80 80" in robot.did[-1]
    robot.did.clear()
    return robot, session


def type_line(robot: HostFirmware, session: Session, text: str, milliseconds: int) -> list[str]:
    """Type a line, let time pass, and return the robot's actions."""
    session.receive(robot.wait(20, text.encode() + b"\n"), robot.now_ms)
    robot.talk(session, milliseconds)
    return [line.split(" ", 1)[1] for line in robot.did]


@pytest.mark.parametrize("after_ms", [1, 130, 500])
@pytest.mark.parametrize("text", TYPED)
def test_typed_text_drives_a_robot_with_enough_room(text: str, after_ms: int) -> None:
    robot, session = running(HostFirmware, after_ms)
    actions = type_line(robot, session, text, 1500)
    assert actions == ["MOTORS 0 0", "MOTORS 30 30", "MOTORS 0 0", "FINISHED"]
    assert [event.name for event in session.events()] == ["STARTED", "DONE"]


@pytest.mark.parametrize("after_ms", [1, 130, 500])
@pytest.mark.parametrize("text", TYPED)
def test_a_robot_without_enough_room_continues_its_live_line(text: str, after_ms: int) -> None:
    robot, session = running(SmallRobot, after_ms)
    assert type_line(robot, session, text, 1500) == ["MOTORS 0 0", "FINISHED"]
    assert [event.name for event in session.events()] == ["DONE"]
    robot.did.clear()  # after this the robot reads text again
    actions = type_line(robot, session, text, 1500)
    assert actions == ["MOTORS 30 30", "MOTORS 0 0", "FINISHED"]


@pytest.mark.parametrize("kind", [HostFirmware, SmallRobot])
@pytest.mark.parametrize("text", ["S", "STOP", "s"])
def test_a_typed_stop_stops_both_kinds_of_robot(kind: type[HostFirmware], text: str) -> None:
    robot, session = running(kind, 130)
    assert type_line(robot, session, text, 300)[0] == "MOTORS 0 0"
    assert robot.is_latched


@pytest.mark.parametrize("text", [b"\0\0si|\0", b"SI|LOOP(2)\n", b"FOO(1)\n\0"])
@pytest.mark.parametrize("kind", [HostFirmware, SmallRobot])
def test_a_program_shows_values_while_an_answer_in_text_waits(
    kind: type[HostFirmware], text: bytes
) -> None:
    """The text waits as long as a client is heard, which may be forever."""
    robot, session = kind(KIT), computer()
    robot.wait(100)
    assert robot.until(session, session.ping()) == OK
    session.receive(robot.wait(450, text), robot.now_ms)
    image = image_of("SI|LOOP(9);M(40, 40);SHOW(1);W(0.1);END_LOOP")
    assert robot.until(session, session.upload(image, saves=False)) == OK
    robot.talk(session, 1500)
    assert [event.name for event in session.events()].count("SHOW") == 9
    assert robot.did[-1].endswith("FINISHED")
