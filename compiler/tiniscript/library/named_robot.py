"""The robot of a program: the chosen one, or else the one it names.

It names one in a comment before its first instruction: `// robot: liner`.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from tiniscript import robots
from tiniscript.base.source import SPACES, Edit, Span, Unreadable, apply_edits, decode
from tiniscript.diagnostics.codes import NO_SUCH_ROBOT, Diagnostic, Repair
from tiniscript.robots.profile import Robot

# A line of comment, or an empty one. In Portuguese it is a robô; a comment with more words than a
# name tells people something.
_ROBOT_LINE = re.compile(
    rf"[{SPACES}]*(?://+[{SPACES}]*rob(?:ot|o\u0302?|\u00f4)[{SPACES}]*:"
    rf"[{SPACES}]*(?P<name>[^{SPACES}\r\n]+)[{SPACES}]*|//[^\r\n]*)?(?:\r\n|\n|\r|\Z)",
    re.IGNORECASE,
)


class NamedRobot(NamedTuple):
    """The name as written, and its place."""

    name: str
    span: Span


def named_robot(text: str) -> NamedRobot | None:
    """Return the first robot that a program names, or None."""
    offset = 0
    while offset < len(text) and (match := _ROBOT_LINE.match(text, offset)):
        if match["name"]:
            return NamedRobot(match["name"], Span(*match.span("name")))
        offset = match.end()
    return None


def rename_robot(text: str, name: str) -> str:
    """Return a program that names a robot with another name; any other stays as it is."""
    robot_in_text = named_robot(text)
    return text if robot_in_text is None else apply_edits(text, [Edit(robot_in_text.span, name)])


def robot_of(data: bytes, default: Robot) -> Robot:
    """Return the shipped robot that a program's text names, else `default`."""
    name = shipped_name_in(data)
    return default if name in (None, default.name) else robots.load(str(name))


def shipped_name_in(data: bytes) -> str | None:
    """Return the name of the shipped robot that a program's text names, or None."""
    name = (robot_name(data) or "").lower()
    return name if name in robots.names() else None


def robot_name(data: bytes) -> str | None:
    """Return the robot named in a program's text, or None; an image names none."""
    try:
        robot_in_text = named_robot(decode(data))
    except Unreadable:
        return None
    return robot_in_text.name if robot_in_text else None


def unknown_robot(text: str) -> Diagnostic | None:
    """Return the mistake of a program that names a robot which does not come with tsc."""
    robot_in_text = named_robot(text)
    if robot_in_text is None or robot_in_text.name.lower() in robots.names():
        return None
    from tiniscript.base.spelling import nearest

    suggestion = nearest(robot_in_text.name.lower(), robots.names()) or ""
    values = {"found": robot_in_text.name, "near": suggestion, "known": ", ".join(robots.names())}
    repair = Repair((Edit(robot_in_text.span, suggestion),) if suggestion else (), False)
    return Diagnostic(NO_SUCH_ROBOT, robot_in_text.span, values, repair=repair)
