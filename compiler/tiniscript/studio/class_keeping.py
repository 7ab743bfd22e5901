"""The stored state of a class: the work of its pupils, as data, and the file for resuming.

The file is there while a class lasts: when the teacher's computer has crashed, `tsc studio --class`
continues from it, with the same code and the same pupils. Only the teacher ends a class: if a class
has not ended, however old it is, the next one gets its work. A teacher can also keep the same work
as a file of their own and open it again; that one has no tokens and no code. The file may be
damaged or foreign, so everything read is checked and limited. Knows no class.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from contextlib import suppress
from pathlib import Path
from time import time
from typing import Any, NamedTuple

from tiniscript import robots
from tiniscript.base.files import LOCK_ENDING, read_limited, replace, settings_folder, try_lock

Json = dict[str, Any]

TEXT_CHARACTERS = 20_000  # most characters of a program
MAX_PUPILS = 60
MAX_WORKS = 120  # most works kept, for pupils present and absent
MAX_LESSONS = 40
FORM_VERSION = 1  # version of the file's form; others are not read
SAME_LESSON_S = 3600.0  # pupils of a class that was seen last before must join again
FILE_BYTES = 24_000_000  # bytes of all works; a character may take six bytes
_LESSON = re.compile(r"\w{1,60}")
_TOKEN = re.compile(r"[0-9a-f]{32}")


class Work(NamedTuple):
    """`robot` is the profile that the program is for; `lessons` are those that are done."""

    text: str = ""
    robot: str = ""
    lessons: tuple[str, ...] = ()

    @classmethod
    def of(cls, data: Json) -> Work | None:
        """Return the work in data from elsewhere; None if it is none."""
        text, robot, lessons = data.get("text"), data.get("robot"), data.get("lessons", [])
        if not isinstance(text, str) or robot not in ("", *robots.names()):
            return None
        if not isinstance(lessons, list) or not all(is_lesson(lesson) for lesson in lessons):
            return None
        # The state in the form of the file.
        stored_text = text[:TEXT_CHARACTERS].encode("utf-8", "replace").decode()
        return cls(stored_text, str(robot), tuple(lessons[:MAX_LESSONS]))


NOTHING = Work()


def is_lesson(value: object) -> bool:
    return isinstance(value, str) and _LESSON.fullmatch(value) is not None


def is_token(value: object) -> bool:
    return isinstance(value, str) and _TOKEN.fullmatch(value) is not None


# -- the file -------------------------------------------------------------------------------------


class ClassTaken(Exception):
    """Another `tsc studio` of this user has a class."""


class KeptClass(NamedTuple):
    """`is_same_lesson`: seen within the last hour, or unknown if the clock was set back."""

    state: Json
    is_same_lesson: bool


class Keeper:
    """The file of a class, for as long as a command has it: no other one reads or changes it."""

    def __init__(self) -> None:
        """Raises Taken."""
        self._lock: int | None = None
        self._newest_digest = ""
        if not self._is_ours():
            raise ClassTaken

    def _is_ours(self) -> bool:
        """Return whether no other command has the file. A full disk allows no lock until there is
        room; some file systems have no locks.
        """
        if self._lock is not None:
            return True
        flags = os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0)
        try:
            path().parent.mkdir(parents=True, exist_ok=True)
            descriptor = os.open(path().with_name(path().name + LOCK_ENDING), flags, 0o600)
        except OSError:
            return True
        is_ours = True
        with suppress(OSError):
            is_ours = try_lock(descriptor)
        if is_ours:
            self._lock = descriptor
        else:
            os.close(descriptor)
        return is_ours

    def read(self) -> KeptClass | None:
        """Return the class that has not ended, or None. A file that is not a class is moved
        aside."""
        try:
            state = json.loads(read_limited(path(), FILE_BYTES))
            if not isinstance(state, dict) or state.get("form") != FORM_VERSION:
                raise ValueError
        except FileNotFoundError:
            return None
        except (OSError, ValueError, RecursionError):
            with suppress(OSError):
                path().replace(_unread_path())
            return None
        kept_s = state.get("kept_s")
        return KeptClass(state, type(kept_s) is int and time() - kept_s <= SAME_LESSON_S)

    def keep(self, state: Json | None) -> None:
        """Keep a class if it is another than the newest that was kept. Failed writes are retried;
        for a class that is over, None, nothing is kept."""
        if not self._is_ours():
            return
        if state is None:
            forget()
            self._newest_digest = ""
            return
        digest = hashlib.sha256(json.dumps(state).encode()).hexdigest()
        if digest != self._newest_digest:
            with suppress(OSError, ValueError):  # a full disk ends no lesson
                _write(state)
                self._newest_digest = digest

    def close(self) -> None:
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None


def path() -> Path:
    return settings_folder() / "class.json"


def groups_folder() -> Path:
    """Return the folder of the journals of groups."""
    return settings_folder() / "class.groups"


def _unread_path() -> Path:
    return path().with_name("class.unread.json")


def _write(state: Json) -> None:
    """Write a class, so that not even a power cut loses it. Raises OSError or ValueError."""
    data = json.dumps({"form": FORM_VERSION, "kept_s": int(time()), **state}, ensure_ascii=False)
    replace(path(), data.encode("utf-8", "replace"), mode=0o600, is_lasting=True)


def forget() -> None:
    """Delete the stored data of a class that is over."""
    for file in (path(), _unread_path()):
        with suppress(OSError):
            file.unlink()
