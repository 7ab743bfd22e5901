"""Who holds which port: a file for each, which only the user can read.

It says where the holder listens and what proves that a command is of the same user. A file may
outlive its holder: whoever reads it must hear the right answer from there, or the port is free.
Knows files, and whether a TCP port is taken. Talks to nobody.
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

from tiniscript import files
from tiniscript.files import contents
from tiniscript.link.port_names import same_for_all

FILE_BYTES = 4096
_LOCK_FLAGS = os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0)


class Holder(NamedTuple):
    """`number` is the TCP port on 127.0.0.1 where the holder of `port` listens.

    A guest proves with `token` that it may come in, and the holder with `answer` that it is the
    one who has written this.
    """

    port: str
    number: int
    token: str
    answer: str
    verb: str
    baud: int
    pid: int


def found(port: str) -> Holder | None:
    """Return what is written of the holder of a port, if anything is."""
    holder = _read(_path(port))
    return holder if holder is not None and holder.port == same_for_all(port) else None


def all_found() -> list[Holder]:
    """Return what is written of the holders of all ports."""
    tidy()
    with suppress(OSError):
        paths = sorted(_folder().glob(f"{_computer()}-*.json"))
        return [holder for holder in map(_read, paths) if holder is not None]
    return []


def write(holder: Holder) -> None:
    """Let others find a holder. Raises OSError where nothing can be written."""
    _make_folder()
    tidy()
    files.replace(_path(holder.port), json.dumps(holder._asdict()).encode(), 0o600)


def remove(holder: Holder) -> None:
    """Take back what is written of a holder, unless another one has written since."""
    _remove(_path(holder.port), lambda found: found == holder)


def _remove(path: Path, is_meant: Callable[[Holder | None], bool]) -> None:
    """Remove a file if it says what is meant, and never another one that was written meanwhile.

    It is taken aside before it is read for the last time, and put back where it is another one.
    """
    if not is_meant(_read(path)):
        return
    aside = path.with_name(f".{path.name}.{os.urandom(8).hex()}{files.NEW}")
    with suppress(OSError):
        path.rename(aside)
        if not is_meant(_read(aside)) and not path.exists():
            aside.rename(path)
        else:
            aside.unlink()


def tidy() -> None:
    """Remove what killed commands of this computer have left: nobody listens where they did.

    A living holder listens before it writes its file, and removes the file before it stops.
    """
    folder = _folder()
    with suppress(OSError):
        names = [path.name for path in folder.iterdir()]
        files.remove_abandoned(folder, names, (".json", ".lock"))
        for name in names:
            if name.startswith(f"{_computer()}-") and name.endswith(".json"):
                _remove(folder / name, _is_dead)
            elif name.startswith(f"{_computer()}-") and name.endswith(".lock"):
                lock = _locked(folder / name)
                if lock is not None:
                    lock.close()


def _is_dead(holder: Holder | None) -> bool:
    return holder is not None and not is_taken(holder.number)


def is_taken(number: int) -> bool:
    """Whether somebody listens on a TCP port of this computer; nobody is visited for that."""
    with socket() as probe:
        if sys.platform != "win32":  # there it would take a port away from its owner
            probe.setsockopt(SOL_SOCKET, SO_REUSEADDR, 1)
        try:
            probe.bind(("127.0.0.1", number))
        except OSError:
            return True
    return False


def forget(port: str) -> None:
    """Remove what is written of a holder of a port, for whoever has opened the port."""
    with suppress(OSError):
        _path(port).unlink(missing_ok=True)


def claimed(port: str) -> IO[bytes] | None:
    """Return a file that is locked for this process alone, or None where another one has it.

    No system keeps two processes from the same address, as it does with serial ports. The lock
    ends with the file, or with the process. Raises OSError where nothing can be locked.
    """
    _make_folder()
    return _locked(_path(port).with_suffix(".lock"))


class _Lock(FileIO):
    """A locked file, which goes when it is closed; whoever is killed leaves it to `tidy`."""

    def __init__(self, path: Path) -> None:
        super().__init__(os.open(path, _LOCK_FLAGS, 0o600), "r+")
        self.path = path
        self.is_ours = False

    @property
    def is_there(self) -> bool:
        """Whether the file of this lock is still the one at its path."""
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
            with suppress(OSError):  # another process has it open, and will remove it
                self.path.unlink()


def _locked(path: Path) -> _Lock | None:
    """Return a locked file, or None where another process has it.

    Whoever had it may have removed it between our opening and our locking it: then it locks
    nothing, and the next one at its place is tried.
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
    """Lock a file for this process; return whether nobody else had done so."""
    try:
        if sys.platform == "win32":
            import msvcrt

            file.seek(0)
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):
        return False
    except OSError:
        file.close()
        raise
    return True


def _read(path: Path) -> Holder | None:
    """Return what a file says, if this user alone may have written it."""
    try:
        if sys.platform != "win32":
            about = path.parent.stat()
            if about.st_uid != os.geteuid() or about.st_mode & 0o077:
                return None
        fields = json.loads(contents(path, FILE_BYTES))
        holder = Holder(*(fields[name] for name in Holder._fields))
    except (OSError, ValueError, TypeError, KeyError, RecursionError):
        return None
    numbers = holder.number, holder.baud, holder.pid
    words = holder.port, holder.token, holder.answer, holder.verb
    is_sound = all(isinstance(each, str) and each.isprintable() for each in words)
    is_sound = is_sound and all(type(each) is int for each in numbers)
    return holder if is_sound and 0 < holder.number < 65536 else None


def _make_folder() -> None:
    folder = _folder()
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    if sys.platform != "win32":
        folder.chmod(0o700)


def _folder() -> Path:
    return files.cache_folder() / "held"


def _path(port: str) -> Path:
    number = crc32(same_for_all(port).encode("utf-8", "replace"))
    return _folder() / f"{_computer()}-{number:08x}.json"


def _computer() -> str:
    """Return the name of this computer: others may share the user's folders."""
    return "".join(letter if letter.isalnum() else "_" for letter in gethostname())[:40]
