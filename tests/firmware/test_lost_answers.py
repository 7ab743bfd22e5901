"""Answers that are lost change nothing: a request that is sent again is done once, and answered.

It may be the first after HELLO, or follow any other one.
"""

from __future__ import annotations

from collections.abc import Callable
from operator import methodcaller
from random import Random
from typing import Any

import pytest

from tests.machines.host_firmware import HostFirmware, drives
from tests.support.images import image_of
from tests.support.robot_on_host import (
    KIT,
    actions_of,
    fetch_image,
    send,
    switched_on,
    wait_until_saved,
)
from tiniscript.link.connection import EXCHANGE_TIMEOUT_MS, PendingRequest
from tiniscript.link.messages import DEAD_MAN_MS
from tiniscript.link.requests import OK
from tiniscript.link.session import DEAF_MS, Session

CODE = image_of("SI|SHOW(7);F(0.2, 80)").code
REQUESTS: dict[str, Callable[[Session], PendingRequest[Any]]] = {
    "LIVE": lambda session: session.live(CODE),
    "START": lambda session: session.start(),
    "upload": lambda session: session.upload(image_of("SI|F(0.3, 40)")),
    "UNDO": lambda session: session.undo(),
    "NAME": lambda session: session.name(b"Luz"),
    "TRIM": lambda session: session.trim(b""),
}  # fmt: skip
MAX_LOST_IN_A_ROW = 2


class LossySession(Session):
    """A computer that does not get everything that the robot sends."""

    rng: Random | None = None  # None where nothing is lost
    is_deaf = False
    _lost_in_a_row = 0

    def receive(self, data: bytes, now_ms: int) -> None:
        if self.is_deaf:
            data = b""
        if data and self.rng is not None:
            is_lost = self._lost_in_a_row < MAX_LOST_IN_A_ROW and self.rng.random() < 0.5
            self._lost_in_a_row = self._lost_in_a_row + 1 if is_lost else 0
            data = b"" if is_lost else data
        super().receive(data, now_ms)


def outcomes(memory: bytes, names: list[str], rng: Random | None) -> list[object]:
    """Return what each request of a new client ends with, what the robot does, and its program."""
    robot, session = switched_on(memory), LossySession(5, 9600, KIT.fingerprint)
    assert robot.until(session, session.hello()) == OK
    session.rng = rng
    seen: list[object] = []
    for name in names:
        seen.append((name, robot.until(session, REQUESTS[name](session))))
        robot.talk(session, 3000)
    session.rng = None
    return [*seen, actions_of(robot), fetch_image(robot, session)]


@pytest.fixture(scope="module")
def memory() -> bytes:
    """What a robot with two programs keeps."""
    robot: HostFirmware = switched_on()
    session = Session(1, 9600, KIT.fingerprint)
    for text in ("SB|F(0.1, 60)", "SB|B(0.1, 60)"):
        send(robot, session, text)
        wait_until_saved(robot, session)
    return robot.memory()


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.sampled("first", keep=2)
@pytest.mark.parametrize("first", REQUESTS)
def test_a_request_is_done_once_whatever_answers_are_lost(
    memory: bytes, first: str, seed: int
) -> None:
    rng = Random(f"{first} {seed}")
    names = [first, *rng.choices(list(REQUESTS), k=2)]
    assert outcomes(memory, names, rng) == outcomes(memory, names, None)


@pytest.mark.parametrize("name", ["status", "ping", "hello", "fetch"])
@pytest.mark.parametrize("delay_ms", [0, 150, 1500])
def test_a_robot_that_is_heard_no_more_stops_by_itself(name: str, delay_ms: int) -> None:
    """It hears the computer, whose user goes on asking, and is told that the link is lost."""
    robot, session = switched_on(), LossySession(5, 9600, KIT.fingerprint)
    send(robot, session, "SI|F(60, 80)")
    robot.talk(session, 500)
    session.is_deaf = True
    end_ms = robot.now_ms + EXCHANGE_TIMEOUT_MS + DEAF_MS + 2 * DEAD_MAN_MS
    while robot.now_ms < end_ms:
        request = methodcaller(name)(session)
        while request.outcome is None:
            robot.talk(session, 10)
        robot.talk(session, delay_ms)
    assert drives(robot.did)[-1].endswith("MOTORS 0 0")
