"""Records which command holds which port: one file for each port, which only the user can read.

The file says where the server listens, and has the token that proves that a client belongs to the
same user. A file may outlive its server: without the right answer from there, the port is free.
Knows files, and whether a TCP port is taken. Connects to no server.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable
from contextlib import suppress
from io import FileIO
from pathlib import Path
from socket import SO_REUSEADDR, SOL_SOCKET, gethostname, socket
from typing import IO, NamedTuple
from zlib import crc32

from tiniscript.base import files
from tiniscript.base.files import read_limited
from tiniscript.link.port_names import canonical_port

FILE_BYTES = 4096
_LOCK_FLAGS = os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0)


class Registration(NamedTuple):
    """`number` is the TCP port on 127.0.0.1 where the server of `port` listens.

    A client proves with `token` that it may connect; the server proves with `answer` that it has
    written this file. `is_alias`: the same server has registered the port under another name.
    """

    port: str
    number: int
    token: str
    answer: str
    verb: str
    baud: int
    pid: int
    is_alias: bool = False


def find_registration(port: str) -> Registration | None:
    """Return the registration of the server of a port, or None."""
    registration = _read(_path(port))
    if registration is None or registration.port != canonical_port(port):
        return None
    return registration


def find_all() -> list[Registration]:
    """Return the registrations of all servers, each once."""
    tidy()
    with suppress(OSError):
        paths = sorted(_folder().glob(f"{_computer()}-*.json"))
        return [
            registration
            for registration in map(_read, paths)
            if registration is not None and not registration.is_alias
        ]
    return []


def write(registration: Registration) -> None:
    """Write the file by which clients find a server. Raises OSError if that is impossible."""
    _make_folder()
    tidy()
    files.replace(_path(registration.port), json.dumps(registration._asdict()).encode(), 0o600)


def remove(registration: Registration) -> None:
    """Remove the file of a server, unless another server has replaced it."""
    _remove(
        _path(registration.port), lambda written_registration: written_registration == registration
    )


def _remove(path: Path, is_meant: Callable[[Registration | None], bool]) -> None:
    """Remove a file if `is_meant` accepts its content, and never one that has replaced it.

    The file is renamed before the last check, and renamed back if the check fails.
    """
    if not is_meant(_read(path)):
        return
    aside_path = path.with_name(f".{path.name}.{os.urandom(8).hex()}{files.NEW_ENDING}")
    with suppress(OSError):
        path.rename(aside_path)
        if not is_meant(_read(aside_path)) and not path.exists():
            aside_path.rename(path)
        else:
            aside_path.unlink()


def tidy() -> None:
    """Remove the files of killed commands of this computer: no server listens on their ports.

    A running server listens before it writes its file, and removes the file before it stops.
    """
    folder = _folder()
    with suppress(OSError):
        names = [path.name for path in folder.iterdir()]
        files.remove_abandoned(folder, names, (".json", ".lock"))
        for name in names:
            if name.startswith(f"{_computer()}-") and name.endswith(".json"):
                _remove(folder / name, _is_dead)
            elif name.startswith(f"{_computer()}-") and name.endswith(".lock"):
                lock = _try_lock(folder / name)
                if lock is not None:
                    lock.close()


def _is_dead(registration: Registration | None) -> bool:
    return registration is not None and not is_taken(registration.number)


def is_taken(number: int) -> bool:
    """Return whether a process listens on a TCP port of this computer, without connecting."""
    with socket() as probe:
        if sys.platform != "win32":  # on Windows this would take the port from its owner
            probe.setsockopt(SOL_SOCKET, SO_REUSEADDR, 1)
        try:
            probe.bind(("127.0.0.1", number))
        except OSError:
            return True
    return False


def forget(port: str) -> None:
    """Remove the registration of a port. Only for a command that has opened the port itself."""
    with suppress(OSError):
        _path(port).unlink(missing_ok=True)


def lock_port(port: str) -> IO[bytes] | None:
    """Return a file that is locked for this process, or None if another process has the lock.

    Systems lock serial ports, but not addresses: two processes could use the same one. The lock
    ends with the file, or with the process. Raises OSError if nothing can be locked.
    """
    _make_folder()
    return _try_lock(lock_path(port))


def lock_path(port: str) -> Path:
    """Return the path of the file that is locked for an address."""
    return _path(port).with_suffix(".lock")


class _Lock(FileIO):
    """A locked file that is removed when closed; `tidy` removes those of killed processes."""

    def __init__(self, path: Path) -> None:
        super().__init__(os.open(path, _LOCK_FLAGS, 0o600), "r+")
        self.path = path
        self.is_ours = False

    @property
    def is_there(self) -> bool:
        """Return whether this locked file is still the one at its path."""
        try:
            return os.path.samestat(os.fstat(self.fileno()), self.path.stat())
        except OSError:
            return False

    def close(self) -> None:
        if self.closed:
            return
        is_unlinked = False
        if self.is_ours and self.is_there:
            with suppress(OSError):  # Windows keeps a file that is open
                self.path.unlink()
                is_unlinked = True
        super().close()
        if self.is_ours and not is_unlinked and sys.platform == "win32":
            with suppress(OSError):  # another process has the file open, and will remove it
                self.path.unlink()


def _try_lock(path: Path) -> _Lock | None:
    """Return a locked file, or None if another process has locked it.

    The previous owner may have removed the file between our open and our lock: then the lock
    protects nothing, and the file that is now at the path is tried.
    """
    while True:
        file = _Lock(path)
        if not _lock(file):
            file.close()
            return None
        if file.is_there:
            file.is_ours = True
            return file
        file.close()


def _lock(file: FileIO) -> bool:
    """Lock a file for this process; return False where another process has locked it."""
    try:
        return files.try_lock(file.fileno())
    except OSError:
        file.close()
        raise


def _read(path: Path) -> Registration | None:
    """Return the registration in a file, if only this user can have written it."""
    try:
        if sys.platform != "win32":
            folder_status = path.parent.stat()
            if folder_status.st_uid != os.geteuid() or folder_status.st_mode & 0o077:
                return None
        fields = json.loads(read_limited(path, FILE_BYTES))
        fields.setdefault("is_alias", False)  # older versions have no aliases
        registration = Registration(*(fields[name] for name in Registration._fields))
    except (OSError, ValueError, TypeError, KeyError, AttributeError,
            RecursionError):  # fmt: skip
        return None
    numbers = registration.number, registration.baud, registration.pid
    words = registration.port, registration.token, registration.answer, registration.verb
    is_sound = all(isinstance(word, str) and word.isprintable() for word in words)
    is_sound = is_sound and all(type(number) is int for number in numbers)
    is_sound = is_sound and type(registration.is_alias) is bool
    return registration if is_sound and 0 < registration.number < 65536 else None


def _make_folder() -> None:
    folder = _folder()
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    if sys.platform != "win32":
        folder.chmod(0o700)


def _folder() -> Path:
    return files.cache_folder() / "held"


def _path(port: str) -> Path:
    number = crc32(canonical_port(port).encode("utf-8", "replace"))
    return _folder() / f"{_computer()}-{number:08x}.json"


def _computer() -> str:
    """Return the name of this computer: several computers may share the user's folders."""
    return "".join(letter if letter.isalnum() else "_" for letter in gethostname())[:40]
