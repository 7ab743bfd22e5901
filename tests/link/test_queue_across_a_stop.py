"""Requests from before a stop start no program after it, whoever stopped the robot, and whichever
frames are lost.

Random requests wait for each other; at any moment somebody stops the robot. `Session` learns of it
from an event, from a reply, or by stopping itself; the robot knows the epoch of each frame.
"""

from __future__ import annotations

import random
from collections import Counter

import pytest

from tests.machines.host_firmware import HostFirmware
from tests.support.campaign import each_seed, make_options
from tests.support.images import image_of
from tests.support.queued_requests import (
    ACTING_REQUESTS,
    NO_LOSSES,
    OTHER_REQUESTS,
    OWN_STOP,
    STOPS,
    Ask,
    Losses,
    Wire,
)
from tiniscript.link.messages import STATE_STOPPED
from tiniscript.link.requests import OK
from tiniscript.link.session import Session

RUNS = "SI|F(60, 80)"


def is_driving(robot: HostFirmware) -> bool:
    motor_powers = [line.split()[2:] for line in robot.did if " MOTORS " in line]
    return motor_powers[-1:] not in ([], [["0", "0"]])


def check(seed: int) -> str:
    rng = random.Random(seed)
    wire = Wire(rng)
    robot, session = wire.robot, wire.session
    assert robot.until(session, session.upload(image_of(RUNS), saves=False)) == OK
    stop_kind = rng.choice([*STOPS, OWN_STOP])
    pending_requests = [
        rng.choice(ACTING_REQUESTS if rng.random() < 0.6 else OTHER_REQUESTS)(session)
        for _ in range(rng.randint(2, 5))
    ]
    wire.losses = rng.choice((NO_LOSSES, Losses(0.3, 0.3), Losses(0, 1)))
    wire.take_turns(rng.choice((0, 0, 1, 2, 3, 5, 8, 13, 30)))
    if stop_kind == "the button" and not is_driving(robot):  # it would start the stored program
        stop_kind = "zeros"
    open_ones = [
        pending_request for pending_request in pending_requests if pending_request.outcome is None
    ]
    if stop_kind == OWN_STOP:
        session.stop(robot.now_ms)
        assert all(pending_request.outcome is not None for pending_request in pending_requests), (
            f"seed {seed}"
        )
        wire.take_turns(wire.late_ms + 3)  # until it is there
        sent_bytes = b""
    else:
        sent_bytes = STOPS[stop_kind](robot, session)
    robot.codes()
    robot.did.clear()
    wire.losses = rng.choice((NO_LOSSES, Losses(0, 0.3)))
    wire.turn(b"" if rng.random() < 0.5 else sent_bytes)  # the event, if the session heard it
    wire.take_turns(rng.choice((1, 5, 200)))
    wire.losses = NO_LOSSES
    wire.take_turns(wire.late_ms)
    robot.step(b"".join(wire.under_way))
    robot.talk(session, 6000)
    outcomes = [request.outcome for request in pending_requests]
    explanation = f"seed {seed}, {stop_kind}: {robot.did}, {outcomes}"
    assert robot.codes() == [], explanation
    assert all(request.outcome is not None for request in pending_requests), explanation
    assert robot.complete(session, session.status()).state == STATE_STOPPED, explanation
    new_request = session.live(image_of("SI|F(0.2, 100)").code)
    status = robot.until(session, new_request)
    if status != OK:
        assert robot.until(session, session.hello()) == OK
        assert robot.until(session, session.live(image_of("SI|F(0.2, 100)").code)) == OK, (
            explanation
        )
    return f"{stop_kind} meets a queue" if len(open_ones) > 1 else "nothing waits"


@pytest.mark.parametrize("ask", [*OTHER_REQUESTS[:4], Session.clear])
def test_requests_of_others_leave_a_run_to_its_client(ask: Ask) -> None:
    """A latch that is not set is released, too; and the run still ends with its client."""
    wire = Wire(random.Random(1))
    robot, session = wire.robot, wire.session
    assert robot.until(session, session.upload(image_of(RUNS), saves=False)) == OK
    run = session.run
    assert robot.until(session, ask(session)) == OK
    assert is_driving(robot) and session.is_running and session.run == run is not None
    session.end_run(run, robot.now_ms)
    wire.take_turns(100)
    assert not is_driving(robot)


@pytest.mark.sampled("part")
@pytest.mark.parametrize("part", range(40))
def test_requests_made_before_a_stop_start_nothing(part: int) -> None:
    counts = Counter(check(seed) for seed in range(part * 60, (part + 1) * 60))
    assert counts["nothing waits"] < 40, counts


if __name__ == "__main__":
    each_seed(check, make_options(2000, 10_000))
