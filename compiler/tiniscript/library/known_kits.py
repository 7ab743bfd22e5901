"""The robots whose kits this computer knows: shipped profiles and those of users."""

from __future__ import annotations

from tiniscript import robots
from tiniscript.bytecode.image import GO, TASKS, Image, ImageRefused
from tiniscript.bytecode.verify import Refused, check
from tiniscript.robots import given
from tiniscript.robots.boards import CHIPS
from tiniscript.robots.ports import AVR_328P, AVRS
from tiniscript.robots.profile import Robot


def shipped_name_of_kit(fingerprint: int) -> str | None:
    """Return the name of the shipped robot that has this kit."""
    for name in robots.names():
        if robots.load(name).kit.fingerprint == fingerprint:
            return name
    return None


def robot_name_of_kit(fingerprint: int) -> str | None:
    """Return the name of the robot that has this kit, or None if this computer knows none."""
    robot = robot_of_kit(fingerprint)
    return None if robot is None else robot.name


def robot_of_kit(fingerprint: int) -> Robot | None:
    """Return the profile that has this kit: a shipped one, or one that a user has given before."""
    name = shipped_name_of_kit(fingerprint)
    return given.recall(fingerprint) if name is None else robots.load(name)


def may_run(image: Image, profile: Robot, fingerprint: int) -> bool:
    """Return whether the robot of this kit may run an image that was verified for `profile`.

    True if this computer does not know the kit: then the robot itself refuses a wrong image.
    """
    if not image.devices or fingerprint == profile.kit.fingerprint:
        return True
    robot = robot_of_kit(fingerprint)
    return robot is None or is_runnable(image, robot)


def find_robot_for(image: Image, preferred_robot: Robot) -> Robot | None:
    """Return a robot that may run an image: `preferred_robot`, a shipped one, or one given before.

    Returns None if no such robot is known.
    """
    if is_runnable(image, preferred_robot):
        return preferred_robot
    shipped_robots = (robots.load(name) for name in robots.names())
    given_robots = (robot for _, robot in given.profiles())
    return next(
        (
            robot
            for robot_group in (shipped_robots, given_robots)
            for robot in robot_group
            if is_runnable(image, robot)
        ),
        None,
    )


def is_runnable(image: Image, robot: Robot) -> bool:
    """Return whether a robot may run an image that `unpack` has read."""
    try:
        check(image, robot.kit)
    except (ImageRefused, Refused):
        return False
    return True


def lacks(needs: int, robot: Robot) -> bool:
    """Return whether the robot's firmware lacks something of `needs` in an image."""
    capabilities = CHIPS[robot.board.chip].capabilities
    if robot.board.discs:  # on a Nano, discs replace the reader of text, and free some memory
        capabilities |= TASKS
    if not robot.kit.speed and not robot.kit.turn:
        capabilities &= ~GO
    return bool(needs & ~capabilities)


def has_remote(robot: Robot) -> bool:
    """Return whether the robot's firmware has a remote control.

    An Uno or a Nano with discs lacks the memory.
    """
    return not robot.board.discs or AVRS.get(robot.board.chip) is not AVR_328P


def missing_need_key(needs: int, robot: Robot) -> str:
    """Return the key of the text about the missing part of `needs`, or an empty text."""
    if lacks(needs & TASKS, robot):
        return "no_tasks"
    return "no_ways" if lacks(needs, robot) else ""
