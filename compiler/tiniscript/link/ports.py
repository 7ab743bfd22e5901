"""Serial ports: which there are, how one is opened, and why one cannot be.

Knows pyserial, for serial ports, Bluetooth's (`/dev/rfcomm0`, `COM5`, `/dev/tty.HC-05`) and the
addresses `socket://host:port` and `rfc2217://host:port`. Knows no robot and no sentences: what
goes wrong has a name.
"""

from __future__ import annotations

import errno
import sys
from threading import Thread
from typing import NamedTuple

import serial
from serial.tools import list_ports

from tiniscript.link.port_names import is_address

READ_S = 0.02  # for which a read waits: on some systems nothing can wake it earlier
WRITE_S = 1.0  # for which a port may refuse to take bytes; the session sends them again
OPEN_S = 20.0  # for which a port may open: a radio that is out of reach takes its time

MISSING, FORBIDDEN, BUSY = "missing", "forbidden", "busy"
UNREACHABLE, NO_PORT, SLOW, BROKEN = "unreachable", "no_port", "slow", "broken"

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


class PortTrouble(Exception):
    """A port that cannot be used: `reason` is one of the names above, `why` what was said of it."""

    def __init__(self, reason: str, why: str = "") -> None:
        super().__init__(reason)
        self.reason = reason
        self.why = why


class Found(NamedTuple):
    """A port that the system lists, and what it says of it."""

    port: str
    description: str


def listed() -> list[Found]:
    """Return the ports that the system knows. None of them is opened: that resets boards."""
    found = []
    for each in list_ports.comports():
        description = each.description if each.description != "n/a" else ""
        found.append(Found(each.device, description))
    return sorted(found)


def is_radio(port: str) -> bool:
    """Whether a port leads to a robot through the air: opening it does not reset a board."""
    name = port.lower()
    if is_address(port) or "rfcomm" in name:
        return True
    if sys.platform == "darwin":
        return "usb" not in name
    if sys.platform == "win32":
        known = {each.device.lower(): each.hwid or "" for each in list_ports.comports()}
        return "BTHENUM" in known.get(name, "")
    return False


def opened(port: str, baud: int, limit_s: float = OPEN_S) -> serial.SerialBase:
    """Open a port for this program alone. Raises PortTrouble, at the latest after `limit_s`.

    Some drivers wait in `open` for ever: so a thread does it, which nobody waits for at the end.
    """
    done: list[serial.SerialBase | BaseException] = []

    def work() -> None:
        try:
            done.append(_open(port, baud))
        except BaseException as trouble:
            done.append(trouble)

    thread = Thread(target=work, name="open", daemon=True)
    thread.start()
    thread.join(limit_s)
    if not done:
        raise PortTrouble(SLOW)
    if isinstance(done[0], BaseException):
        raise _trouble(done[0]) from None
    return done[0]


def _open(port: str, baud: int) -> serial.SerialBase:
    settings = {"timeout": READ_S, "write_timeout": WRITE_S, "exclusive": True}
    if port.startswith("rfc2217://"):
        del settings["write_timeout"]  # pyserial has none for it
    return serial.serial_for_url(port, baudrate=baud, **settings)


def _trouble(trouble: BaseException) -> PortTrouble:
    """Return what is wrong, from what pyserial says on this system."""
    why = str(trouble)
    if isinstance(trouble, (ValueError, NotImplementedError)):
        return PortTrouble(NO_PORT, why)
    if not isinstance(trouble, OSError):
        raise trouble
    if trouble.errno is not None:
        return PortTrouble(_REASONS.get(trouble.errno, BROKEN), trouble.strerror or why)
    for said, reason in (
        ("FileNotFoundError", MISSING),  # Windows has its errors in the text
        ("PermissionError", BUSY),  # and calls that what is in use
        ("could not configure port", NO_PORT),
        ("Could not configure port", NO_PORT),
        ("expected a string in the form", NO_PORT),
        ("Connection refused", UNREACHABLE),
        ("timed out", UNREACHABLE),
        ("Could not open port", UNREACHABLE),  # of a network
        ("RFC2217", UNREACHABLE),  # something else listens there
        ("timeout while waiting for option", UNREACHABLE),
        ("could not open port", UNREACHABLE),
    ):
        if said in why:
            return PortTrouble(reason, why)
    return PortTrouble(BROKEN, why)
