"""Ports: lists them, opens one, and says why one cannot be opened.

Knows pyserial, for serial ports, Bluetooth's (`/dev/rfcomm0`, `COM5`, `/dev/tty.HC-05`) and the
addresses `socket://host:port` and `rfc2217://host:port`. `bluetooth` opens `ble://name`,
`broker` opens `mqtt://host:port/class/id`, and `named_robots` finds `tcp://name`; their packages
are imported with their first use. Knows no robot and no sentences: what goes wrong has a name.
"""

from __future__ import annotations

import errno
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Thread
from typing import TYPE_CHECKING, NamedTuple

import serial
from serial.tools import list_ports

from tiniscript.link.port_names import is_address, is_at_broker, is_bluetooth, is_network_name
from tiniscript.printable import printable

if TYPE_CHECKING:
    from tiniscript.link.bluetooth import BluetoothPort
    from tiniscript.link.bluetooth_search import Seen
    from tiniscript.link.broker import BrokerPort
    from tiniscript.link.named_robots import Announced

READ_S = 0.02  # timeout of a read: on some systems nothing can interrupt it
WRITE_S = 1.0  # timeout of a write; the session sends the bytes again
OPEN_S = 20.0  # timeout of opening: a radio that is out of reach takes long

MISSING, FORBIDDEN, BUSY = "missing", "forbidden", "busy"
UNREACHABLE, NO_PORT, SLOW, BROKEN = "unreachable", "no_port", "slow", "broken"
# of `ble://` and `tcp://`: the package that is missing, Bluetooth of this computer, the network
NOT_INSTALLED = "not_installed"
RADIO_OFF, RADIO_FORBIDDEN = "radio_off", "radio_forbidden"
RADIO_SERVICE, RADIO_BROKEN = "radio_service", "radio_broken"
NO_MULTICAST, NOT_ANNOUNCED, STRANGE = "no_multicast", "not_announced", "strange"
# nobody has the name, several have it, whoever has it is no robot
NOT_FOUND, SEVERAL, NO_ROBOT = "not_found", "several", "no_robot"
# of a broker: it does not let us in, its certificate is not trusted, another client has the robot
REFUSED, UNTRUSTED, TAKEN = "refused", "untrusted", "taken"

_REASONS = {
    errno.ENOENT: MISSING,
    errno.ENODEV: MISSING,
    errno.ENXIO: MISSING,
    errno.EACCES: FORBIDDEN,
    errno.EPERM: FORBIDDEN,
    errno.EBUSY: BUSY,
    errno.EAGAIN: BUSY,  # the lock of another program
    errno.ECONNREFUSED: UNREACHABLE,
    errno.ETIMEDOUT: UNREACHABLE,
    errno.EHOSTUNREACH: UNREACHABLE,
    errno.ENETUNREACH: UNREACHABLE,
    getattr(errno, "EHOSTDOWN", -1): UNREACHABLE,
    errno.ENOTTY: NO_PORT,
    errno.EISDIR: NO_PORT,
    errno.EINVAL: NO_PORT,
}


class PortError(Exception):
    """A port that cannot be used: `reason` is a name from above, `why` the system's message."""

    def __init__(self, reason: str, why: str = "") -> None:
        super().__init__(reason)
        self.reason = reason
        self.why = why


class Found(NamedTuple):
    """A port that the system lists, and the system's description of it."""

    port: str
    description: str


def listed() -> list[Found]:
    """Return the ports that the system knows. Opens none of them, because that resets boards."""
    found = []
    for each in list_ports.comports():
        description = each.description if each.description != "n/a" else ""
        found.append(Found(each.device, printable(description)))  # a device says it
    return sorted(found)


def is_radio(port: str) -> bool:
    """Return whether a port is wireless: opening it does not reset a board."""
    name = port.lower()
    if is_address(port) or "rfcomm" in name:
        return True
    if sys.platform == "darwin":
        return "usb" not in name
    if sys.platform == "win32":
        known = {each.device.lower(): each.hwid or "" for each in list_ports.comports()}
        return "BTHENUM" in known.get(name, "")
    return False


def resolved(port: str) -> str:
    """Return the address of the robot that `ble://name` or `tcp://name` means: a port, too.

    Any other port is its own address. Raises PortError.
    """
    with _installed():
        if is_bluetooth(port):
            from tiniscript.link import bluetooth

            return bluetooth.resolved(port)
        if is_network_name(port):
            from tiniscript.link import named_robots

            return named_robots.resolved(port)
    return port


def in_reach() -> list[Seen]:
    """Search with Bluetooth LE for some seconds, and return the robots. Raises PortError."""
    with _installed():
        from tiniscript.link import bluetooth
    return bluetooth.listed()


def announced() -> list[Announced]:
    """Return the robots that announce themselves in the network. Raises PortError."""
    with _installed():
        from tiniscript.link import named_robots
    return named_robots.listed()


@contextmanager
def _installed() -> Iterator[None]:
    """Raise PortError where a package is missing."""
    try:
        yield
    except ImportError as missing:
        raise PortError(NOT_INSTALLED, missing.name or str(missing)) from None


def opened(
    port: str, baud: int, limit_s: float = OPEN_S
) -> serial.SerialBase | BluetoothPort | BrokerPort:
    """Open a port for exclusive use. Raises PortError, at the latest after `limit_s`.

    Some drivers block in `open` for ever, so a daemon thread opens the port. A connection by
    Bluetooth LE has limits of its own.
    """
    if is_bluetooth(port):
        with _installed():
            from tiniscript.link import bluetooth
        return bluetooth.opened(port, baud)
    if is_at_broker(port):
        with _installed():
            from tiniscript.link import broker
        return broker.opened(port)
    done: list[serial.SerialBase | BaseException] = []

    def work() -> None:
        try:
            done.append(_open(port, baud))
        except BaseException as failure:
            done.append(failure)

    thread = Thread(target=work, name="open", daemon=True)
    thread.start()
    thread.join(limit_s)
    if not done:
        raise PortError(SLOW)
    if isinstance(done[0], BaseException):
        raise _failure(done[0]) from None
    return done[0]


def _open(port: str, baud: int) -> serial.SerialBase:
    settings = {"timeout": READ_S, "write_timeout": WRITE_S, "exclusive": True}
    if port.startswith("rfc2217://"):
        del settings["write_timeout"]  # pyserial does not support it here
    return serial.serial_for_url(port, baudrate=baud, **settings)


def _failure(failure: BaseException) -> PortError:
    """Return the PortError for an exception of pyserial, which differs between systems."""
    why = str(failure)
    if isinstance(failure, (ValueError, NotImplementedError)):
        return PortError(NO_PORT, why)
    if not isinstance(failure, OSError):
        raise failure
    if failure.errno is not None:
        return PortError(_REASONS.get(failure.errno, BROKEN), failure.strerror or why)
    for said, reason in (
        ("FileNotFoundError", MISSING),  # Windows gives the error only in the text
        ("PermissionError", BUSY),  # and reports a port in use like this
        ("could not configure port", NO_PORT),
        ("Could not configure port", NO_PORT),
        ("expected a string in the form", NO_PORT),
        ("Connection refused", UNREACHABLE),
        ("timed out", UNREACHABLE),
        ("Could not open port", UNREACHABLE),  # of a network
        ("RFC2217", UNREACHABLE),  # another kind of server listens there
        ("timeout while waiting for option", UNREACHABLE),
        ("could not open port", UNREACHABLE),
    ):
        if said in why:
            return PortError(reason, why)
    return PortError(BROKEN, why)
