"""What was asked for before a stop starts nothing after it, whoever has stopped the robot, and
whatever of that is lost on the way.

Random requests wait for each other; at any moment somebody stops the robot. `Session` knows of it
from an event, from a reply, or is what stops; the robot knows the epoch of each frame.
"""

from __future__ import annotations

import random
from collections import Counter, deque
from collections.abc import Callable
from typing import Any, NamedTuple

import pytest

from tests.firmware.test_host_firmware import computer, switched_on
from tests.machines.host_firmware import HostFirmware
from tests.support.campaign import each_seed, wanted
from tests.support.images import image_of
from tiniscript.link.connection import PendingRequest
from tiniscript.link.frames import Frame, encode_frame
from tiniscript.link.messages import BY_NAME, STATE_STOPPED
from tiniscript.link.requests import OK
from tiniscript.link.session import Session

SHORT, LONG = "SI|F(60, 40)", "SI|" + "F(0.1, 30); B(0.1, 20);" * 30
RUNS = "SI|F(60, 80)"
STOP_MESSAGE = b"\0" + encode_frame(Frame(BY_NAME["STOP"].number, 99, 0))
Ask = Callable[[Session], PendingRequest[Any]]
ACTING: list[Ask] = [
    lambda session: session.live(image_of(SHORT).code),
    lambda session: session.upload(image_of(SHORT), saves=False),
    lambda session: session.upload(image_of(LONG)),
    lambda session: session.start(),
    lambda session: session.start(is_detached=True),
]
OTHERS: list[Ask] = [
    lambda session: session.status(),
    lambda session: session.ping(),
    lambda session: session.hello(),
    lambda session: session.trim(),
    lambda session: session.undo(),
]
STOPS: dict[str, Callable[[HostFirmware, Session], bytes]] = {
    "zeros": lambda robot, session: robot.step(bytes(8)),
    "a message": lambda robot, session: robot.step(STOP_MESSAGE),
    "the button": lambda robot, session: robot.step(flags=1) + robot.step(flags=2),
    "the cable": lambda robot, session: robot.step(flags=8) + robot.step(bytes(4)),
}
OWN = "its own"


class Losses(NamedTuple):
    """How much of what the one and the other is told."""

    to_robot: float
    to_session: float


NOTHING = Losses(0, 0)


class Wire:
    """What goes between both: at times it loses what the one or the other says, and some carry
    what the robot shall hear late: a frame is under way while somebody else stops it.
    """

    def __init__(self, rng: random.Random) -> None:
        self.robot, self.session = switched_on(), computer()
        self.rng = rng
        self.loses = NOTHING
        self.late_ms = rng.choice((0, 0, 4, 20))
        self.under_way: deque[bytes] = deque()

    def turn(self, sent: bytes = b"") -> None:
        data = self.session.poll(self.robot.now_ms)
        if self.rng.random() < self.loses.to_robot:
            data = b""
        self.under_way.append(data)
        is_late = len(self.under_way) <= self.late_ms
        sent += self.robot.step(b"" if is_late else self.under_way.popleft())
        if self.rng.random() >= self.loses.to_session:
            self.session.receive(sent, self.robot.now_ms)

    def turns(self, count: int) -> None:
        for _ in range(count):
            self.turn()


def is_driving(robot: HostFirmware) -> bool:
    driven = [line.split()[2:] for line in robot.did if " MOTORS " in line]
    return driven[-1:] not in ([], [["0", "0"]])


def check(seed: int) -> str:
    rng = random.Random(seed)
    wire = Wire(rng)
    robot, session = wire.robot, wire.session
    assert robot.until(session, session.upload(image_of(RUNS), saves=False)) == OK
    how = rng.choice([*STOPS, OWN])
    pending_requests = [rng.choice(ACTING if rng.random() < 0.6 else OTHERS)(session)
             for _ in range(rng.randint(2, 5))]  # fmt: skip
    wire.loses = rng.choice((NOTHING, Losses(0.3, 0.3), Losses(0, 1)))
    wire.turns(rng.choice((0, 0, 1, 2, 3, 5, 8, 13, 30)))
    if how == "the button" and not is_driving(robot):  # it would start what is held
        how = "zeros"
    open_ones = [
        pending_request for pending_request in pending_requests if pending_request.outcome is None
    ]
    if how == OWN:
        session.stop(robot.now_ms)
        assert all(pending_request.outcome is not None for pending_request in pending_requests), (
            f"seed {seed}"
        )
        wire.turns(wire.late_ms + 3)  # until it is there
        sent = b""
    else:
        sent = STOPS[how](robot, session)
    robot.codes()
    robot.did.clear()
    wire.loses = rng.choice((NOTHING, Losses(0, 0.3)))
    wire.turn(b"" if rng.random() < 0.5 else sent)  # the event, or nobody has heard it
    wire.turns(rng.choice((1, 5, 200)))
    wire.loses = NOTHING
    wire.turns(wire.late_ms)
    robot.step(b"".join(wire.under_way))
    robot.talk(session, 6000)
    said = f"seed {seed}, {how}: {robot.did}, {[request.outcome for request in pending_requests]}"
    assert robot.codes() == [], said
    assert all(request.outcome is not None for request in pending_requests), said
    assert robot.done(session, session.status()).state == STATE_STOPPED, said
    new = session.live(image_of("SI|F(0.2, 100)").code)
    status = robot.until(session, new)
    if status != OK:
        assert robot.until(session, session.hello()) == OK
        assert robot.until(session, session.live(image_of("SI|F(0.2, 100)").code)) == OK, said
    return f"{how} meets a queue" if len(open_ones) > 1 else "nothing waits"


@pytest.mark.sampled("part")
@pytest.mark.parametrize("part", range(40))
def test_what_was_asked_for_before_a_stop_starts_nothing(part: int) -> None:
    found = Counter(check(seed) for seed in range(part * 60, (part + 1) * 60))
    assert found["nothing waits"] < 40, found


if __name__ == "__main__":
    each_seed(check, wanted(2000, 10_000))
