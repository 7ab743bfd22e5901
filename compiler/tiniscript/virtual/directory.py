"""Lists the running virtual robots of this user: a small file for each, in the user's cache.

The file of a robot that has crashed is ignored, because nothing listens on its port.
"""

from __future__ import annotations

import contextlib
import json
from pathlib import Path
from typing import NamedTuple

from tiniscript.base import files
from tiniscript.base.files import read_limited
from tiniscript.link.port_names import canonical_port
from tiniscript.link.sharing import peers
from tiniscript.link.sharing.registry import is_taken

FILE_BYTES = 10_000
LOCAL_HOST = "127.0.0.1"
PREFIX = f"socket://{LOCAL_HOST}:"


class RunningRobot(NamedTuple):
    """A robot: its port's address, the names of its profile and its world, and its own name.

    `terminal` is the path of its pseudo-terminal, if it has one. `verb` is the command that runs
    it: a robot of `robot` is shared; a robot of another command belongs to that command.
    """

    address: str
    robot: str
    world: str
    name: str
    terminal: str
    verb: str = "robot"


def announce(running_robot: RunningRobot) -> Path | None:
    """Publish a robot. Return the file, or None if it cannot be written."""
    path = _path(running_robot.address)
    with contextlib.suppress(OSError):  # the folder may not exist yet
        files.remove_abandoned(path.parent, [entry.name for entry in path.parent.iterdir()])
    return path if files.keep(path, json.dumps(running_robot._asdict()).encode()) else None


def withdraw(path: Path | None) -> None:
    if path is not None:
        with contextlib.suppress(OSError):
            path.unlink()


def running_robots() -> list[RunningRobot]:
    """Return the running robots. Opens none of them: that would count as a client."""
    found_robots: list[RunningRobot] = []
    paths: list[Path] = []
    with contextlib.suppress(OSError):
        paths = sorted(_folder().glob("*.json"))
    for path in paths:
        robot = _read(path)
        if robot is not None and _is_listening(robot.address):
            if not peers.is_of_another_user(_number_of(robot.address)):
                found_robots.append(robot)
        else:
            withdraw(path)
    return found_robots


def belongs_to_another(port: str) -> bool:
    """Return whether a virtual robot of this user had a port, where another user listens now: the
    robot has crashed.
    """
    address = canonical_port(port)
    if not address.startswith(PREFIX) or not _is_listening(address):
        return False
    return _read(_path(address)) is not None and peers.is_of_another_user(_number_of(address))


def unclaimed_robots() -> list[RunningRobot]:
    """Return the robots to which any command may upload a program."""
    return [robot for robot in running_robots() if robot.verb == "robot"]


def is_virtual(port: str) -> bool:
    """Return whether a port belongs to a running virtual robot."""
    names = {port, canonical_port(port)}
    return any(names & {robot.address, robot.terminal} for robot in running_robots())


def is_gone(port: str) -> bool:
    """Return whether a port is an address on this computer if nothing listens."""
    number = port.lower().removeprefix(PREFIX)
    return number != port.lower() and number.isdecimal() and not _is_listening(PREFIX + number)


def _read(path: Path) -> RunningRobot | None:
    try:
        fields = json.loads(read_limited(path, FILE_BYTES))
        robot = RunningRobot(*(fields[key] for key in RunningRobot._fields))
    except (OSError, ValueError, TypeError, KeyError, RecursionError):
        return None
    if not all(isinstance(field, str) and field.isprintable() for field in robot):
        return None
    return robot if robot.address == f"{PREFIX}{path.stem}" else None


def _is_listening(address: str) -> bool:
    """Return whether the port is taken: binding it fails then."""
    number = _number_of(address)
    return number != 0 and is_taken(number)


def _number_of(address: str) -> int:
    """Return the number of a port of this computer, or 0 if it is none."""
    digits = address.removeprefix(PREFIX)
    is_number = digits.isascii() and digits.isdigit() and len(digits) <= 5
    return int(digits) if is_number and int(digits) < 65536 else 0


def _path(address: str) -> Path:
    return _folder() / f"{address.removeprefix(PREFIX)}.json"


def _folder() -> Path:
    return files.cache_folder() / "robots"
