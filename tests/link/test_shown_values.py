"""The program of a shown value: its run and its epoch identify it, or the robot does."""

from __future__ import annotations

import struct

import pytest

from tests.support.session_frames import FORWARD, answer, event, greet, receipt
from tiniscript.bytecode.image import pack, unpack
from tiniscript.link.frames import decode_frame
from tiniscript.link.messages import BY_NAME, PLACES, STATE_IDLE, STATE_RUNNING
from tiniscript.link.outcomes import Event, MissedEvent, ShownEvent
from tiniscript.link.payloads import DoneEvent
from tiniscript.link.session import PLACE_QUESTION, Session

PROGRAM = unpack(pack("SI", 0, FORWARD)).checksum
OTHER_CHECKSUM = 0xABCDEF01
EPOCH = 10


def value(seq: int, run: int | None, at: int = 2, epoch: int = EPOCH) -> bytes:
    """Return a SHOW of 1.5; `run` None: an older robot's."""
    place = b"" if run is None else struct.pack("<BH", run, at)
    return event("SHOW", seq, {"value": 1500, "is_yes_no": 0, "place": place}, epoch)


def make_shown_event(run: int = 0, program: int = 0, place: int = -1) -> ShownEvent:
    return ShownEvent(1500, 0, run, program, place)


def new_session(run: int = 5, features: int = PLACES) -> Session:
    """Return a session that has started a run of PROGRAM."""
    session = greet(features=features)
    session.live(FORWARD)
    session.receive(answer(session.poll(0), receipt(run)), 0)
    session.events()
    return session


def events_after(session: Session, *frames: bytes, now_ms: int = 10) -> list[Event]:
    session.receive(b"".join(frames), now_ms)
    return session.events()


def answer_to_ping(
    session: Session, run: int, program: int, now_ms: int, state: int = STATE_RUNNING
) -> bytes:
    """Return the robot's answer to PING, which the session sends now and asks for its place."""
    sent_bytes = session.poll(now_ms)
    frame = decode_frame(sent_bytes.strip(b"\0"))
    assert frame and (frame.number, frame.payload) == (BY_NAME["PING"].number, PLACE_QUESTION)
    place = struct.pack("<HI", 9, program) if state == STATE_RUNNING else b""
    return answer(sent_bytes, {"state": state, "run": run, "place": place})


def test_a_value_of_our_run_is_of_our_program() -> None:
    session = new_session()
    assert events_after(session, value(1, 5)) == [make_shown_event(5, PROGRAM, 2)]
    assert events_after(session, value(2, 5, 770)) == [make_shown_event(5, PROGRAM, 770)]
    assert session.poll(10) == b"", "nothing is asked"


def test_values_of_an_older_robot_have_no_place() -> None:
    session = new_session()
    assert events_after(session, value(1, None)) == [make_shown_event()]
    assert session.poll(10) == b""


@pytest.mark.parametrize("place", [b"\5", b"\5\2"])
def test_a_truncated_place_is_ignored(place: bytes) -> None:
    session = new_session()
    truncated_event = event("SHOW", 1, {"value": 1500, "is_yes_no": 0, "place": place}, EPOCH)
    assert events_after(session, truncated_event) == [make_shown_event()]


def test_the_program_of_another_clients_run_is_queried() -> None:
    """It is requested once for each run; its values wait for the answer and are reported in
    order."""
    session = greet(features=PLACES)
    assert events_after(session, value(1, 3, 2)) == [], "it waits"
    reply = answer_to_ping(session, 3, OTHER_CHECKSUM, 20)
    assert events_after(session, value(2, 3, 7)) == []
    assert events_after(session, reply) == [
        make_shown_event(3, OTHER_CHECKSUM, 2),
        make_shown_event(3, OTHER_CHECKSUM, 7),
    ]
    assert events_after(session, value(3, 3, 2)) == [make_shown_event(3, OTHER_CHECKSUM, 2)]
    assert session.poll(30) == b""
    assert events_after(session, value(4, 4, 2)) == []
    assert events_after(session, answer_to_ping(session, 4, PROGRAM, 40)) == [
        make_shown_event(4, PROGRAM, 2)
    ]


def test_a_program_that_ended_meanwhile_has_no_name() -> None:
    session = greet(features=PLACES)
    assert events_after(session, value(1, 3)) == []
    assert events_after(session, answer_to_ping(session, 3, OTHER_CHECKSUM, 20, STATE_IDLE)) == [
        make_shown_event()
    ]
    assert events_after(session, value(2, 3)) == [make_shown_event()], "it is not asked again"


def test_nothing_but_values_waits_for_the_answer() -> None:
    session = greet(features=PLACES)
    assert events_after(session, value(1, 3)) == []
    done_event = event("DONE", 2, {"run": 3}, EPOCH)
    assert events_after(session, done_event) == [make_shown_event(), DoneEvent(3)]
    assert events_after(session, value(3, 4)) == []
    assert events_after(session, value(5, 4)) == [make_shown_event(), MissedEvent(1)], (
        "the one after it waits"
    )
    session.stop(20)
    assert session.events() == [make_shown_event()], "a stop asks nothing"


def test_a_late_value_never_gets_the_next_programs_name() -> None:
    session = new_session(run=5)
    session.live(FORWARD[:-1] + b"\3")
    next_one = answer(session.poll(20), {**receipt(6), "program": OTHER_CHECKSUM})
    assert events_after(session, value(1, 5), next_one) == [make_shown_event(5, PROGRAM, 2)]
    assert events_after(session, value(2, 5)) == [], "no robot does that: nothing is guessed"
    assert events_after(session, value(3, 6)) == [
        make_shown_event(),
        make_shown_event(6, OTHER_CHECKSUM, 2),
    ]


def test_runs_with_one_number_in_two_epochs_are_distinct() -> None:
    """A robot that was reset counts its runs anew, and so may show the old number."""
    session = new_session(run=1, features=0)
    assert events_after(session, value(1, 1)) == [make_shown_event(1, PROGRAM, 2)]
    assert events_after(session, value(2, 1, epoch=EPOCH + 1)) == [make_shown_event()]


def test_a_reused_run_number_is_a_different_run() -> None:
    session = new_session(run=5, features=0)
    session.ping()
    other_run = answer(session.poll(20), {"state": STATE_RUNNING, "run": 6, "place": b""})
    events_after(session, other_run, now_ms=20)
    assert events_after(session, value(1, 5)) == [make_shown_event()]


def test_a_robot_that_does_not_report_its_place_is_not_asked() -> None:
    session = greet(features=0)
    assert events_after(session, value(1, 3)) == [make_shown_event()]
    assert session.poll(20) == b""


def test_no_value_waits_after_a_slow_request() -> None:
    session = greet(features=PLACES)
    session.status()
    assert session.poll(10)
    assert events_after(session, value(1, 3)) == [make_shown_event()]


def test_only_subscribers_get_places() -> None:
    session = greet(features=PLACES)
    events_after(session, value(1, 3))
    assert [
        event.name
        for event in events_after(session, answer_to_ping(session, 3, OTHER_CHECKSUM, 20))
    ] == ["SHOW"]
