"""The kit of the connected robot, for commands without `--robot`.

With such a kit, a command compiles for the default robot. A program with words of another robot is
compiled for the robot that answers, if its profile is known: a shipped one, or one given before.
"""

from __future__ import annotations

from argparse import Namespace

from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.texts import say_aside
from tiniscript.library.known_kits import robot_of_kit
from tiniscript.robots.profile import Robot


def use_answering_profile(connection: Connection, options: Namespace) -> bool:
    """Use the profile of the robot that has answered, and print so; return True if it is another.

    If the user has named a robot, or the kit is unknown, nothing changes.
    """
    kit = connection.device_info.kit
    if options.robot is not None or kit == connection.profile.kit.fingerprint:
        return False
    robot = robot_of_kit(kit)
    if robot is None:
        return False
    connection.profile = robot
    say_aside("own_kit", connection.language, robot=printable_name(robot.name))
    return True


def find_answering_robot(options: Namespace, robot: Robot, language: str) -> Robot | None:
    """Return the profile of the robot that answers on the port of the options; asks no question.

    Returns None if no robot answers, its kit is unknown, or it is `robot`.
    """
    from tiniscript.cli.robot.simulator import running_address

    check_options = Namespace(**{**vars(options), "verb": "check", "asks_nothing": True})
    try:
        if options.virtual and running_address(options) is None:
            return None  # `options` describe the own virtual robot
        with Connection(check_options, robot, language) as connection:
            kit = connection.meet().kit
    except CommandError:
        return None
    return None if kit == robot.kit.fingerprint else robot_of_kit(kit)
