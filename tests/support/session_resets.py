"""A robot that starts anew under a session."""

from __future__ import annotations

from tests.machines.host_firmware import HostFirmware
from tiniscript import compile_text, robots
from tiniscript.link.requests import OK
from tiniscript.link.session import Session

KIT = robots.load("tinibot").kit


def start_program(text: str) -> tuple[Session, HostFirmware]:
    """Return a robot that has just begun a program, and the session that has asked for it."""
    session, robot = Session(1, 9600, KIT.fingerprint), HostFirmware(KIT)
    robot.wait(100)
    assert robot.until(session, session.live(compile_text(text, KIT).code)) == OK
    return session, robot


def running() -> tuple[Session, HostFirmware]:
    session, robot = start_program("F(200, 80)")
    robot.talk(session, 500)
    assert session.is_running and not session.events()
    return session, robot


def reset(robot: HostFirmware, seed: int = 0x9ABCDEF1) -> HostFirmware:
    """Return the robot after a reset; `seed` decides its epoch, too."""
    host_firmware = HostFirmware(KIT, seed=seed)
    host_firmware.now_ms = robot.now_ms
    host_firmware.wait(100)
    return host_firmware
