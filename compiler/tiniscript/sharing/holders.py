"""Who holds which port: a file for each, which only the user can read.

It says where the holder listens and what proves that a command is of the same user. A file may
outlive its holder: whoever reads it must hear the right answer from there, or the port is free.
Knows files. Talks to nobody.
"""

from __future__ import annotations

import json
import os
import sys
from contextlib import suppress
from pathlib import Path
from socket import gethostname
from typing import IO, NamedTuple
from zlib import crc32

from tiniscript.cache_file import contents
from tiniscript.link.names import same_for_all

FILE_BYTES = 4096


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
    with suppress(OSError):
        paths = sorted(_folder().glob(f"{_computer()}-*.json"))
        return [holder for holder in map(_read, paths) if holder is not None]
    return []


def write(holder: Holder) -> None:
    """Let others find a holder. Raises OSError where nothing can be written."""
    path = _path(holder.port)
    _make_folder()
    new = path.with_suffix(f".{os.getpid()}")
    with suppress(OSError):
        new.unlink()  # of another process that had this number
    file = os.open(new, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    try:
        os.write(file, json.dumps(holder._asdict()).encode())
    finally:
        os.close(file)
    new.replace(path)


def remove(holder: Holder) -> None:
    """Take back what is written of a holder, unless another one has written since."""
    if _read(_path(holder.port)) == holder:
        with suppress(OSError):
            _path(holder.port).unlink()


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
    file = _path(port).with_suffix(".lock").open("ab")
    try:
        if sys.platform == "win32":
            import msvcrt

            file.seek(0)
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):
        file.close()
        return None
    return file


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
    from platformdirs import user_cache_path

    return user_cache_path("tiniscript", appauthor=False) / "held"


def _path(port: str) -> Path:
    number = crc32(same_for_all(port).encode("utf-8", "replace"))
    return _folder() / f"{_computer()}-{number:08x}.json"


def _computer() -> str:
    """Return the name of this computer: others may share the user's folders."""
    return "".join(letter if letter.isalnum() else "_" for letter in gethostname())[:40]
