"""The source map: which instruction of a compiled program comes from which line, and the names.

An image holds no text. Its map lies in the user's cache under the image's checksum, so that a fault
can name its line and a disassembly can show it. If a map is lost, nothing else is lost.
"""

from __future__ import annotations

import os
from contextlib import suppress
from itertools import takewhile
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from tiniscript.base import files
from tiniscript.base.files import read_limited
from tiniscript.base.words import TASKS
from tiniscript.bytecode import image as images

if TYPE_CHECKING:
    from tiniscript.library.compiling import Compilation

VERSION = 1
MAX_FILE_BYTES = 32_000_000
MAX_MAPS = 1000  # maps in the cache; the oldest go first


class MapLocation(NamedTuple):
    """The instructions from `offset` on come from `line`, `column` (from 1) to the end."""

    offset: int
    line: int
    column: int
    end_line: int
    end_column: int


class SourceMap(NamedTuple):
    """`lines` are those of the program's text, without their ends; `variables` are names in the
    order of their numbers, and `yes_no_flags` says which of them are yes/no: empty for a map of an
    earlier version."""

    name: str
    lines: tuple[str, ...]
    locations: tuple[MapLocation, ...]
    variables: tuple[str, ...] = ()
    yes_no_flags: tuple[bool, ...] = ()

    def location_at(self, offset: int) -> MapLocation | None:
        """Return the source location of the instruction at `offset`."""
        last_location = None
        for location in self.locations:
            if location.offset > offset:
                break
            last_location = location
        return last_location

    def task_of(self, location: MapLocation) -> tuple[str, int] | None:
        """Return the word and the line of the TASK or WHEN around a place; "" and 0 outside.

        Returns None if there are no tasks, or in a DEF, which any of them may have called.
        """
        blocks = [(self._word(block_location), block_location) for block_location in self.locations]
        if not any(word in TASKS for word, _ in blocks):
            return None
        for word, enclosing_location in blocks:
            is_enclosing = (
                enclosing_location[1:3] <= location[1:3] and location[3:] <= enclosing_location[3:]
            )
            if is_enclosing and word in (*TASKS, "DEF"):
                return None if word == "DEF" else (word, enclosing_location.line)
        return "", 0

    def _word(self, location: MapLocation) -> str:
        text_after = self.line(location.line)[location.column - 1 :]
        return "".join(
            takewhile(lambda letter: letter.isalnum() or letter == "_", text_after)
        ).upper()

    def line(self, line_number: int) -> str:
        return self.lines[line_number - 1] if 1 <= line_number <= len(self.lines) else ""


def map_of_compiled(compilation: Compilation) -> SourceMap:
    """Return the map of a program that has just been compiled."""
    source = compilation.source
    map_locations = tuple(
        MapLocation(
            location.offset,
            *source.position(location.span.start),
            *source.position(location.span.end),
        )
        for location in compilation.locations
    )
    last_line = source.position(len(source.text))[0]
    lines = tuple(source.line_text(line) for line in range(1, last_line + 1))
    return SourceMap(
        source.name, lines, map_locations, compilation.variables, compilation.yes_no_flags
    )


def as_json(source_map: SourceMap) -> str:
    """Return a map as JSON: version, name, lines, places as lists of numbers, variables, and which
    of them are a yes/no.

    Importing json takes longer than writing this.
    """
    lines = ", ".join(map(_json_string, source_map.lines))
    numbers = ", ".join(f"[{', '.join(map(str, location))}]" for location in source_map.locations)
    variables = ", ".join(map(_json_string, source_map.variables))
    yes_no = ", ".join("true" if flag else "false" for flag in source_map.yes_no_flags)
    return (
        f'{{"version": {VERSION}, "name": {_json_string(source_map.name)}, "lines": [{lines}],'
        f' "places": [{numbers}], "variables": [{variables}],'
        f' "yes_no": [{yes_no}]}}'
    )


_ESCAPES = {code: f"\\u{code:04x}" for code in range(32)}
_ESCAPES |= {
    ord(sign): f"\\{as_sign}" for sign, as_sign in zip('"\\\b\f\n\r\t', '"\\bfnrt', strict=True)
}


def _json_string(text: str) -> str:
    return f'"{text.translate(_ESCAPES)}"'


def from_json(text: str) -> SourceMap:
    """Return the map in a text. Raises ValueError if the text is not a map."""
    import json

    fields = json.loads(text)
    try:
        if fields["version"] != VERSION:
            raise ValueError("another version")
        locations = tuple(MapLocation(*map(int, location)) for location in fields["places"])
        lines, variables = tuple(map(str, fields["lines"])), fields.get("variables", [])
        yes_no_flags = tuple(map(bool, fields.get("yes_no", [])))
        return SourceMap(
            str(fields["name"]), lines, locations, tuple(map(str, variables)), yes_no_flags
        )
    except (KeyError, TypeError, AttributeError) as error:
        raise ValueError("no map") from error


def remember(image: bytes, source_map: SourceMap) -> None:
    """Keep a map in the cache. If the cache cannot be written, the map is not kept."""
    path = _path(images.checksum(image))
    if files.keep(path, as_json(source_map).encode(errors="backslashreplace")):
        with suppress(OSError):
            _forget_oldest(path.parent)


def recall(checksum: int) -> SourceMap | None:
    """Return the map of the image with this checksum, if it is in the cache."""
    path = _path(checksum)
    try:
        return from_json(read_limited(path, MAX_FILE_BYTES).decode("utf-8"))
    except OSError:
        return None
    except (ValueError, OverflowError, RecursionError):
        with suppress(OSError):  # the map is damaged, for example cut by a full disk
            path.unlink()
        return None


def _path(checksum: int) -> Path:
    return files.cache_folder() / "maps" / f"{checksum:08x}.json"


def _forget_oldest(folder: Path) -> None:
    names = os.listdir(folder)  # noqa: PTH208 - a thousand Paths cost more than their names
    files.remove_abandoned(folder, names)
    map_names = [name for name in names if name.endswith(".json")]
    if len(map_names) > MAX_MAPS:
        dated_names = sorted((_modification_s(folder / name), name) for name in map_names)
        for _, name in dated_names[: len(map_names) - MAX_MAPS]:
            with suppress(OSError):
                (folder / name).unlink()


def _modification_s(path: Path) -> float:
    try:
        return path.stat().st_mtime
    except OSError:  # another command has just removed the file
        return 0.0
