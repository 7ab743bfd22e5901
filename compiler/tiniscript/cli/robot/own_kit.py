"""The kit of the connected robot, for commands without `--robot`.

Such a command compiles for the default robot. A program with words of another robot is compiled
for the robot that answers, if its profile is known: a shipped one, or one given before.
"""

from __future__ import annotations

import sys
from argparse import Namespace
from typing import TYPE_CHECKING

from tiniscript.cli.inputs import shown
from tiniscript.cli.texts.common import text
from tiniscript.library.known_kits import of_kit

if TYPE_CHECKING:
    from tiniscript.cli.robot.connect import Connection
    from tiniscript.library.compiling import Compiled
    from tiniscript.robots.profile import Robot


def is_other_robots(compiled: Compiled) -> bool:
    """Whether a program has words of another robot: its diagnostics have been through `naming`."""
    from tiniscript.diagnostics.codes import OTHER_ROBOT
    from tiniscript.robots import given
    from tiniscript.semantics import other_kits

    unknown = [
        diagnostic for diagnostic in compiled.diagnostics if other_kits.is_unknown(diagnostic)
    ]
    if any(diagnostic.code is OTHER_ROBOT for diagnostic in unknown):
        return True
    words = {diagnostic.values.get("found") for diagnostic in unknown}
    # of profiles with paths that are too long for a message
    return bool(words) and any(words & other_kits.words(robot.kit) for _, robot in given.profiles())


def remember(options: Namespace, robot: Robot, kit: int) -> None:
    """Remember the profile of a file for the robots with this kit."""
    from tiniscript import robots

    name = getattr(options, "robot", None)
    if name is None or kit != robot.kit.fingerprint or name.lower() in robots.names():
        return
    from tiniscript.robots import given

    given.remember(name, kit)


def take(connection: Connection, options: Namespace) -> bool:
    """Use the profile of the robot that has answered, and print so; return True if it is another.

    If the user has named a robot, or the kit is unknown, nothing changes.
    """
    kit = connection.device_info.kit
    if options.robot is not None or kit == connection.profile.kit.fingerprint:
        return False
    robot = of_kit(kit)
    if robot is None:
        return False
    connection.profile = robot
    said = text("own_kit", connection.language).format(robot=shown(robot.name))
    print(said, file=sys.stderr, flush=True)
    return True


def of_answering(options: Namespace, robot: Robot, language: str) -> Robot | None:
    """Return the profile of the robot that answers on the port of the options; asks no question.

    Returns None if no robot answers, its kit is unknown, or it is `robot`.
    """
    from tiniscript.cli.errors import CommandError
    from tiniscript.cli.robot.connect import Connection
    from tiniscript.cli.robot.simulator import running_address

    own = Namespace(**{**vars(options), "verb": "check", "asks_nothing": True})
    try:
        if options.virtual and running_address(options) is None:
            return None  # `options` describe the own virtual robot
        with Connection(own, robot, language) as connection:
            kit = connection.meet().kit
    except CommandError:
        return None
    return None if kit == robot.kit.fingerprint else of_kit(kit)
