"""The kit of the robot that is there, where the person has not said which robot it is.

A program is compiled for the default robot then. One with words of another robot is compiled for
the robot that answers, if its profile is known: a shipped one, or one that was given before.
"""

from __future__ import annotations

import sys
from argparse import Namespace
from typing import TYPE_CHECKING

from tiniscript.cli.inputs import shown
from tiniscript.cli.texts.common import text
from tiniscript.library.known_kits import naming, of_kit

__all__ = ("is_other_robots", "naming", "of_answering", "remember", "take")

if TYPE_CHECKING:
    from tiniscript import Compiled
    from tiniscript.cli.robot.connect import Connection
    from tiniscript.robots.profile import Robot


def is_other_robots(compiled: Compiled) -> bool:
    """Whether a program has words of another robot: its problems have been through `naming`."""
    from tiniscript.diagnostics.codes import OTHER_ROBOT
    from tiniscript.robots import given
    from tiniscript.semantics import other_kits

    unknown = [problem for problem in compiled.problems if other_kits.is_unknown(problem)]
    if any(problem.code is OTHER_ROBOT for problem in unknown):
        return True
    words = {problem.values.get("found") for problem in unknown}
    # of profiles whose paths are too long to be named
    return bool(words) and any(words & other_kits.words(robot.kit) for _, robot in given.profiles())


def remember(options: Namespace, robot: Robot, kit: int) -> None:
    """Keep the profile of a file, for a robot that has this kit."""
    from tiniscript import robots

    name = getattr(options, "robot", None)
    if name is None or kit != robot.kit.fingerprint or name.lower() in robots.names():
        return
    from tiniscript.robots import given

    given.remember(name, kit)


def take(connection: Connection, options: Namespace) -> bool:
    """Take the profile of the robot that has answered, and say so; return whether it is another.

    Where the person has named a robot, or nobody knows the kit of this one, all stays as it is.
    """
    kit = connection.card.kit
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
    """Return the profile of the robot that answers where the options lead, without a question.

    None: nobody answers there, nobody knows its kit, or it is `robot`.
    """
    from tiniscript.cli.errors import Trouble
    from tiniscript.cli.robot.connect import Connection
    from tiniscript.cli.robot.simulator import running_address

    own = Namespace(**{**vars(options), "verb": "check", "asks_nothing": True})
    try:
        if options.virtual and running_address(options) is None:
            return None  # the one that comes along is what `options` say
        with Connection(own, robot, language) as connection:
            kit = connection.meet().kit
    except Trouble:
        return None
    return None if kit == robot.kit.fingerprint else of_kit(kit)
