"""Serial ports, those of Bluetooth among them: `/dev/rfcomm0`, `COM5`, `/dev/tty.HC-05`.

Also the addresses `socket://host:port` and `rfc2217://host:port`.

It knows pyserial and the meanings of its exceptions. Knows no robot and no sentences.
"""

from __future__ import annotations

import errno
import select
import sys
from threading import Thread
from typing import Any, Protocol

import serial
from serial.tools import list_ports

from tiniscript.link.errors import (
    BROKEN,
    BUSY,
    FORBIDDEN,
    MISSING,
    NO_PORT,
    SLOW,
    UNREACHABLE,
    PortError,
)
from tiniscript.link.transports import READ_S, WRITE_S

_REASONS = {
    getattr(errno, name, None): reason
    for reason, names in (
        (MISSING, "ENOENT ENODEV ENXIO"),
        (FORBIDDEN, "EACCES EPERM"),
        (BUSY, "EBUSY EAGAIN"),  # EAGAIN: the lock of another program
        (UNREACHABLE, "ECONNREFUSED ETIMEDOUT EHOSTUNREACH ENETUNREACH EHOSTDOWN"),
        (NO_PORT, "ENOTTY EISDIR EINVAL"),
    )
    for name in names.split()
}


class _Device(serial.Serial):  # type: ignore[misc] # pyserial has no types
    """A port of this computer. Bytes read earlier by another program do not end it: a stop that
    passes the lock of a suspended command reads bytes announced to that command.
    """

    def read(self, size: int = 1) -> bytes:
        try:
            return bytes(super().read(size))
        except serial.SerialException:
            if not self._is_there():
                raise
            return b""

    def _is_there(self) -> bool:
        """Return whether the system still has the port; False if unknown."""
        if sys.platform == "win32" or self.fd is None:
            return False
        poll = select.poll()
        poll.register(self.fd, 0)
        return not poll.poll(0)  # otherwise the line has hung up


class ListedDevice(Protocol):
    """A port that the system knows: its name, its description, and its hardware."""

    device: str
    description: str  # "n/a" if unknown
    hwid: str | None


def list_serial_ports() -> list[ListedDevice]:
    ports: list[ListedDevice] = list_ports.comports()
    return ports


def resolve(port: str) -> str:
    return port


def open_port(
    port: str, baud: int, timeout_s: float, is_exclusive: bool = True
) -> serial.SerialBase:
    """Open a port, at the latest after `timeout_s`. Raises PortError.

    Some drivers block in `open` forever, so a daemon thread opens the port.
    """
    outcomes: list[serial.SerialBase | BaseException] = []

    def open_in_thread() -> None:
        try:
            outcomes.append(_open(port, baud) if is_exclusive else _open_shared(port, baud))
        except BaseException as failure:
            outcomes.append(failure)

    thread = Thread(target=open_in_thread, name="open", daemon=True)
    thread.start()
    thread.join(timeout_s)
    if not outcomes:
        raise PortError(SLOW)
    if isinstance(outcomes[0], BaseException):
        raise _port_error(outcomes[0]) from None
    return outcomes[0]


def _open(port: str, baud: int) -> serial.SerialBase:
    settings = {"timeout": READ_S, "write_timeout": WRITE_S, "exclusive": True}
    if port.startswith("rfc2217://"):
        del settings["write_timeout"]  # pyserial does not support it here
    return _make_serial(port, baud, settings)


def _open_shared(port: str, baud: int) -> serial.SerialBase:
    return _make_serial(port, baud, {"timeout": READ_S, "write_timeout": WRITE_S})


def _make_serial(port: str, baud: int, settings: dict[str, Any]) -> serial.SerialBase:
    if "://" in port:
        return serial.serial_for_url(port, baudrate=baud, **settings)
    return _Device(port, baudrate=baud, **settings)


def _port_error(error: BaseException) -> PortError:
    """Return the PortError for an exception of pyserial, which differs between systems."""
    message = str(error)
    if isinstance(error, (ValueError, NotImplementedError)):
        return PortError(NO_PORT, message)
    if not isinstance(error, OSError):
        raise error
    if error.errno is not None:
        return PortError(_REASONS.get(error.errno, BROKEN), error.strerror or message)
    for part, reason in (
        ("FileNotFoundError", MISSING),  # Windows has the error only in the text
        ("PermissionError", BUSY),  # the message for a port in use
        ("could not configure port", NO_PORT),
        ("Could not configure port", NO_PORT),
        ("expected a string in the form", NO_PORT),
        ("Connection refused", UNREACHABLE),
        ("timed out", UNREACHABLE),
        ("Could not open port", UNREACHABLE),  # the message of a network port
        ("RFC2217", UNREACHABLE),  # another kind of server is listening there
        ("timeout while waiting for option", UNREACHABLE),
        ("could not open port", UNREACHABLE),
    ):
        if part in message:
            return PortError(reason, message)
    return PortError(BROKEN, message)
