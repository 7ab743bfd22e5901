"""Asks a computer what it has, in the way of its system: `linux`, `macos` or `windows`."""

from __future__ import annotations

from tiniscript.doctor import linux, macos, windows
from tiniscript.doctor.computer import FREE, Access, Computer
from tiniscript.doctor.system import System


def looked(system: System) -> Computer:
    """Look at a computer. Opens no port."""
    if system.platform == "win32":
        return windows.looked(system)
    look = macos.looked if system.platform == "darwin" else linux.looked
    return look(system)


def access(system: System, port: str) -> Access:
    """Return who may use a port and who does. Opens no port."""
    if system.platform == "win32":
        return FREE
    look = macos.access if system.platform == "darwin" else linux.access
    return look(system, port)
