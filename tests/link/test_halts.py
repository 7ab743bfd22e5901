"""The actions for a client that has left: its run ends, but no request of another client does."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from tests.machines.host_firmware import HostFirmware
from tests.support.command import FOREVER
from tests.support.pty_robot import drives_now
from tests.support.unsent_requests import image, live, long_upload, open_session, upload
from tiniscript.link.connection import PendingRequest
from tiniscript.link.messages import SAVED_STORED
from tiniscript.link.outcomes import CANCELLED
from tiniscript.link.requests import OK
from tiniscript.link.session import Session

Ask = Callable[[Session], PendingRequest[Any]]
DRIVE_IMAGE = image(FOREVER)


def is_moving(robot: HostFirmware) -> bool:
    return drives_now([line.split(" ", 1)[1] for line in robot.did])


def driving_robot() -> tuple[Session, HostFirmware, int]:
    """Return a robot that drives for a client, and the run."""
    session, robot = open_session()
    assert robot.until(session, session.upload(DRIVE_IMAGE, saves=False)) == OK
    robot.talk(session, 300)
    assert is_moving(robot) and session.run is not None
    return session, robot, session.run


def name(session: Session) -> PendingRequest[Any]:
    return session.name(b"Ana")


def fetch(session: Session) -> PendingRequest[Any]:
    return session.fetch()


@pytest.mark.parametrize("make_request", [None, live, upload, long_upload, name, fetch])
@pytest.mark.parametrize("after_ms", [0, 1, 20, 150])
def test_the_run_of_a_leaving_client_ends_and_others_continue(
    make_request: Ask | None, after_ms: int
) -> None:
    """This holds whatever is in progress."""
    session, robot, run = driving_robot()
    request = make_request(session) if make_request else None
    robot.talk(session, after_ms)
    session.end_run(run, robot.now_ms)
    start_ms = robot.now_ms
    if request is not None:
        assert robot.until(session, request) == OK
    robot.talk(session, 1000)
    assert not is_moving(robot)
    motor_stops = [line for line in robot.did if line.endswith("MOTORS 0 0")]
    assert int(motor_stops[-1].split()[0]) - start_ms < 300
    events = [event.name for event in session.events()]
    assert events.count("STOPPED") <= 1
    if make_request in (live, upload, long_upload):
        assert "SHOW" in events
    assert session.is_open


def test_a_run_of_another_client_continues() -> None:
    session, robot, run = driving_robot()
    assert robot.until(session, session.upload(DRIVE_IMAGE, saves=False)) == OK
    session.end_run(run, robot.now_ms)
    robot.talk(session, 1000)
    assert is_moving(robot) and session.run != run


@pytest.mark.parametrize("after_ms", range(5))
def test_a_withdrawn_upload_starts_nothing_and_the_next_is_done(after_ms: int) -> None:
    session, robot = open_session()
    long_image = image("F(1, 80);" * 40)
    withdrawn_request = session.upload(long_image)
    other_request = live(session)
    robot.talk(session, after_ms)
    session.withdraw(withdrawn_request)
    assert withdrawn_request.outcome is not None and withdrawn_request.outcome.status == CANCELLED
    assert robot.until(session, other_request) == OK
    robot.talk(session, 1000)
    assert not is_moving(robot) and "MOTORS 80 80" not in "".join(robot.did)


def test_a_waiting_request_is_withdrawn() -> None:
    session, robot = open_session()
    first_request, withdrawn_request, last_request = (
        live(session),
        session.upload(DRIVE_IMAGE),
        live(session),
    )
    session.withdraw(withdrawn_request)
    assert withdrawn_request.outcome is not None and withdrawn_request.outcome.status == CANCELLED
    assert robot.until(session, last_request) == OK and first_request.outcome
    assert not is_moving(robot)


@pytest.mark.parametrize("answers", [OK, "BUSY"])
def test_a_frame_that_may_start_a_run_is_answered_first(answers: object) -> None:
    """No more is sent if the robot was busy."""
    session, robot = open_session()
    if answers == "BUSY":
        assert robot.until(session, session.upload(image("SB|SHOW(1)"))) == OK
    withdrawn_request = session.upload(DRIVE_IMAGE, saves=False)
    first_frames = session.poll(robot.now_ms)
    assert first_frames
    session.withdraw(withdrawn_request)
    assert withdrawn_request.outcome is None
    session.receive(robot.wait(40, first_frames), robot.now_ms)
    robot.talk(session, 300)
    assert withdrawn_request.outcome is not None
    assert (withdrawn_request.outcome.status == OK) == (answers == OK) == is_moving(robot)
    status = session.status()
    assert robot.until(session, status) == OK


def test_an_earlier_program_is_still_saved() -> None:
    session, robot = open_session()
    assert robot.until(session, session.upload(DRIVE_IMAGE)) == OK
    assert session.run is not None
    session.end_run(session.run, robot.now_ms)
    robot.talk(session, 3000)
    status = session.status()
    assert robot.until(session, status) == OK
    assert status.outcome and status.outcome.values.saved == SAVED_STORED
    assert not is_moving(robot)
