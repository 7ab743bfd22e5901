"""A session with a robot that was reset meanwhile: it counts its events and its runs anew."""

from __future__ import annotations

import pytest

from tests.support.session_resets import KIT, reset, running, start_program
from tiniscript import compile_text
from tiniscript.bytecode.opcodes import FAULTS
from tiniscript.link.messages import STATUSES
from tiniscript.link.outcomes import StartedEvent
from tiniscript.link.payloads import FaultEvent, StoppedEvent
from tiniscript.link.requests import OK
from tiniscript.link.session import Session


def test_a_reset_robot_runs_its_first_program_with_a_heartbeat() -> None:
    session, robot = start_program("SHOW(1)")
    robot.talk(session, 500)
    assert [event.name for event in session.events()] == ["SHOW", "DONE"]
    robot = reset(robot)  # run 1 of before has ended, the next one's has not
    code = compile_text("SHOW(2);F(2, 80);SHOW(3)", KIT).code
    assert robot.until(session, session.live(code)) == OK  # after HELLO
    assert session.is_running
    robot.talk(session, 2500)
    assert [event.name for event in session.events()] == ["SHOW", "SHOW", "DONE"]


@pytest.mark.parametrize("seed", range(1, 9))
def test_a_reset_during_a_run_is_reported_and_does_not_end_the_program(seed: int) -> None:
    session, robot = running()
    robot = reset(robot, seed)
    robot.talk(session, 1500)
    assert [event.name for event in session.events()] == ["RESTARTED"]
    assert not session.is_running and session.is_open
    assert robot.until(session, session.live(compile_text("SHOW(2)", KIT).code)) == OK
    robot.talk(session, 500)
    assert [event.name for event in session.events()] == ["SHOW", "DONE"]


def test_a_reset_during_a_run_first_noticed_by_a_request_is_reported() -> None:
    for is_acting in (False, True):
        session, robot = running()
        robot = reset(robot)
        request = session.identify() if is_acting else session.status()
        assert robot.until(session, request) == OK
        robot.talk(session, 500)
        assert [event.name for event in session.events()] == ["RESTARTED"]


def test_a_robot_that_was_reset_and_started_by_its_button_has_another_run() -> None:
    session, robot = running()
    robot = reset(robot)
    other_session = Session(2, 9600, KIT.fingerprint)
    code = compile_text("F(200, 80)", KIT).code
    assert robot.until(other_session, other_session.live(code)) == OK  # run 1, as ours was
    robot.talk(session, 1500)
    assert [event.name for event in session.events()][:1] == ["RESTARTED"]


def test_another_run_in_place_of_ours_does_not_end_it() -> None:
    """The robot was not reset: another client has started another run on it."""
    session, robot = running()
    other_session = Session(2, 9600, KIT.fingerprint)
    other_session.hello()
    robot.talk(other_session, 200)
    assert (
        robot.until(other_session, other_session.live(compile_text("F(300, 80)", KIT).code)) == OK
    )
    robot.talk(session, 1500)
    events = session.events()
    assert StartedEvent in [type(event) for event in events], events
    assert "RESTARTED" not in [event.name for event in events]
    assert "STOPPED" not in [event.name for event in events]


def test_an_unreported_stop_is_not_a_reset() -> None:
    session, robot = running()
    robot.push()  # STOPPED is lost
    robot.talk(session, 1500)
    [end_event] = session.events()
    assert end_event == StoppedEvent(0) and session.is_latched


def test_an_unreported_fault_is_queried() -> None:
    session, robot = start_program("W(0.6); SHOW(1 / DISTANCE)")
    robot.wait(900)  # its end is lost
    robot.talk(session, 1500)
    assert session.events() == [FaultEvent(1, FAULTS[1][0], 5, 481506241)]


def test_requests_are_not_retried_after_a_reset_and_a_stop() -> None:
    session, robot = running()
    session.events()
    robot = reset(robot)
    robot.wait(20, bytes(8))
    code = compile_text("F(200, 80)", KIT).code
    assert robot.until(session, session.live(code)) == STATUSES["STALE"]
    assert robot.is_latched
