"""After any history, a session behaves as a fresh one does with the same robot.

Random requests, losses of the line, stops, a reset and a silence come first, the same for two
robots. Meanwhile, the end of a run is reported once. Then the one robot is asked by the session
that has seen all that, the other one by a fresh session: both are answered and told the same, and
about as soon.

`python -m tests.link.test_second_session_use 2000` tries more.
"""

from __future__ import annotations

import random
import re
from collections import Counter
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import pytest

from tests.machines.host_firmware import HostFirmware
from tests.support.campaign import each_seed, make_options
from tests.support.images import TINIBOT, image_of
from tests.support.queued_requests import (
    ACTING_REQUESTS,
    LONG_PROGRAM,
    NO_LOSSES,
    OTHER_REQUESTS,
    STOPS,
    Losses,
    Wire,
)
from tests.support.robot_on_host import computer
from tiniscript.link.connection import PendingRequest
from tiniscript.link.outcomes import (
    Event,
    LostEvent,
    MissedEvent,
    PlaceEvent,
    RestartedEvent,
    StartedEvent,
)
from tiniscript.link.payloads import StoppedEvent
from tiniscript.link.requests import OK
from tiniscript.link.session import Session

QUIET_MS = 8000
LATER_MS = 600  # extra or missing wait of a session with losses
PROGRAMS = (
    "SI|SHOW(1);F(0.2, 50);SHOW(2)",
    LONG_PROGRAM,
    "SI|X = 0;W(0.1);SHOW(1 / X)",
    "SI|F(60, 50)",
)


class UseResult(NamedTuple):
    rows: list[str]
    durations_ms: list[int]


def first_use(rng: random.Random) -> Wire:
    """Return both ends when the first story is over."""
    wire = Wire(rng)
    wire.session.tells_starts = True
    if rng.random() < 0.7:  # it is open, and heartbeats continue
        wire.session.hello()
        wire.take_turns(300)
    for _ in range(rng.randint(1, 4)):
        for _ in range(rng.randint(0, 3)):
            rng.choice(ACTING_REQUESTS if rng.random() < 0.6 else OTHER_REQUESTS)(wire.session)
        wire.losses = rng.choice((NO_LOSSES, Losses(0.3, 0.3), Losses(0.9, 0.9), Losses(0, 1)))
        wire.take_turns(rng.choice((1, 3, 8, 30, 300)))
        end_first_use(rng, wire)
    wire.losses = NO_LOSSES
    wire.take_turns(wire.late_ms)
    wire.robot.step(b"".join(wire.under_way))
    wire.under_way.clear()
    return wire


def end_first_use(rng: random.Random, wire: Wire) -> None:
    # A STOP from a client without HELLO may have a number ahead of ours: not "a message".
    end_kind = rng.choice(
        (
            "zeros",
            "the button",
            "the cable",
            "its own stop",
            "a reset",
            "a silence",
            "a dead line",
            "a dead line",
        )
    )
    if end_kind in STOPS:
        wire.turn(STOPS[end_kind](wire.robot, wire.session))
    elif end_kind == "its own stop":
        wire.session.stop(wire.robot.now_ms)
    elif end_kind == "a silence":
        wire.robot.wait(rng.choice((400, 4000)))
    elif end_kind == "a dead line":  # usually long enough for the robot to be given up
        for _ in range(rng.choice((40, 400, 1200))):
            wire.session.poll(wire.robot.now_ms)
            wire.robot.wait(10)
    elif end_kind == "a reset":
        restart(rng, wire)


def restart(rng: random.Random, wire: Wire) -> None:
    """Reset the robot. Its epoch is the seed's last byte, another one than before.

    After one reset of 256, it is the same: then a lost stop cannot be distinguished from a later
    one, so requests are STALE.
    """
    epoch = wire.session._epoch + 128 & 0xFF
    seed = (rng.getrandbits(24) | 1) << 8 | epoch
    new_robot = HostFirmware(TINIBOT, wire.robot.memory(), seed=seed)
    new_robot.now_ms = wire.robot.now_ms
    new_robot.wait(200)
    wire.robot = new_robot


def second_use(rng: random.Random, session: Session, robot: HostFirmware) -> UseResult:
    """Make some requests one after the other; return the results."""
    results: list[str] = []
    durations_ms: list[int] = []
    for _ in range(4):
        upload = partial(session.upload, image_of(rng.choice(PROGRAMS)), saves=rng.random() < 0.5)
        live_request = partial(session.live, image_of(PROGRAMS[0]).code)
        request_makers: list[Callable[[], PendingRequest[Any]]] = [
            live_request,
            upload,
            session.start,
            session.status,
            session.ping,
            session.trim,
            session.undo,
            session.fetch,
            session.identify,
        ]
        start_ms = robot.now_ms
        request = rng.choice(request_makers)()
        status = robot.until(session, request)
        assert request.outcome
        results.append(f"{status} {request.outcome.values if status == OK else ''}")
        durations_ms.append(robot.now_ms - start_ms)
        start_ms = robot.now_ms
        if rng.random() < 0.3:
            session.stop(robot.now_ms)
        elif rng.random() < 0.3 and session.is_running:  # a robot at rest was stopped earlier
            session.receive(robot.step(bytes(4)), robot.now_ms)  # another client
        robot.talk(session, rng.choice((5, 700)))
        results += [str(event) for event in session.events() if not isinstance(event, MissedEvent)]
    robot.talk(session, 1500)
    results += [str(event) for event in session.events()]
    return UseResult([re.sub(r"\b(run|boot|damaged|dropped|nonce)=\d+", r"\1",
        row) for row in results],
                durations_ms)  # fmt: skip


