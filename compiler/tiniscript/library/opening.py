"""Opens a connection to a robot: through the command that holds its port, else on the port itself.

If two programs open the same port at once, the lock of the serial port decides; an address has no
lock, so a locked file decides. The second program then looks for the server of the first one for
some seconds before it reports a busy port. A stop does not wait for a suspended holder: it bypasses
the lock of a serial port, or wakes the holder. Failures are `RobotError`s: the command puts their
reason and values into sentences of its own.
"""

from __future__ import annotations

import os
import sys
from contextlib import ExitStack, suppress
from time import monotonic, sleep
from typing import IO, TYPE_CHECKING

from tiniscript.base.source import printable
from tiniscript.library.errors import RobotError
from tiniscript.link import errors, holders, known_ports, port_names
from tiniscript.link.connection import LinkConnection
from tiniscript.link.errors import PortError
from tiniscript.link.port_names import PSEUDO_TERMINALS, is_address, is_at_broker, is_name
from tiniscript.link.sharing import registry
from tiniscript.link.sharing.shared_connection import OtherVersion, SharedConnection, join
from tiniscript.virtual import directory

if TYPE_CHECKING:
    from tiniscript.link.port_connection import PortConnection

BUSY_TIMEOUT_S = 3.0  # timeout for a busy port: its owner may be leaving, or be about to share it
STOP_BUSY_TIMEOUT_S = 10.0  # the same for a stop: a silent robot's owner gives up slowly
RETRY_INTERVAL_S = 0.05
SLOWEST_BAUD, FASTEST_BAUD = 300, 2_000_000
OPEN_TIMEOUT_S = 20.0  # timeout for opening a port
MAX_NAME_CHARACTERS = 200  # characters of a name in a sentence

ANSWER_TIMEOUT_MS = 6000  # timeout for HELLO by radio
# A cable has a shorter timeout, and HELLO gets two tries: an Uno needs 1.4 s after a reset.
CABLE_ANSWER_TIMEOUT_MS = 2000
# A Mega begins 0.9 s after a reset. Bytes that arrive earlier keep it in its bootloader until the
# line has been silent for 4.2 s.
QUIET_S_BY_BOARD = {"mega": 1.2}  # keyed by the board's name
LONG_QUIET_S = 4.5
CONFIRM_TIMEOUT_S = 7.0  # timeout for the answer to a stop, a little longer than stops are sent


def connection_to(
    port: str, verb: str, baud: int, kit: int, timeout_s: float = OPEN_TIMEOUT_S,
    asked_baud: int | None = None, language: str = "en",
) -> LinkConnection:  # fmt: skip
    """Return the connection to a port. Raises RobotError if the port is busy or does not open.

    `verb` is the name that other commands show for this one. `asked_baud` is the speed that the
    user has asked for. A robot's name becomes its address, which may be in use under another name.
    """
    address = port
    is_stop = verb == "stop"
    begun_s = monotonic()
    while True:
        is_holder_suspended = is_stop and _is_suspended(address)
        shared_connection = (
            None if is_holder_suspended else _join_shared(address, verb, asked_baud, language)
        )
        if shared_connection is not None:
            return shared_connection
        if is_name(address):
            address = _resolve_address(port, language)
            begun_s = monotonic()
            continue
        try:
            lock = _claim(address, language)
            port_connection = _open_connection(
                address, baud, kit, timeout_s, lock, language, port, verb
            )
            for name in {port, address}:
                registry.forget(name)  # the port is ours: its former owner has crashed
            return port_connection
        except RobotError as error:
            waited_s = monotonic() - begun_s
            if error.reason != "port_busy" or (waited_s > BUSY_TIMEOUT_S and not is_stop):
                raise
        if is_stop:
            connection = _connect_past_holder(
                address, baud, kit, timeout_s, language, port, waited_s
            )
            if connection is not None:
                return connection
        sleep(RETRY_INTERVAL_S)


def _is_suspended(address: str) -> bool:
    """Return whether the command that shares a port is suspended and does not answer."""
    registration = registry.find_registration(address)
    return registration is not None and holders.is_suspended(registration.pid)


def _connect_past_holder(
    address: str, baud: int, kit: int, timeout_s: float, language: str, port: str, waited_s: float
) -> PortConnection | None:
    """Return a connection past the suspended holder of a busy port; None while a normal connection
    is possible.

    A holder that cannot be passed is woken. One that continues may be writing firmware: it is left
    alone. Raises RobotError in the end.
    """
    registration = registry.find_registration(address)
    path = str(registry.lock_path(address)) if is_address(address) else address
    holder = holders.find_holder(path, None if registration is None else registration.pid)
    if holder is not None and holder.is_suspended:
        if sys.platform == "linux" and not is_address(address):
            speed = baud if registration is None else registration.baud
            with suppress(RobotError):
                return _open_connection(
                    address, speed, kit, timeout_s, None, language, port, "stop", True
                )
        holder.wake()
    if waited_s <= STOP_BUSY_TIMEOUT_S:
        return None
    if holder is None:
        raise RobotError("stop_held_unknown", language, {"port": printable_name(port)})
    values = {"port": printable_name(port), "holder": holder.name, "pid": str(holder.pid)}
    raise RobotError("stop_held", language, values)


