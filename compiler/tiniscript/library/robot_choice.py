"""Which robot a program is for: the one that somebody has chosen, else the one that it names."""

from __future__ import annotations

from tiniscript import robots
from tiniscript.base.source import Edit, Unreadable, decode
from tiniscript.base.words import nearest
from tiniscript.diagnostics.codes import NO_SUCH_ROBOT, Diagnostic, Repair
from tiniscript.robots.profile import Robot
from tiniscript.syntax.named_robot import named_robot


def robot_of(data: bytes, usual: Robot) -> Robot:
    """Return the shipped robot that a program's text names, else `usual`."""
    name = name_in(data)
    return usual if name in (None, usual.name) else robots.load(str(name))


def name_in(data: bytes) -> str | None:
    """Return the name of the shipped robot that a program's text names, or None."""
    found = (named(data) or "").lower()
    return found if found in robots.names() else None


def named(data: bytes) -> str | None:
    """Return how a program's text names its robot, or None; an image names none."""
    try:
        found = named_robot(decode(data))
    except Unreadable:
        return None
    return found.name if found else None


def unknown_robot(text: str) -> Diagnostic | None:
    """Return the mistake of a program that names a robot which does not come with tsc."""
    found = named_robot(text)
    if found is None or found.name.lower() in robots.names():
        return None
    near = nearest(found.name.lower(), robots.names()) or ""
    values = {"found": found.name, "near": near, "known": ", ".join(robots.names())}
    repair = Repair((Edit(found.span, near),) if near else (), False)
    return Diagnostic(NO_SUCH_ROBOT, found.span, values, repair=repair)
