"""The names of ports: which are addresses, and which of them mean the same port.

Opens nothing, and needs no pyserial.
"""

from __future__ import annotations

import os.path
import sys

_LOCAL = ("localhost", "[::1]")


def is_address(port: str) -> bool:
    """Whether a port is reached over a network: no system lists it."""
    return "://" in port


def is_there(port: str) -> bool:
    """Whether it makes sense to open a port."""
    if is_address(port) or sys.platform == "win32":
        return True
    return os.path.exists(port)  # noqa: PTH110 - Path raises for a name that no file can have


def same_for_all(port: str) -> str:
    """Return the one name of a port that has several.

    A link of udev (`/dev/serial/by-id/...`) is what it leads to, `/dev/cu.X` of macOS is
    `/dev/tty.X`, and Windows does not look at capitals.
    """
    if is_address(port):
        kind, _, rest = port.partition("://")
        host, colon, number = rest.rpartition(":")
        host = host.lower()
        return f"{kind.lower()}://{'127.0.0.1' if host in _LOCAL else host}{colon}{number}"
    if sys.platform == "win32":
        return port.upper().removeprefix("\\\\.\\")
    try:
        path = os.path.realpath(port)
    except (OSError, ValueError):  # a name that no file can have
        return port
    return path.replace("/dev/cu.", "/dev/tty.", 1) if path.startswith("/dev/cu.") else path
