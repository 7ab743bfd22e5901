"""The names of ports: which are network addresses, and which names mean the same port.

Opens nothing, and needs no pyserial.
"""

from __future__ import annotations

import os.path
import sys

_LOCAL = ("localhost", "[::1]")


def is_address(port: str) -> bool:
    """Return whether a port is reached over a network: no system lists such ports."""
    return "://" in port


def is_there(port: str) -> bool:
    """Return whether a port exists, as far as this is known without opening it."""
    if is_address(port) or sys.platform == "win32":
        return True
    return os.path.exists(port)  # noqa: PTH110 - Path raises for a name that no file can have


def same_for_all(port: str) -> str:
    """Return the canonical name of a port that has several.

    A udev link (`/dev/serial/by-id/...`) becomes its target, `/dev/cu.X` of macOS becomes
    `/dev/tty.X`, and Windows ignores case.
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
    except (OSError, ValueError):  # the name is not valid for a file
        return port
    return path.replace("/dev/cu.", "/dev/tty.", 1) if path.startswith("/dev/cu.") else path
