"""The robot that a program names: `// robot: liner` among the comments before its first instruction.

Knows how that comment is written, and where. Does not know which robots there are.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from tiniscript.base.source import SPACES, Edit, Span, applied

# A line of comment, or an empty one. In Portuguese it is a robô; a comment with more words than a
# name tells people something.
_LINE = re.compile(
    rf"[{SPACES}]*(?://+[{SPACES}]*rob(?:ot|o\u0302?|\u00f4)[{SPACES}]*:"
    rf"[{SPACES}]*(?P<name>[^{SPACES}\r\n]+)[{SPACES}]*|//[^\r\n]*)?(?:\r\n|\n|\r|\Z)",
    re.IGNORECASE,
)


class Named(NamedTuple):
    """The name as it is written, and its place."""

    name: str
    span: Span


def named_robot(text: str) -> Named | None:
    """Return the robot that a program names first, or None."""
    at = 0
    while at < len(text) and (line := _LINE.match(text, at)):
        if line["name"]:
            return Named(line["name"], Span(*line.span("name")))
        at = line.end()
    return None


def renamed(text: str, name: str) -> str:
    """Return a program that names a robot with the name of another one; any other stays as it is."""
    found = named_robot(text)
    return text if found is None else applied(text, [Edit(found.span, name)])