def _open_connection(
    address: str, baud: int, kit: int, timeout_s: float, lock: IO[bytes] | None, language: str,
    port: str, verb: str = "", opens_past_lock: bool = False,
) -> PortConnection:  # fmt: skip
    """Open a port and begin a session for this kit. Raises RobotError.

    `port` is the port's name in sentences. The line closes the lock. `opens_past_lock`: a serial
    port that another program has locked.
    """
    from tiniscript.link.keys import KeyFile
    from tiniscript.link.port_connection import PortConnection
    from tiniscript.link.ports import open_past_lock, open_port
    from tiniscript.link.session import Session

    with ExitStack() as cleanup:
        if lock is not None:
            cleanup.callback(lock.close)
        open_function = open_past_lock if opens_past_lock else open_port
        try:
            opened_port = open_function(address, baud, timeout_s)
        except PortError as error:
            raise port_error(port, error, language) from None
        cleanup.callback(opened_port.close)
        if directory.belongs_to_another(
            address
        ):  # the confirmation by the other end, before anything is sent
            raise RobotError("port_of_another", language, {"port": printable_name(port)})
        # Keys are stored before a claim, because several robots may share one cable.
        keys = KeyFile(serves_virtual_robots=is_virtual(address), accepts_all=verb == "set owner")
        canonical_port = port_names.canonical_port(
            port
        )  # an address may be another robot's tomorrow
        nonce = int.from_bytes(os.urandom(4), "little")
        session = Session(nonce, baud, kit, keys=keys, place=canonical_port)
        connection = PortConnection(opened_port, session, lock, address)
        cleanup.pop_all()
        return connection


def port_error(port: str, error: PortError, language: str = "en") -> RobotError:
    """Return the error for a port that does not open."""
    reason = f"port_{error.reason}"
    values = {"port": printable_name(port), "why": printable_name(error.detail)}
    if error.reason == errors.NOT_INSTALLED:
        from tiniscript.library import install_advice

        extra = install_advice.BROKER if is_at_broker(port) else install_advice.RADIO
        values["how"] = install_advice.command(extra)
    if error.reason == errors.UNREACHABLE and is_at_broker(port):
        reason = "broker_unreachable"
    if error.reason == errors.NOT_FOUND and error.detail:
        reason = "port_not_found_but"
    if error.reason == errors.FORBIDDEN and sys.platform.startswith("linux"):
        reason = "port_forbidden_linux"
    if error.reason == errors.MISSING:
        from tiniscript.link import ports

        ports_text = ", ".join(port_info.port for port_info in ports.list_ports())
        if ports_text:
            reason, values["known"] = "port_missing_but", printable_name(ports_text)
    return RobotError(reason, language, values)


def remember(port: str, name: str, is_used: bool = True) -> None:
    """Remember a port and the name of its robot; not for a virtual robot, whose port is new each
    time."""
    if not is_at_broker(port) and not is_virtual(port):
        known_ports.remember(port, name, is_used)


def usable_last_port() -> str | None:
    """Return the last used port, unless it is known that it is not there."""
    last_port = known_ports.remembered_ports().last_port
    is_there = (
        last_port is not None and port_names.exists(last_port) and not directory.is_gone(last_port)
    )
    return last_port if is_there else None


def is_virtual(port: str) -> bool:
    if not is_address(port) and not port.startswith(PSEUDO_TERMINALS):
        return False
    return directory.is_virtual(port)


def printable_name(name: str) -> str:
    """Return a name in a form for sentences: printable, at most MAX_NAME_CHARACTERS characters."""
    return printable(name, MAX_NAME_CHARACTERS)


def _join_shared(port: str, verb: str, baud: int | None, language: str) -> SharedConnection | None:
    try:
        shared_connection = join(port, verb)
    except OtherVersion as error:
        values = {
            "verb": error.registration.verb,
            "theirs": printable_name(error.version),
            "port": printable_name(port),
        }
        raise RobotError("holder_other", language, values) from None
    if (
        shared_connection is not None
        and baud not in (None, shared_connection.baud)
        and verb != "stop"
    ):
        shared_connection.close()
        values = {
            "verb": shared_connection.holder_verb,
            "baud": str(shared_connection.baud),
            "port": printable_name(port),
        }
        raise RobotError("holder_baud", language, values)
    return shared_connection


def _resolve_address(port: str, language: str) -> str:
    """Return the address of a robot that is named. Raises RobotError."""
    from tiniscript.link import ports

    try:
        return ports.resolve(port)
    except errors.PortError as error:
        raise port_error(port, error, language) from None


def _claim(port: str, language: str) -> IO[bytes] | None:
    """Return the lock of an address, or None for other ports and if no file can be locked."""
    if not is_address(port):
        return None
    try:
        lock = registry.lock_port(port)
    except OSError:
        return None
    if lock is None:
        raise RobotError("port_busy", language, {"port": printable_name(port), "why": ""})
    return lock