def ends_are_told_once(events: list[Event]) -> bool:
    """Return whether no inferred end of a run follows its reported end."""
    is_told = False
    for event in events:
        if isinstance(event, StartedEvent):
            is_told = False
        elif is_told and (isinstance(event, RestartedEvent) or event == StoppedEvent(0)):
            return False
        is_told = is_told or isinstance(event, (LostEvent, RestartedEvent, StoppedEvent))
    return True


def check(seed: int) -> str:
    used_wire, other_use = first_use(random.Random(seed)), first_use(random.Random(seed))
    for wire in (used_wire, other_use):
        wire.robot.talk(wire.session, QUIET_MS)
        if not wire.robot.is_latched:  # detached programs continue
            wire.session.stop(wire.robot.now_ms)
            wire.robot.talk(wire.session, 300)
    events = used_wire.session.events()
    assert ends_are_told_once(events), f"seed {seed} {events}"
    session = computer(77)
    session.tells_starts = True
    assert other_use.robot.until(session, session.hello()) == OK
    actual = second_use(random.Random(seed), used_wire.session, used_wire.robot)
    expected_use = second_use(random.Random(seed), session, other_use.robot)
    assert actual.rows == expected_use.rows, f"seed {seed}\n{actual.rows}\nnot\n{expected_use.rows}"
    delays_ms = [a - b for a, b in zip(actual.durations_ms, expected_use.durations_ms, strict=True)]
    assert all(abs(delay_ms) < LATER_MS for delay_ms in delays_ms), f"seed {seed} {delays_ms}"
    return "it runs" if "DoneEvent" in str(expected_use) else "it stands"


def open_wire(rng: random.Random) -> Wire:
    wire = Wire(rng)
    wire.session.hello()
    wire.take_turns(300)
    return wire


@pytest.mark.parametrize("is_stopped", [False, True])
@pytest.mark.parametrize("dead_ms", range(0, 1500, 300))
def test_a_restarted_robot_executes_requests_once_the_line_is_back(
    dead_ms: int, is_stopped: bool
) -> None:
    """This holds even if the query of its identity was lost, or dropped by a stop."""
    rng = random.Random(dead_ms)
    wire = open_wire(rng)
    restart(rng, wire)
    wire.turn(STOPS["zeros"](wire.robot, wire.session))
    for _ in range(dead_ms // 10):
        wire.session.poll(wire.robot.now_ms)
        wire.robot.wait(10)
    if is_stopped:
        wire.session.stop(wire.robot.now_ms)
    wire.robot.talk(wire.session, QUIET_MS)
    assert wire.robot.until(wire.session, wire.session.identify()) == OK


@pytest.mark.parametrize("stop_kind", STOPS)
def test_a_request_after_a_stop_seen_in_an_answer_is_executed(stop_kind: str) -> None:
    wire = open_wire(random.Random(1))
    STOPS[stop_kind](wire.robot, wire.session)  # no client hears it
    wire.robot.until(wire.session, wire.session.fetch())
    assert wire.robot.until(wire.session, wire.session.identify()) == OK


@pytest.mark.parametrize("fate", ["nothing", "a reset", *STOPS])
def test_a_run_reported_as_lost_reports_nothing_more(fate: str) -> None:
    rng = random.Random(fate)
    wire = open_wire(rng)
    wire.session.tells_starts = wire.session.tells_places = True
    assert wire.robot.until(wire.session, wire.session.live(image_of("F(60, 50)").code)) == OK
    wire.robot.talk(wire.session, 500)
    assert lose(wire)
    if fate in STOPS:
        STOPS[fate](wire.robot, wire.session)
    elif fate == "a reset":
        restart(rng, wire)
    wire.robot.wait(1000)
    assert wire.robot.until(wire.session, wire.session.hello()) == OK
    wire.robot.talk(wire.session, QUIET_MS)
    assert wire.session.events() == []


def test_a_robot_found_again_reports_its_place() -> None:
    """Though that is where it was before."""
    wire = open_wire(random.Random(1))
    wire.session.tells_places = True
    program = image_of("SI|W(100)")
    upload = wire.session.upload(program, saves=False, is_detached=True)
    assert wire.robot.until(wire.session, upload) == OK
    places = []
    for _ in range(2):
        wire.robot.talk(wire.session, 1500)
        places.append([event for event in wire.session.events() if isinstance(event, PlaceEvent)])
        assert lose(wire)
        assert wire.robot.until(wire.session, wire.session.hello()) == OK
    assert places[0] == places[1] != []


def lose(wire: Wire) -> bool:
    """Block both directions; return whether the session reports only that."""
    wire.session.events()
    events: list[Event] = []
    for _ in range(800):
        wire.session.poll(wire.robot.now_ms)
        wire.robot.wait(10)
        events += wire.session.events()
    return [event.name for event in events] == ["LOST"]


@pytest.mark.sampled("part")
@pytest.mark.parametrize("part", range(20))
def test_a_session_behaves_like_a_fresh_one_after_any_history(part: int) -> None:
    counts = Counter(check(seed) for seed in range(part * 20, (part + 1) * 20))
    assert counts["it runs"] > 0, counts


if __name__ == "__main__":
    each_seed(check, make_options(2000, 10_000))
