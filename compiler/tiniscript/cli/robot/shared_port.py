"""The way to a port: through the command that holds it, else by opening it.

Two commands may want the same port at once. The port's own lock decides, and for an address, which
has none, a file's; whoever loses looks for the winner for a moment before it says that the port is
busy.
"""

from __future__ import annotations

from time import monotonic, sleep
from typing import IO, TYPE_CHECKING

from tiniscript.cli.errors import Trouble
from tiniscript.cli.inputs import shown

if TYPE_CHECKING:
    from collections.abc import Callable

    from tiniscript.link.connection import Way
    from tiniscript.link.line import Line
    from tiniscript.sharing.client import Guest
    from tiniscript.sharing.server import Host

BUSY_S = 3.0  # for which a port may be busy: another command is just leaving, or will share it
STOP_BUSY_S = 10.0  # the same for a stop: one that asks a silent robot takes a while to give up
AGAIN_S = 0.05
SHARED = ("link", "live", "monitor", "start", "upload")  # verbs that stay on a port, and share it


def way_to(
    port: str, verb: str, open_line: Callable[[IO[bytes] | None], Line], baud: int | None = None
) -> Way:
    """Return the way to a port. Raises Trouble where it is busy or does not open.

    `open_line` opens the port; what it is given is closed with the line. `baud` is the speed that
    the person has asked for.
    """
    from tiniscript.sharing import registry

    end_s = monotonic() + (STOP_BUSY_S if verb == "stop" else BUSY_S)
    while True:
        guest = _joined(port, verb, baud)
        if guest is not None:
            return guest
        try:
            line = open_line(_claimed(port))
            registry.forget(port)  # the port is ours: whoever held it has crashed
            return line
        except Trouble as trouble:
            if trouble.key != "port_busy" or monotonic() > end_s:
                raise
        sleep(AGAIN_S)


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


def _joined(port: str, verb: str, baud: int | None) -> Guest | None:
    from tiniscript.sharing.client import OtherVersion, joined

    try:
        guest = joined(port, verb)
    except OtherVersion as other:
        values = {"verb": other.holder.verb, "theirs": shown(other.version)}
        raise Trouble(3, "holder_other", port=shown(port), **values) from None
    if guest is not None and baud not in (None, guest.baud) and verb != "stop":
        guest.close()
        values = {"verb": guest.held_by, "baud": str(guest.baud)}
        raise Trouble(3, "holder_baud", port=shown(port), **values)
    return guest


def _claimed(port: str) -> IO[bytes] | None:
    """Return the lock of an address; for other ports, and where there are no locks, nothing."""
    from tiniscript.link.port_names import is_address

    if not is_address(port):
        return None
    from tiniscript.sharing import registry

    try:
        lock = registry.claimed(port)
    except OSError:
        return None
    if lock is None:
        raise Trouble(3, "port_busy", port=shown(port), why="")
    return lock
