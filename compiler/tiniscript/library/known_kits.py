"""The robots whose kits this computer knows: the shipped ones, and those of given profiles."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tiniscript import Compiled
    from tiniscript.kit import Kit
    from tiniscript.robots.profile import Robot

SHOWN_CHARACTERS = 60  # of a path in a message: a longer one could not be copied


def naming(compiled: Compiled, robot: Robot) -> Compiled:
    """Return `compiled` with the robots named that have a word which this robot does not have."""
    from tiniscript.semantics import other_kits

    problems = compiled.problems
    if not any(map(other_kits.is_unknown, problems)):
        return compiled
    own = robot.name, robot.kit
    named = other_kits.naming_robots(problems, compiled.source.text, own, _others())
    return compiled._replace(problems=named)


def _others() -> dict[str, Kit]:
    """Return the kits that are known, by the name or the path of their robots."""
    from tiniscript import robots
    from tiniscript.robots import given

    found = {name: robots.load(name).kit for name in robots.names()}
    for path, robot in given.profiles():
        try:
            near = min(path, os.path.relpath(path), key=len)
        except ValueError:  # Windows: it is on another drive
            near = path
        if len(near) <= SHOWN_CHARACTERS and " " not in near:
            found[near] = robot.kit
    return found


def shipped_of_kit(fingerprint: int) -> str | None:
    """Return the name of the shipped robot that has this kit."""
    from tiniscript import robots

    for name in robots.names():
        if robots.load(name).kit.fingerprint == fingerprint:
            return name
    return None


def of_kit(fingerprint: int) -> Robot | None:
    """Return the profile that has this kit: a shipped one, or one that was given before."""
    from tiniscript import robots
    from tiniscript.robots import given

    name = shipped_of_kit(fingerprint)
    return given.recall(fingerprint) if name is None else robots.load(name)
