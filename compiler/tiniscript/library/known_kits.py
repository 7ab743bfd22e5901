"""The robots whose kits this computer knows: shipped profiles and those that users have given."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from tiniscript import robots
from tiniscript.bytecode.image import Image, ImageRefused
from tiniscript.bytecode.verify import Refused
from tiniscript.diagnostics.codes import OTHER_ROBOT, Diagnostic
from tiniscript.kit import Kit
from tiniscript.robots import given
from tiniscript.robots.profile import Robot

if TYPE_CHECKING:
    from tiniscript.link.requests import DeviceInfo, Reply

SHOWN_CHARACTERS = 60  # of a path in a message: a longer one could not be copied


def naming_robots(diagnostics: list[Diagnostic], text: str, robot: Robot) -> list[Diagnostic]:
    """Return diagnostics with hints to the robots that have a word that `robot` lacks."""
    from tiniscript.recovery.concepts import concept_of
    from tiniscript.semantics import other_kits

    if not any(map(other_kits.is_unknown, diagnostics)):
        return diagnostics
    own = robot.name, robot.kit
    return other_kits.naming_robots(diagnostics, text, own, _others(), concept_of)


def is_other_robots(diagnostics: list[Diagnostic]) -> bool:
    """Whether a program has words of another robot: they have been through `naming_robots`."""
    from tiniscript.semantics import other_kits

    unknown = [each for each in diagnostics if other_kits.is_unknown(each)]
    if any(diagnostic.code is OTHER_ROBOT for diagnostic in unknown):
        return True
    words = {diagnostic.values.get("found") for diagnostic in unknown}
    # of profiles with paths that are too long for a message
    return bool(words) and any(words & other_kits.words(robot.kit) for _, robot in given.profiles())


def _others() -> dict[str, Kit]:
    """Return the known kits, by the name or the path of their robots."""
    found: dict[str, Kit] = {}
    for name in robots.names():
        kit = robots.load(name).kit
        if kit not in found.values():  # robots on other boards may have the kit of one
            found[name] = kit
    for path, robot in given.profiles():
        try:
            near = min(path, os.path.relpath(path), key=len)
        except ValueError:  # Windows: the path is on another drive
            near = path
        if len(near) <= SHOWN_CHARACTERS and " " not in near:
            found[near] = robot.kit
    return found


def shipped_of_kit(fingerprint: int) -> str | None:
    """Return the name of the shipped robot that has this kit."""
    for name in robots.names():
        if robots.load(name).kit.fingerprint == fingerprint:
            return name
    return None


def of_kit(fingerprint: int) -> Robot | None:
    """Return the profile that has this kit: a shipped one, or one that a user has given before."""
    name = shipped_of_kit(fingerprint)
    return given.recall(fingerprint) if name is None else robots.load(name)


def may_run(image: Image, profile: Robot, kit: int) -> bool:
    """Return whether the robot of this kit may run an image that was verified for `profile`.

    True if this computer does not know the kit: then the robot itself refuses a wrong image.
    """
    if not image.devices or kit == profile.kit.fingerprint:
        return True
    found = of_kit(kit)
    return found is None or fits(image, found)


def fitting(image: Image, first: Robot) -> Robot | None:
    """Return a robot that may run an image: `first`, a shipped one, or one given before.

    Returns None if no such robot is known.
    """
    if fits(image, first):
        return first
    shipped = (robots.load(name) for name in robots.names())
    others = (robot for _, robot in given.profiles())
    return next((robot for each in (shipped, others) for robot in each if fits(image, robot)), None)


def fits(image: Image, robot: Robot) -> bool:
    """Return whether a robot may run an image that `unpack` has read."""
    from tiniscript.bytecode.loading import check

    try:
        check(image, robot.kit)
    except (ImageRefused, Refused):
        return False
    return True


def lacks(needs: int, robot: Robot) -> bool:
    """Return whether the robot's firmware lacks something of `needs` in an image."""
    if not needs:
        return False
    from tiniscript.robots.boards import CHIPS

    return bool(needs & ~CHIPS[robot.board.chip].has)


def refusal(image: Image, profile: Robot, robot: DeviceInfo) -> Reply[Any] | None:
    """Return the refusal of a program for another kit or with tasks; None where it may run."""
    from tiniscript.bytecode.image import REFUSALS
    from tiniscript.link.messages import STATUSES
    from tiniscript.link.requests import Reply

    if lacks(image.needs, profile):
        return Reply(REFUSALS["UNKNOWN_NEEDS"][0])
    if may_run(image, profile, robot.kit):
        return None
    return Reply(STATUSES["WRONG_KIT"], robot.kit)
