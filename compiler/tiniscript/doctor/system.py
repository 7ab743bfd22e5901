"""The door to this computer: files, folders, links, programs and ports, read and never written.

The rest of the doctor sees the computer only through it, so that a test can substitute another one.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

from tiniscript.base.files import read_limited
from tiniscript.link import ports
from tiniscript.link.ports import ListedPort

MAX_FILE_BYTES = 65_536
OUTPUT_TIMEOUT_S = 8.0  # timeout of a program


class Owner(NamedTuple):
    """The group of a file, and whether this user may read and write it."""

    group: int
    may_use: bool


class System:
    """The computer that this runs on, seen from the folder `root`.

    Values that cannot be read are None or empty.
    """

    def __init__(self, root: Path = Path("/")) -> None:
        self.platform = sys.platform
        self.root = root

    def _path(self, path: str) -> Path:
        return self.root / path.lstrip("/")

    def ports(self) -> list[ListedPort]:
        return ports.list_ports()

    def names(self, folder: str) -> list[str]:
        try:
            return sorted(os.listdir(self._path(folder)))  # noqa: PTH208 - a folder may vanish
        except OSError:
            return []

    def text(self, path: str) -> str | None:
        try:
            return read_limited(self._path(path), MAX_FILE_BYTES).decode("utf-8", "replace").strip()
        except (OSError, ValueError):
            return None

    def target(self, link_path: str) -> str | None:
        try:
            return os.readlink(self._path(link_path))  # noqa: PTH115 - what it says, not a path
        except (OSError, ValueError):
            return None

    def owner(self, path: str) -> Owner | None:
        try:
            stat_result = self._path(path).stat()
        except (OSError, ValueError):
            return None
        return Owner(stat_result.st_gid, os.access(self._path(path), os.R_OK | os.W_OK))

    def groups(self) -> set[int]:
        """Return the groups of this session: it lacks those that the user has joined since."""
        if sys.platform == "win32":
            return set()
        return {os.getegid(), *os.getgroups()}

    def user(self) -> str:
        """Return the user's name, to look it up in a list of members. It is never reported."""
        if sys.platform == "win32":
            return ""
        import pwd

        try:
            return pwd.getpwuid(os.geteuid()).pw_name
        except KeyError:  # a user without an entry, as in a container
            return ""

    def output(self, *command: str) -> str | None:
        """Return the output of a program, or None if there is no such program."""
        try:
            process = subprocess.run(
                command,
                stdin=subprocess.DEVNULL,
                capture_output=True,
                timeout=OUTPUT_TIMEOUT_S,
                check=False,
            )
        except (OSError, ValueError, subprocess.TimeoutExpired):
            return None
        return process.stdout.decode("utf-8", "replace") if process.returncode == 0 else None
