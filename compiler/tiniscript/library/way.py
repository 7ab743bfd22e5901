"""The way to a robot: through whoever holds its port, else by opening it; and who answers there.

Two programs may want the same port at once. The port's own lock decides, and for an address, which
has none, a file's; whoever loses looks for the winner for a moment before the port is called busy.
What goes wrong is a `RobotError`, whose reason and values the command puts into its own sentence.
"""

from __future__ import annotations

import os
import sys
from time import monotonic, sleep
from typing import IO, TYPE_CHECKING

from tiniscript.library.errors import RobotError
from tiniscript.printable import printable

if TYPE_CHECKING:
    from collections.abc import Callable

    from tiniscript.link.connection import Asked, Asks, Way
    from tiniscript.link.line import Line
    from tiniscript.link.outcomes import Gone
    from tiniscript.link.ports import PortTrouble
    from tiniscript.link.requests import Reply
    from tiniscript.sharing.client import Guest

BUSY_S = 3.0  # for which a port may be busy: another command is just leaving, or will share it
STOP_BUSY_S = 10.0  # the same for a stop: one that asks a silent robot takes a while to give up
AGAIN_S = 0.05
OPEN_S = 20.0  # for which a port may open
SHOWN = 200  # characters of a name in a sentence

ANSWER_MS = 6000  # for which a robot is asked through the air who it is
# At a cable it is asked for less, and twice: an Uno that was reset takes 1.4 s.
CABLE_ANSWER_MS = 2000
# A Mega that was reset begins after 0.9 s. What it hears before that keeps it in its bootloader
# until it has heard nothing for 4.2 s.
QUIET_S = {"mega": 1.2}  # by board
LONG_QUIET_S = 4.5
CONFIRM_S = 7.0  # for which a stop is waited for, a little longer than it is sent
PSEUDO = ("/dev/pts/", "/dev/ttys")  # pseudo-terminals


def way_to(
    port: str, verb: str, open_line: Callable[[IO[bytes] | None], Line], baud: int | None = None,
    language: str = "en",
) -> Way:  # fmt: skip
    """Return the way to a port. Raises RobotError where it is busy or does not open.

    `open_line` opens the port; what it is given is closed with the line. `verb` is what others
    are told of who holds the port. `baud` is the speed that the person has asked for.
    """
    from tiniscript.sharing import registry

    end_s = monotonic() + (STOP_BUSY_S if verb == "stop" else BUSY_S)
    while True:
        guest = _joined(port, verb, baud, language)
        if guest is not None:
            return guest
        try:
            line = open_line(_claimed(port, language))
            registry.forget(port)  # the port is ours: whoever held it has crashed
            return line
        except RobotError as trouble:
            if trouble.reason != "port_busy" or monotonic() > end_s:
                raise
        sleep(AGAIN_S)


def opened_line(
    port: str, baud: int, kit: int, limit_s: float = OPEN_S, lock: IO[bytes] | None = None,
    language: str = "en",
) -> Line:  # fmt: skip
    """Open a port, with a session for this kit on it. Raises RobotError."""
    from tiniscript.link.line import Line
    from tiniscript.link.ports import PortTrouble, opened
    from tiniscript.link.session import Session

    try:
        device = opened(port, baud, limit_s)
    except PortTrouble as trouble:
        if lock is not None:
            lock.close()
        raise port_error(port, trouble, language) from None
    session = Session(int.from_bytes(os.urandom(4), "little"), baud, kit)
    return Line(device, session, lock)


def port_error(port: str, trouble: PortTrouble, language: str = "en") -> RobotError:
    """Return the error for a port that does not open."""
    from tiniscript.link import ports

    reason = f"port_{trouble.reason}"
    values = {"port": shown(port), "why": shown(trouble.why)}
    if trouble.reason == ports.FORBIDDEN and sys.platform.startswith("linux"):
        reason = "port_forbidden_linux"
    if trouble.reason == ports.MISSING:
        known = ", ".join(each.port for each in ports.listed())
        if known:
            reason, values["known"] = "port_missing_but", shown(known)
    return RobotError(reason, language, values)


