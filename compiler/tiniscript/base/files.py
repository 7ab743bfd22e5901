"""Files that are whole or not there: the one place where a file gets new content at once.

The new content is written beside the file, under an unpredictable name, into a newly created file,
which then replaces the original. So a user who may write to the folder cannot redirect the write to
another file, and a reader sees either the old content or the new.

A symbolic link stays a link: its target is replaced, as by a shell's `>`. One that another user has
put into a folder where others may write is no way to a file: that is refused. Another hard link to
the file keeps the old content.

It knows where a command keeps data for the next one. It does not know what the files contain.
"""

from __future__ import annotations

import errno
import os
import stat
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from time import monotonic, sleep, time

NEW_ENDING = ".new"  # the end of the name of a file that is not yet whole
MAX_LINKS = 40  # most symbolic links to follow to a file
NAME_CHARACTERS = 100  # characters of a file's name that its temporary file keeps
LOCK_ENDING = (
    ".lock"  # the end of the name of a file that commands lock while they change another one
)
LOCK_WAIT_S = 5.0  # time that a command waits for another one
# Time for which a file may stay open elsewhere before replacing it on Windows fails.
REPLACE_WAIT_S = 1.0
OWNER_ONLY = 0o700  # a folder that only its user may look into
ABANDONED_AFTER_S = 3600.0  # a new file that is older has lost its command


def cache_folder() -> Path:
    """Return the user's folder for data that a command keeps for the next one: it may be
    deleted."""
    folder = _linux_folder("XDG_CACHE_HOME", ".cache")
    if folder is not None:
        return folder
    from platformdirs import user_cache_path

    return user_cache_path("tiniscript", appauthor=False)


def settings_folder() -> Path:
    """Return the user's folder for data that must not be lost."""
    folder = _linux_folder("XDG_CONFIG_HOME", ".config")
    if folder is not None:
        return folder
    from platformdirs import user_config_path

    return user_config_path("tiniscript", appauthor=False)


def _linux_folder(variable: str, usual_folder: str) -> Path | None:
    """Return one of our folders at its place on Linux, or None.

    Nearly everywhere on Linux one of two variables says it: importing platformdirs takes as long as
    compiling a program.
    """
    if sys.platform not in ("linux", "emscripten") or "ANDROID_ROOT" in os.environ:
        return None
    configured_text = os.environ.get(variable)
    folder = (
        Path(configured_text)
        if configured_text
        else Path(os.environ.get("HOME", "")) / usual_folder
    )
    return folder / "tiniscript" if folder.is_absolute() else None


def replace(path: Path, data: bytes, mode: int | None = None, is_lasting: bool = False) -> None:
    """Replace the content of a file, or leave it unchanged. Raises OSError or ValueError.

    `mode` is the permissions that it gets; without it, an existing file keeps its own, and a new
    file follows the umask. A device or a pipe, which has no old content, is written to.
    `is_lasting`: also where the power goes, or the stick is pulled, the old content is there or the
    new; that takes time.
    """
    _check_links(path)
    stat_result = _stat(path)
    if stat_result is not None and not stat.S_ISREG(stat_result.st_mode):
        with path.open("wb") as device:
            device.write(data)
        return
    target = path.resolve()
    if stat_result is not None:
        if not os.access(target, os.W_OK):
            raise PermissionError(13, os.strerror(13))
        mode = stat.S_IMODE(stat_result.st_mode) & 0o777 if mode is None else mode
    new_path = target.with_name(
        f".{target.name[:NAME_CHARACTERS]}.{os.urandom(8).hex()}{NEW_ENDING}"
    )
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL
    flags |= getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
    # the new file must be no more readable than the file it replaces
    try:
        descriptor = os.open(new_path, flags, 0o666 if mode is None else 0o600)
        with open(descriptor, "wb") as stream:  # noqa: PTH123 - a number, not a path
            stream.write(data)
            if is_lasting:
                stream.flush()
                os.fsync(descriptor)
        if mode is not None:
            new_path.chmod(mode)
        _move_into_place(new_path, target)
    except BaseException:
        with suppress(OSError):
            new_path.unlink()
        raise


def keep(path: Path, data: bytes) -> bool:
    """Put data into a file of ours, in a folder of ours; return whether that was possible.

    They may contain a person's programs, so only that person may read them; this includes files of
    an older tsc.
    """
    try:
        path.parent.mkdir(mode=OWNER_ONLY, parents=True, exist_ok=True)
        if stat.S_IMODE(path.parent.stat().st_mode) & ~OWNER_ONLY and sys.platform != "win32":
            path.parent.chmod(OWNER_ONLY)
        replace(path, data, 0o600)
    except (OSError, ValueError):
        return False
    return True


