"""Finds which process holds a port and whether it is suspended, and wakes it.

A suspended command (Ctrl-Z) keeps its port, and neither shares nor releases it. Linux reports who
has a file open; the registration of a command that shares its port does so, too.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from tiniscript.base.source import printable

NAME_CHARACTERS = 40
PS_TIMEOUT_S = 1.0  # timeout of `ps`


class Holder(NamedTuple):
    pid: int
    name: str  # name of its program

    @property
    def is_suspended(self) -> bool:
        return is_suspended(self.pid)

    def wake(self) -> bool:
        """Resume a suspended process; return whether that was possible."""
        if sys.platform == "win32" or not self.is_suspended:
            return False
        with suppress(OSError):
            os.kill(self.pid, signal.SIGCONT)
            return True
        return False


def find_holder(path: str, pid: int | None = None) -> Holder | None:
    """Return the process that has a port or a lock open; `pid` is the one that says so of itself.

    None if this is unknown.
    """
    holder_pid = next(_pids_with_open_file(path), None) if sys.platform == "linux" else pid
    holder_pid = pid if holder_pid is None else holder_pid
    if holder_pid is None or holder_pid == os.getpid():
        return None
    name = _command(holder_pid)
    return None if name is None else Holder(holder_pid, printable(name, NAME_CHARACTERS))


def is_suspended(pid: int) -> bool:
    """Return whether a process is suspended, as with Ctrl-Z."""
    if sys.platform == "linux":
        with suppress(OSError, IndexError):
            stat_line = Path(f"/proc/{pid}/stat").read_bytes()
            return stat_line.rpartition(b")")[2].split()[0] in (b"T", b"t")
        return False
    return _ps_column(pid, "state").startswith("T")


def _pids_with_open_file(path: str) -> Iterator[int]:
    """Yield the processes that have a file open, as far as this user may know that."""
    try:
        port_status = Path(path).stat()
    except (OSError, ValueError):
        return
    for process in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):  # the process has ended, or belongs to another user
            if int(process.name) != os.getpid() and any(
                os.path.samestat(port_status, path.stat()) for path in (process / "fd").iterdir()
                if path.exists()
            ):  # fmt: skip
                yield int(process.name)


def _command(pid: int) -> str | None:
    """Return the name of a process's program, with its verb if it is a tsc; None if it has
    ended."""
    words = []
    if sys.platform == "linux":
        with suppress(OSError):
            data = Path(f"/proc/{pid}/cmdline").read_bytes()
            words = data.decode("utf-8", "replace").split("\0")
    else:
        words = _ps_column(pid, "args").split()
    if not any(words):
        return None
    command_indexes = [
        index for index, word in enumerate(words[:3]) if word in ("tiniscript", "tsc")
    ]
    command_indexes += [index for index, word in enumerate(words[:3]) if Path(word).name == "tsc"]
    if command_indexes and len(words) > command_indexes[0] + 1:
        return f"tsc {words[command_indexes[0] + 1]}".strip()
    return Path(words[0]).name


def _ps_column(pid: int, column: str) -> str:
    if sys.platform == "win32":
        return ""
    import subprocess  # a stop on Linux does without

    with suppress(OSError, subprocess.SubprocessError):
        result = subprocess.run(
            ["ps", "-o", f"{column}=", "-p", str(pid)],
            capture_output=True, text=True, timeout=PS_TIMEOUT_S, check=False,
        )  # fmt: skip
        return result.stdout.strip()
    return ""
