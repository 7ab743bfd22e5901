"""A whole robot on this computer, and the requests to it."""

from __future__ import annotations

from typing import TypeVar

from tests.machines.host_firmware import EMPTY_EEPROM, HostFirmware
from tests.support.images import image_of
from tiniscript import robots
from tiniscript.link.connection import PendingRequest
from tiniscript.link.messages import SAVED_STORED
from tiniscript.link.requests import OK, Reply
from tiniscript.link.session import Session

KIT = robots.load("tinibot").kit
LONG_PROGRAM = "SI|" + "F(0.1, 80); B(0.1, 60); SHOW(1); " * 20
AWAY_PROGRAM = "SI|F(60, 80)"


def switched_on(memory: bytes = EMPTY_EEPROM, **options: float) -> HostFirmware:
    """Return a robot that has read its stored data."""
    robot = HostFirmware(KIT, memory, **options)  # type: ignore[arg-type]
    robot.wait(200)
    assert robot.did == []
    assert robot.is_latched
    return robot


def computer(nonce: int = 1) -> Session:
    return Session(nonce, 9600, KIT.fingerprint)


def send(robot: HostFirmware, session: Session, text: str, **options: bool) -> None:
    assert robot.until(session, session.upload(image_of(text), **options)) == OK


T = TypeVar("T")


def outcome(request: PendingRequest[T]) -> Reply[T]:
    assert request.outcome is not None
    return request.outcome


def fetch_image(robot: HostFirmware, session: Session) -> bytes:
    return robot.complete(session, session.fetch()).image


def wait_until_saved(robot: HostFirmware, session: Session, timeout_ms: int = 10_000) -> int:
    """Wait until the robot says that its program is saved; return how long that took."""
    start_ms = robot.now_ms
    while robot.now_ms < start_ms + timeout_ms:
        if robot.complete(session, session.status()).saved == SAVED_STORED:
            return robot.now_ms - start_ms
        robot.talk(session, 50)
    raise AssertionError("the program is not saved")


def robot_with_saved_program(text: str = "SB|F(0.2, 80)") -> tuple[HostFirmware, Session]:
    """Return a robot that has saved a program, and its session."""
    robot, session = switched_on(), computer()
    send(robot, session, text)
    wait_until_saved(robot, session)
    return robot, session


def broken_upload(robot: HostFirmware, session: Session) -> None:
    """Break off an upload, so that the robot holds its stored program."""
    request = session.upload(image_of(LONG_PROGRAM))
    robot.talk(session, 3)
    assert request.outcome is None
    robot.wait(3000)


def actions_of(robot: HostFirmware) -> list[str]:
    return [line.split(" ", 1)[1] for line in robot.did]


def push_button(robot: HostFirmware, milliseconds: int = 400) -> list[str]:
    """Push the button; return the robot's reaction."""
    robot.did.clear()
    robot.push()
    robot.wait(milliseconds)
    return actions_of(robot)


def live(robot: HostFirmware, session: Session, text: str) -> None:
    request = session.live(image_of(text).code)
    assert robot.until(session, request) == OK