def _check_links(path: Path) -> None:
    """Raise PermissionError where another user's link, in a folder of many, is on the way.

    The rule is that of Linux for folders like /tmp: a link of the folder's owner, root or the own
    user leads on.
    """
    if sys.platform == "win32":
        return
    reached_path, parts_left = Path(path.anchor or "."), list(path.parts[1 if path.anchor else 0 :])
    link_count = 0
    while parts_left:
        next_path = reached_path / parts_left.pop(0)
        try:
            link_stat = next_path.lstat()
        except OSError:  # the file does not exist, so it cannot be a link
            return
        if not stat.S_ISLNK(link_stat.st_mode):
            reached_path = next_path
            continue
        folder_stat = reached_path.stat()
        is_shared = folder_stat.st_mode & (stat.S_IWGRP | stat.S_IWOTH)
        if is_shared and link_stat.st_uid not in (os.geteuid(), folder_stat.st_uid, 0):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
        link_count += 1
        if link_count > MAX_LINKS:
            return  # anyone who opens the file reports the error
        target = next_path.readlink()
        reached_path = Path(target.anchor) if target.anchor else reached_path
        parts_left = [*target.parts[1 if target.anchor else 0 :], *parts_left]


def _move_into_place(new_path: Path, target: Path) -> None:
    """Put a file in the place of another one.

    Windows replaces no file that is open, and a virus scanner or another command may be reading it
    just now: then this waits a moment.
    """
    end_s = monotonic() + REPLACE_WAIT_S
    while True:
        try:
            new_path.replace(target)
            return
        except PermissionError:
            if sys.platform != "win32" or monotonic() >= end_s:
                raise
        sleep(0.02)


@contextmanager
def lock_file(path: Path, mode: int = 0o600) -> Iterator[None]:
    """No other process that asks for the same changes a file meanwhile. Raises OSError.

    A process that ends releases its locks. A suspended process does not: then this ends with
    TimeoutError after some seconds.
    """
    lock_path = path.with_name(path.name + LOCK_ENDING)
    flags = os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0)
    descriptor = os.open(lock_path, flags, mode)
    try:
        end_s = monotonic() + LOCK_WAIT_S
        while not try_lock(descriptor):
            if monotonic() >= end_s:
                raise TimeoutError(110, os.strerror(110))
            sleep(0.02)
        yield
    finally:
        os.close(descriptor)


def try_lock(descriptor: int) -> bool:
    """Lock an open file for this process, unless another one has."""
    try:
        if sys.platform == "win32":
            import msvcrt

            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):
        return False
    return True


def remove_abandoned(
    folder: Path, names: list[str], kept_endings: tuple[str, ...] = (".json",)
) -> None:
    """Remove the remains of killed commands in one of our folders, except names with
    `kept_endings`.

    `names` are those of the folder. A file that may still become whole is left alone.
    """
    for name in names:
        if not name.endswith(kept_endings):
            with suppress(OSError):
                if (folder / name).lstat().st_mtime < time() - ABANDONED_AFTER_S:
                    (folder / name).unlink()


def is_pipe(name: str) -> bool:
    """Return whether a name is that of a named pipe, whose reader may block forever.

    Pipes that a shell has opened, such as `<(tsc show --port P)` and `/dev/stdin`, are in /dev and
    have a writer.
    """
    try:
        return not name.startswith("/dev/") and stat.S_ISFIFO(os.stat(name).st_mode)  # noqa: PTH116
    except (OSError, ValueError):  # reading the file reports the reason
        return False


def read_limited(path: Path, limit_bytes: int) -> bytes:
    """Return the bytes of a path of any kind: this returns soon, whatever is there.

    A pipe would be waited for, and a device or a huge file would fill the memory. Raises OSError
    if there is no regular file, or more than so many bytes.
    """
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    descriptor = os.open(path, flags)
    with os.fdopen(descriptor, "rb") as file:
        if not stat.S_ISREG(os.fstat(descriptor).st_mode):
            raise OSError("no file")
        data = file.read(limit_bytes + 1)
    if len(data) > limit_bytes:
        raise OSError("too large")
    return data


def _stat(path: Path) -> os.stat_result | None:
    """Return the status of a path, following links; None if nothing is there."""
    try:
        return path.stat()
    except FileNotFoundError:
        return None