def met(line: Way, port: str, board: str, wait: Callable[[Asked], Reply]) -> Reply:
    """Ask who is there, but not so early that a board stays in its bootloader."""
    if not line.held_by:  # else the port is open already
        from tiniscript.link import ports

        if not ports.is_radio(port):
            sleep(QUIET_S.get(board, 0.0))
            reply = wait(hello(line, CABLE_ANSWER_MS))
            if line.heard:
                return reply
            sleep(LONG_QUIET_S)
            return wait(hello(line, CABLE_ANSWER_MS))
    return wait(hello(line, ANSWER_MS))


def hello(line: Way, limit_ms: int) -> Asked:
    """Begin a session. It is asked again until the robot answers: a reset takes it a while."""
    return line.do(limited(lambda session: session.hello(), limit_ms))


def limited(make: Callable[[Asks], Asked], limit_ms: int) -> Callable[[Asks], Asked]:
    """Return what asks for the same, and gives up after a time."""

    def asked(session: Asks) -> Asked:
        task = make(session)
        task.limit_ms = limit_ms
        return task

    return asked


def reason_of(line: Way, reply: Reply) -> str:
    """Return why a reply is not OK; `status`: the robot has said why."""
    from tiniscript.link.outcomes import CANCELLED, LOST

    if reply.status == CANCELLED:
        return "stopped_elsewhere"
    if reply.status != LOST:
        return "status"
    if line.robot is not None:
        return "link_lost"
    if line.is_echoed:
        return "link_echo"
    return "link_other" if line.heard else "link_silent"


def reason_of_end(line: Way, gone: Gone) -> str:
    """Return why a way has ended."""
    if gone.is_holder:
        return "holder_ended"
    if line.heard and line.robot is None:  # said so, and hung up
        return "port_busy"
    return "port_gone"


def confirmed(line: Way, limit_s: float | None = None) -> bool:
    """Stop the robot; return whether it has confirmed. A second Ctrl-C ends the waiting.

    `limit_s` is CONFIRM_S where nothing is said. What was told before is about something else.
    """
    from tiniscript.link.outcomes import Gone

    began_s = monotonic()
    end_s = began_s + (CONFIRM_S if limit_s is None else limit_s)
    line.stop()
    try:
        while monotonic() < end_s:
            found = line.event()
            if found is None or found[0] < int(began_s * 1000):
                continue
            if found[1].name in ("STOPPED", "LOST"):
                return found[1].name == "STOPPED"
    except (Gone, KeyboardInterrupt):
        pass
    return False


def remember(port: str, name: str, is_used: bool = True) -> None:
    """Keep a port and what the robot on it is called. A virtual robot has no next time."""
    from tiniscript.link import known_ports
    from tiniscript.link.port_names import is_address

    if is_address(port) or port.startswith(PSEUDO):
        from tiniscript.virtual import directory

        if directory.is_virtual(port):
            return
    known_ports.remember(port, name, is_used)


def shown(name: str) -> str:
    """Return a name as a sentence can have it."""
    return printable(name, SHOWN)


def _joined(port: str, verb: str, baud: int | None, language: str) -> Guest | None:
    from tiniscript.sharing.client import OtherVersion, joined

    try:
        guest = joined(port, verb)
    except OtherVersion as other:
        values = {"verb": other.holder.verb, "theirs": shown(other.version), "port": shown(port)}
        raise RobotError("holder_other", language, values) from None
    if guest is not None and baud not in (None, guest.baud) and verb != "stop":
        guest.close()
        values = {"verb": guest.held_by, "baud": str(guest.baud), "port": shown(port)}
        raise RobotError("holder_baud", language, values)
    return guest


def _claimed(port: str, language: str) -> IO[bytes] | None:
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
        raise RobotError("port_busy", language, {"port": shown(port), "why": ""})
    return lock
