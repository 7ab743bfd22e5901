"""Connect to the robot on a port."""

from __future__ import annotations

import os

from tiniscript import robots
from tiniscript.library import opening
from tiniscript.library.connection import RobotConnection
from tiniscript.library.errors import RobotError, UsageError
from tiniscript.library.programs import Language, profile_of
from tiniscript.library.runs import whole
from tiniscript.link import known_ports, port_names, ports
from tiniscript.printable import printable

SLOWEST_BAUD, FASTEST_BAUD = 300, 2_000_000


def connect(
    port: str | None = None, *, robot: str | os.PathLike[str] | None = None,
    baud: int | None = None, language: Language = "en",
) -> RobotConnection:  # fmt: skip
    """Connect to the robot on a port: /dev/ttyUSB0, COM5, ble://name, socket://host:port, ...

    The default port is the last used one, else that of the only running virtual robot.
    `robot` is the name or the path of the profile that texts are compiled for; its default is the
    profile of the robot that answers, if this computer knows it. `baud` is 300 to 2000000; its
    default is in the profile. Raises RobotError if the port does not open or no robot answers.
    """
    profile = profile_of(robots.DEFAULT if robot is None else robot, language)
    if baud is not None:
        whole("baud", baud, SLOWEST_BAUD, FASTEST_BAUD, language)
    if port is None:
        port = _usual_port(language)
    elif not isinstance(port, str) or not port.strip() or not port.isprintable():
        raise UsageError("bad_port", language, {"port": printable(repr(port), opening.SHOWN)})
    return RobotConnection(port, profile, robot is not None, baud, language)


def _usual_port(language: Language) -> str:
    """Return the last used port, else that of the only virtual robot. Raises RobotError."""
    from tiniscript.virtual import directory

    last = known_ports.known().last
    if last is not None and port_names.is_there(last) and not directory.is_gone(last):
        return last
    running = directory.for_all()
    if len(running) == 1:
        return running[0].address
    listed = [each.port for each in ports.listed()]
    values = {"known": opening.shown(", ".join(listed)) or "-",
              "example": listed[0] if listed else "/dev/ttyUSB0"}  # fmt: skip
    if last is not None:
        raise RobotError("last_port_missing", language, {**values, "port": opening.shown(last)})
    raise RobotError("which_port", language, values)
