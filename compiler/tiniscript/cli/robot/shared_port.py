"""Which verbs share the port that they hold, and how."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tiniscript.link.connection import LinkConnection
    from tiniscript.sharing.server import Server

SHARED = (
    "doctor",
    "link",
    "live",
    "monitor",
    "start",
    "upload",
)  # verbs that stay on a port, and share it


def shared(connection: LinkConnection, port: str, baud: int, verb: str) -> Server | None:
    """Share a connection with other commands, if this verb does so and it is possible."""
    if verb not in SHARED or connection.held_by:
        return None
    from tiniscript.link.line import Line
    from tiniscript.sharing.server import Server

    assert isinstance(connection, Line)
    try:
        return Server(connection, port, baud, verb)
    except OSError:
        return None
