"""Robot profiles: which robots there are, and how one is found by name or by file.

Knows where a profile comes from. `profile` defines its fields; `reader` reads the TOML of a file;
`shipped` holds the profiles of this folder as Python objects, so that they need no TOML.
"""

from __future__ import annotations

import os.path
from pathlib import Path

from tiniscript.base.files import is_pipe
from tiniscript.robots.profile import ProfileRefused, Robot

DEFAULT = "tinibot"
MAX_FILE_BYTES = 64 * 1024


def names() -> list[str]:
    """Return the names of the shipped robots, the default first."""
    from tiniscript.robots.shipped import ROBOTS

    return sorted(ROBOTS, key=lambda name: (name != DEFAULT, name))


def load(name_or_path: str, chip: str | None = None) -> Robot:
    """Return a shipped robot (upper or lower case), or the one that a TOML file describes.

    `chip` replaces the board that the profile names. A name that is not shipped is a file if it
    ends in `.toml`, contains a separator or exists; a file has at most FILE_BYTES bytes of UTF-8.
    Raises only ProfileRefused.
    """
    from tiniscript.robots.shipped import ROBOTS

    make_robot = ROBOTS.get(name_or_path.lower())
    if make_robot is not None:
        robot = make_robot()
        if chip in (None, robot.board.chip):
            return robot
        name_or_path = f"{__path__[0]}{os.sep}{robot.name}.toml"
    if is_path(name_or_path):
        from tiniscript.robots.reader import read

        return read(text_of(name_or_path), Path(name_or_path).stem, chip)

    from tiniscript.base.spelling import nearest
    from tiniscript.robots.refusals import printable_value

    values = {"name": printable_value(name_or_path), "known": ", ".join(names())}
    raise ProfileRefused(
        ("no_such_robot", {**values, "near": nearest(name_or_path.lower(), names()) or ""})
    )


def is_path(text: str) -> bool:
    """Return whether a text names a file instead of something shipped."""
    separators = os.sep + (os.altsep or "") + "/"
    return (
        text.lower().endswith(".toml")
        or any(separator in text for separator in separators)
        or os.path.exists(text)  # noqa: PTH110 - Path raises where the name is too long
    )


def text_of(path: str, refusal_type: type[ProfileRefused] = ProfileRefused) -> str:
    """Return the text of a file of at most FILE_BYTES bytes of UTF-8. Raises `refusal_type`."""
    from tiniscript.robots.refusals import printable_value

    values = {"file": printable_value(path)}
    if is_pipe(path):
        raise refusal_type(("file_unreadable", values))
    try:
        with Path(path).open("rb") as file:
            data = file.read(MAX_FILE_BYTES + 1)
    except FileNotFoundError:
        raise refusal_type(("file_missing", values)) from None
    except (OSError, ValueError):  # ValueError: the name is not valid for a file
        is_directory = os.path.isdir(path)  # noqa: PTH112 - Path raises for those names
        code = "file_is_directory" if is_directory else "file_unreadable"
        raise refusal_type((code, values)) from None
    return decode_profile(data, path, refusal_type)


def decode_profile(
    data: bytes, name: str, refusal_type: type[ProfileRefused] = ProfileRefused
) -> str:
    """Return the text of a file's bytes, as `text_of` does. Raises `refusal_type`."""
    from tiniscript.robots.refusals import printable_value

    values = {"file": printable_value(name)}
    if len(data) > MAX_FILE_BYTES:
        limit = f"{MAX_FILE_BYTES // 1024} KB"
        raise refusal_type(("file_too_large", {**values, "limit": limit}))
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise refusal_type(("file_not_utf8", {**values, "line": str(line)})) from None
