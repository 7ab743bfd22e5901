"""What is kept of a class: the work of its pupils, as data, and a file from which it goes on.

The file is there while a class lasts: when the teacher's computer has crashed, `tsc studio --class`
goes on from it, with the same code and the same pupils. A teacher can also keep the same work as a
file of their own and open it again; that one has no tokens and no code. What is read may be damaged
or somebody else's: all of it is checked, and limited. Knows no class.
"""

from __future__ import annotations

import json
import re
from contextlib import suppress
from pathlib import Path
from time import time
from typing import Any, NamedTuple

from tiniscript import robots
from tiniscript.base.files import contents, replace, settings_folder
from tiniscript.base.source import printable

Json = dict[str, Any]

NAME_CHARACTERS = 24
TEXT_CHARACTERS = 20_000  # of a program
MOST_PUPILS = 60
MOST_LESSONS = 40
FORM = 1  # of the file; another one is not read
GOES_ON_S = 3600.0  # a class that was seen last before is over
FILE_BYTES = 12_000_000  # sixty programs in which each character takes six bytes, and more
_LESSON = re.compile(r"\w{1,60}")
_TOKEN = re.compile(r"[0-9a-f]{32}")


class Work(NamedTuple):
    """`robot` is the profile that the program is for; `lessons` are those that are done."""

    text: str = ""
    robot: str = ""
    lessons: tuple[str, ...] = ()

    @classmethod
    def of(cls, found: Json) -> Work | None:
        """Return the work in data from elsewhere; None if it is none."""
        text, robot, lessons = found.get("text"), found.get("robot"), found.get("lessons", [])
        if not isinstance(text, str) or robot not in ("", *robots.names()):
            return None
        if not isinstance(lessons, list) or not all(is_lesson(each) for each in lessons):
            return None
        return cls(text[:TEXT_CHARACTERS], str(robot), tuple(lessons[:MOST_LESSONS]))


NOTHING = Work()


def is_lesson(found: object) -> bool:
    return isinstance(found, str) and _LESSON.fullmatch(found) is not None


def is_token(found: object) -> bool:
    return isinstance(found, str) and _TOKEN.fullmatch(found) is not None


def plain_name(found: str) -> str:
    """Return a pupil's name as one line that hides nothing; empty if nothing is left."""
    return printable(" ".join(found.split()), NAME_CHARACTERS)


# -- the file -------------------------------------------------------------------------------------


def path() -> Path:
    return settings_folder() / "class.json"


def keep(of_class: Json) -> None:
    """Keep a class, so that not even a power cut loses it. Raises OSError."""
    folder = path().parent
    folder.mkdir(parents=True, exist_ok=True)
    data = json.dumps({"form": FORM, "kept_s": int(time()), **of_class}, ensure_ascii=False)
    replace(path(), data.encode("utf-8", "replace"), mode=0o600, is_lasting=True)


def kept() -> Json | None:
    """Return the class that has not ended and was seen within the last hour, or None."""
    try:
        found = json.loads(contents(path(), FILE_BYTES))
    except (OSError, ValueError, RecursionError):
        return None
    if not isinstance(found, dict) or found.get("form") != FORM:
        return None
    when_s = found.get("kept_s")
    is_new = type(when_s) is int and 0 <= time() - when_s <= GOES_ON_S
    return found if is_new else None


def forget() -> None:
    """Delete what is kept of a class that is over."""
    with suppress(OSError):
        path().unlink()
