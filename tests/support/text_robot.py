"""A robot that gets typed text, and its stored data."""

from __future__ import annotations

from tests.machines.host_firmware import HostFirmware
from tests.support.robot_on_host import computer, send, switched_on, wait_until_saved
from tiniscript.link.payloads import StatusReply
from tiniscript.link.session import Session

HOLDING_ACTIONS = [
    "MOTORS -60 -60",
    "MOTORS 0 0",
    "FINISHED",
]  # actions of the program in `holding`
LINE = ["MOTORS 50 50", "MOTORS 0 0", "FINISHED"]
SAVED_MEMORY = 1


def type_text(robot: HostFirmware, text: str | bytes, milliseconds: int = 30) -> list[str]:
    """Send bytes at 9600 baud; return the lines of the answer."""
    data = text if isinstance(text, bytes) else text.encode()
    sent_bytes = b"".join(robot.step(bytes((byte,))) for byte in data)
    return (sent_bytes + robot.wait(milliseconds)).decode("latin-1").splitlines()


def robot_with_program(
    text: str = "SB|B(0.2, 60)", saves: bool = True
) -> tuple[HostFirmware, Session]:
    """Return a robot that holds a program, and whose client has left."""
    robot, session = switched_on(), computer()
    send(robot, session, text, saves=saves)
    if saves:
        wait_until_saved(robot, session)
    robot.wait(4000)
    robot.did.clear()
    return robot, session


def status(robot: HostFirmware, session: Session) -> StatusReply:
    return robot.complete(session, session.status())


def fetch_image(robot: HostFirmware, session: Session) -> bytes:
    return robot.complete(session, session.fetch()).image


def read_back(saves: bool = True) -> tuple[HostFirmware, Session, bytes]:
    """Return a robot that holds a program, and that program, when its client has gone."""
    robot, session = robot_with_program(saves=saves)
    bytes_before = fetch_image(robot, session)
    robot.wait(4000)
    return robot, session, bytes_before
