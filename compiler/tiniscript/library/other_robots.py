"""Words that another robot has: which known robots have them, for the messages of a program."""

from __future__ import annotations

import os

from tiniscript import robots
from tiniscript.base.kit import Kit
from tiniscript.diagnostics.codes import OTHER_ROBOT, Diagnostic
from tiniscript.recovery.concepts import concept_of
from tiniscript.robots import given
from tiniscript.robots.profile import Robot
from tiniscript.semantics import other_kits

SHOWN_CHARACTERS = 60  # of a path in a message: a longer one could not be copied


def naming_robots(diagnostics: list[Diagnostic], text: str, robot: Robot) -> list[Diagnostic]:
    """Return diagnostics with hints to the robots that have a word that `robot` lacks."""
    if not any(map(other_kits.is_unknown, diagnostics)):
        return diagnostics
    own = robot.name, robot.kit
    return other_kits.naming_robots(diagnostics, text, own, _others(), concept_of)


def is_other_robots(diagnostics: list[Diagnostic]) -> bool:
    """Whether a program has words of another robot: they have been through `naming_robots`."""
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
