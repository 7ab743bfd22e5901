"""The ports on which robots have answered, the robots' names, and the port used last.

They are in the user's cache: losing it loses only this list. Opens no port.
"""

from __future__ import annotations

import json
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from tiniscript.base import files
from tiniscript.base.files import read_limited
from tiniscript.base.source import printable
from tiniscript.link.port_names import canonical_port, is_address

FILE_BYTES = 1_000_000
MAX_PORTS = 2000  # ports; the oldest go first


class KnownPorts(NamedTuple):
    """`name_by_port` maps ports to robots' names, the newest first; a name may be empty."""

    last_port: str | None
    name_by_port: dict[str, str]


def remembered_ports() -> KnownPorts:
    """Return the remembered ports."""
    try:
        fields = json.loads(read_limited(_path(), FILE_BYTES))
        last_port = fields["last"]
        name_by_port = {str(port): printable(str(name)) for port, name in fields["ports"]}
    except (OSError, ValueError, TypeError, KeyError, RecursionError):
        return KnownPorts(None, {})
    return KnownPorts(last_port if isinstance(last_port, str) else None, name_by_port)


def remember(port: str, name: str, is_used: bool = True) -> None:
    """Keep the name of the robot on a port. If the cache cannot be written, it is not kept."""
    path = _path()
    with suppress(OSError, ValueError):
        path.parent.mkdir(parents=True, exist_ok=True)
        with files.lock_file(path):  # other commands do the same
            known_ports = remembered_ports()
            newest_port = next(iter(known_ports.name_by_port.items()), None)
            if newest_port == (port, name) and (known_ports.last_port == port or not is_used):
                return
            other_names = {
                value: name
                for value, name in known_ports.name_by_port.items()
                if not _is_same(value, port)
            }
            name_by_port = {port: name, **other_names}
            last_port = port if is_used else known_ports.last_port
            fields = {"last": last_port, "ports": list(name_by_port.items())[:MAX_PORTS]}
            files.replace(path, json.dumps(fields).encode())


def _is_same(port: str, other_port: str) -> bool:
    """Return whether two names always mean the same port; a link in /dev may change."""
    if is_address(port) and is_address(other_port):
        return canonical_port(port) == canonical_port(other_port)
    return port == other_port


def _path() -> Path:
    return files.cache_folder() / "ports.json"
