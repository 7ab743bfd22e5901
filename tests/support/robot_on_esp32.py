"""A whole robot on an emulated ESP32, and how a run on it ends."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from tests.machines.esp32 import Esp32Robot
from tests.support.esp32_radio import Client, End, LowEnergy, Network, SerialPort, talk
from tests.support.images import image_of
from tiniscript import robots
from tiniscript.link.connection import PendingRequest
from tiniscript.link.messages import STATUS_NAMES
from tiniscript.link.session import Session

AWAY_PROGRAM = "SI|F(60, 80)"
Make = Callable[[Esp32Robot], End]
RADIOS: list[Make] = [LowEnergy, SerialPort]
TRANSPORTS: list[Make] = [*RADIOS, Network]
Ends = list[tuple[End | None, Client]]


def boot(name: str = "tinibot32", major: int = 2) -> Esp32Robot:
    robot = Esp32Robot(robots.load(name), major=major)
    robot.wait(300)
    return robot


def wait_for_outcome(
    robot: Esp32Robot, clients: Ends, request: PendingRequest[Any], timeout_ms: int = 5000
) -> str:
    """Let all talk until a request is over; return its result."""
    for _ in range(timeout_ms):
        if request.outcome is not None:
            status = request.outcome.status
            return STATUS_NAMES.get(status, str(status))
        talk(robot, clients, 1)
    raise AssertionError("the request is not over")


def claim_robot(robot: Esp32Robot, clients: Ends, session: Session, kind: int = 0) -> None:
    """Claim a robot for a session, and hold its button."""
    claim = session.claim(kind)
    for milliseconds, flags in ((300, 0), (2500, 1), (800, 2)):
        talk(robot, clients, milliseconds, flags)
    assert claim.outcome and claim.outcome.status == 0


def upload_text(
    robot: Esp32Robot, clients: Ends, session: Session, text: str = AWAY_PROGRAM
) -> str:
    return wait_for_outcome(robot, clients, session.upload(image_of(text), saves=False))
