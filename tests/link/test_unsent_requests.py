"""A request that was not sent before a reset, a fault or a stop of the robot.

After a reset or a fault, it gets the answer that it would get if it were sent then. A stop voids
it, whatever reports the stop.
"""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.machines.host_firmware import HostFirmware
from tests.support.session_resets import reset, running
from tests.support.unsent_requests import image, live, long_upload, open_session, upload
from tiniscript.link.connection import PendingRequest
from tiniscript.link.messages import STATUSES
from tiniscript.link.payloads import EmptyReply, ReceiptReply
from tiniscript.link.requests import OK, Exchange, Reply, Request, send_single
from tiniscript.link.session import Session

FAULTING_PROGRAM = "SHOW(1 / DISTANCE)"  # at once
SOON_FAULTING_PROGRAM = "W(0.6); SHOW(1 / DISTANCE)"
Interruption = Callable[[HostFirmware], HostFirmware]
Ask = Callable[[Session], PendingRequest[ReceiptReply]]


def send_unheard_request(session: Session, robot: HostFirmware, kind: str) -> None:
    """Send a request that the robot does not hear."""
    if kind == "heartbeat":
        robot.now_ms += 2000
    else:
        getattr(session, kind)()
    assert session.poll(robot.now_ms)


def stop_by_hand(robot: HostFirmware) -> HostFirmware:
    robot.push()  # its STOPPED is lost
    return robot


REQUEST_NAMES = ["heartbeat", "status", "fetch", "identify", "clear"]


@pytest.mark.parametrize("make_request", [live, upload, long_upload])
@pytest.mark.parametrize("kind", REQUEST_NAMES)
def test_an_unsent_request_is_executed_after_a_reset(kind: str, make_request: Ask) -> None:
    for seed in (0x9ABCDEF1, 3, 4, 5):
        session, robot = open_session()
        send_unheard_request(session, robot, kind)
        request = make_request(session)
        robot = reset(robot, seed)
        assert robot.until(session, request) == OK, seed


@pytest.mark.parametrize("make_request", [live, upload, long_upload])
@pytest.mark.parametrize("kind", REQUEST_NAMES)
def test_an_unsent_request_is_void_after_a_stop(kind: str, make_request: Ask) -> None:
    session, robot = running()
    send_unheard_request(session, robot, kind)
    requests = [make_request(session), make_request(session)]
    robot = stop_by_hand(robot)
    robot.codes()
    for request in requests:
        assert robot.until(session, request) == STATUSES["STALE"]
    robot.talk(session, 1000)
    assert robot.is_latched and not robot.codes()


@pytest.mark.parametrize("make_request", [live, upload, long_upload])
@pytest.mark.parametrize("is_told", [True, False])
def test_an_unsent_request_is_executed_after_a_fault(is_told: bool, make_request: Ask) -> None:
    session, robot = open_session()
    assert robot.until(session, session.live(image(SOON_FAULTING_PROGRAM).code)) == OK
    session.fetch()
    assert session.poll(robot.now_ms)
    request = make_request(session)
    fault_event = robot.wait(1000)
    if is_told:
        session.receive(fault_event, robot.now_ms)
        assert [event.name for event in session.events()] == ["FAULT"]
    assert robot.until(session, request) == OK


@pytest.mark.parametrize("verb", ["upload", "live"])
@pytest.mark.parametrize("make_request", [live, upload, long_upload])
def test_a_request_after_an_immediate_fault_is_executed(verb: str, make_request: Ask) -> None:
    session, robot = open_session()
    faulty = image(FAULTING_PROGRAM)
    first_request = session.live(faulty.code) if verb == "live" else session.upload(faulty)
    request = make_request(session)
    assert robot.until(session, first_request) == OK
    assert robot.until(session, request) == OK
    robot.talk(session, 1000)
    assert "SHOW" in [event.name for event in session.events()]


def test_a_stop_after_an_immediate_fault_voids_the_request() -> None:
    session, robot = open_session()
    assert robot.until(session, session.live(image(SOON_FAULTING_PROGRAM).code)) == OK
    session.fetch()
    assert session.poll(robot.now_ms)
    request = live(session)
    robot.wait(1000)
    robot.wait(20, bytes(8))
    assert robot.until(session, request) == STATUSES["STALE"]


def two_steps() -> Exchange[EmptyReply]:
    """Ask for something without an effect, then for something with one."""
    reply = yield Request("PING", {"asks": b""})
    if reply.status != OK:
        return Reply(reply.status)
    return (yield from send_single(Request("IDENTIFY"), EmptyReply))


def test_a_stop_reported_before_the_first_effect_voids_the_request() -> None:
    """HELLO was sent for it, or PING, and then the robot says that it was stopped."""
    session, robot = running()
    request = session._queue_exchange(two_steps())
    assert session.poll(robot.now_ms)  # no client hears it
    stop_bytes = robot.step(flags=1) + robot.wait(100)
    session.receive(stop_bytes, robot.now_ms)
    assert [event.name for event in session.events()] == ["STOPPED"]
    assert request.outcome is None
    robot.did.clear()
    assert robot.until(session, request) == STATUSES["STALE"]
    assert robot.did == []
