"""Which verbs share the port that they hold, and how."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tiniscript.link.connection import Way
    from tiniscript.sharing.server import Host

SHARED = ("link", "live", "monitor", "start", "upload")  # verbs that stay on a port, and share it


def shared(way: Way, port: str, baud: int, verb: str) -> Host | None:
    """Let others use a way, if this verb does so and they can be told."""
    if verb not in SHARED or way.held_by:
        return None
    from tiniscript.link.line import Line
    from tiniscript.sharing.server import Host

    assert isinstance(way, Line)
    try:
        return Host(way, port, baud, verb)
    except OSError:
        return None
