"""A robot that is stopped, and stopped again, while a button is down or not."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.firmware.test_host_firmware import AWAY, computer, happened, image_of, send, switched_on
from tests.machines.host_firmware import HostFirmware
from tiniscript.link.frames import Frame, decoded, encoded
from tiniscript.link.messages import BY_NAME
from tiniscript.link.requests import OK
from tiniscript.link.session import Session


def waiting(robot: HostFirmware, session: Session) -> None:
    """Bring a program that waits for the button."""
    send(robot, session, "SB|F(60, 80)")
    robot.talk(session, 100)
    robot.did.clear()


def live(robot: HostFirmware, session: Session, text: str) -> None:
    assert robot.until(session, session.live(image_of(text).code)) == OK


def stopped_by_zeros(robot: HostFirmware, session: Session) -> None:
    robot.step(bytes(4))


def stopped_by_a_message(robot: HostFirmware, session: Session) -> None:
    robot.wait(20, encoded(Frame(BY_NAME["STOP"].number, 200, 0)))


def ended(robot: HostFirmware, session: Session) -> None:
    live(robot, session, "SI|F(0.1, 80)")
    robot.talk(session, 300)
    assert happened(robot)[-1] == "FINISHED"


def faulted(robot: HostFirmware, session: Session) -> None:
    live(robot, session, "SI|X = 0; SHOW(5 / X)")
    robot.talk(session, 300)
    assert happened(robot)[-1] == "FAULTED"


def lost(robot: HostFirmware, session: Session) -> None:
    live(robot, session, AWAY)
    robot.wait(1500)
    assert happened(robot)[-1] == "FAULTED"


def still_running(robot: HostFirmware, session: Session) -> None:
    live(robot, session, "SI|F(0.3, 80)")


def left(robot: HostFirmware, session: Session) -> None:
    live(robot, session, AWAY)
    robot.step(flags=8)


BETWEENS = [stopped_by_zeros, stopped_by_a_message, ended, faulted, lost, still_running, left]


@pytest.mark.parametrize("between", BETWEENS, ids=lambda between: between.__name__)
def test_a_button_that_was_down_meanwhile_starts_nothing(
    between: Callable[[HostFirmware, Session], None],
) -> None:
    robot, session = switched_on(), computer()
    waiting(robot, session)
    robot.talk(session, 1, flags=1)
    robot.talk(session, 50)
    between(robot, session)
    robot.did.clear()
    robot.talk(session, 1, flags=2)
    robot.talk(session, 500)
    assert [line for line in happened(robot) if line.startswith("MOTORS")] in ([], ["MOTORS 0 0"])
    robot.push()
    robot.wait(10)
    assert happened(robot)[-1] == "MOTORS 80 80"


def test_a_button_that_goes_up_in_the_same_moment_as_a_stop_starts_nothing() -> None:
    """The stop has arrived in an interrupt; the main loop sees the button first."""
    robot, session = switched_on(), computer()
    waiting(robot, session)
    robot.step(flags=1)
    robot.wait(50)
    robot.step(bytes(4), flags=2 | 16)
    robot.wait(100)
    assert robot.did == []
    assert robot.is_latched


def test_a_push_that_stops_starts_nothing_and_the_next_one_does_after_a_stop() -> None:
    robot, session = switched_on(), computer()
    waiting(robot, session)
    for _ in range(3):
        robot.push()
        robot.wait(10)
        assert happened(robot)[-1] == "MOTORS 80 80"
        robot.step(flags=1)
        robot.wait(10)
        robot.step(bytes(8))
        robot.step(flags=2)
        robot.wait(200)
        assert happened(robot)[-1] == "MOTORS 0 0"


@pytest.mark.parametrize("how", ["zeros", "STOP"])
def test_a_stop_works_every_time(how: str) -> None:
    """Stop, button, stop, button: whoever stops goes on sending, as where nothing comes back."""
    robot, session = switched_on(), computer()
    waiting(robot, session)
    stop = bytes(8) if how == "zeros" else encoded(Frame(BY_NAME["STOP"].number, 7, 0))
    for _ in range(300):  # more often than a number of 8 bits can tell
        robot.push(2)
        assert happened(robot)[-1] == "MOTORS 80 80"
        robot.wait(20, stop)
        assert happened(robot)[-1] == "MOTORS 0 0"
        assert robot.is_latched
        del robot.did[:-1]


@pytest.mark.parametrize("line", [b"", b"HELLO\n", b"SI|LOOP(2)\n", b"S\n"])
@pytest.mark.parametrize("stops", [1, 2])
def test_who_stops_with_zeros_is_answered_with_a_frame_whatever_was_typed_before(
    line: bytes, stops: int
) -> None:
    robot = switched_on()
    if stops == 2:
        robot.wait(4000, bytes(8))
    robot.wait(1500, line)
    sent = robot.wait(60, bytes(8))
    assert b"//" not in sent
    frames = [decoded(each) for each in sent.split(b"\0") if each]
    assert [each and each.number for each in frames] == [BY_NAME["STOPPED"].number]
