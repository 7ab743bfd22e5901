"""Requests that wait, and a line that loses some of them."""

from __future__ import annotations

import random
from collections import deque
from collections.abc import Callable
from typing import Any, NamedTuple

from tests.machines.host_firmware import HostFirmware
from tests.support.images import image_of
from tests.support.robot_on_host import computer, switched_on
from tiniscript.link.connection import PendingRequest
from tiniscript.link.frames import Frame, encode_frame
from tiniscript.link.messages import BY_NAME
from tiniscript.link.session import Session

SHORT_PROGRAM, LONG_PROGRAM = "SI|F(60, 40)", "SI|" + "F(0.1, 30); B(0.1, 20);" * 30
STOP_MESSAGE = b"\0" + encode_frame(Frame(BY_NAME["STOP"].number, 99, 0))
Ask = Callable[[Session], PendingRequest[Any]]
ACTING_REQUESTS: list[Ask] = [
    lambda session: session.live(image_of(SHORT_PROGRAM).code),
    lambda session: session.upload(image_of(SHORT_PROGRAM), saves=False),
    lambda session: session.upload(image_of(LONG_PROGRAM)),
    lambda session: session.start(),
    lambda session: session.start(is_detached=True),
]
OTHER_REQUESTS: list[Ask] = [
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
OWN_STOP = "its own"


class Losses(NamedTuple):
    """Loss rates of both directions."""

    to_robot: float
    to_session: float


NO_LOSSES = Losses(0, 0)


class Wire:
    """A connection that sometimes loses either side's frames and delivers others late: a frame may
    be under way while another client stops the robot.
    """

    def __init__(self, rng: random.Random) -> None:
        self.robot, self.session = switched_on(), computer()
        self.rng = rng
        self.losses = NO_LOSSES
        self.late_ms = rng.choice((0, 0, 4, 20))
        self.under_way: deque[bytes] = deque()

    def turn(self, sent_bytes: bytes = b"") -> None:
        data = self.session.poll(self.robot.now_ms)
        if self.rng.random() < self.losses.to_robot:
            data = b""
        self.under_way.append(data)
        is_late = len(self.under_way) <= self.late_ms
        sent_bytes += self.robot.step(b"" if is_late else self.under_way.popleft())
        if self.rng.random() >= self.losses.to_session:
            self.session.receive(sent_bytes, self.robot.now_ms)

    def take_turns(self, count: int) -> None:
        for _ in range(count):
            self.turn()
