"""Which instruction comes from which line: the map of a compiled program.

An image holds no text. Its map lies in the user's cache under the image's checksum, so that a
fault can name its line and a listing can show it. Losing a map loses nothing else.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from tiniscript import image as images
from tiniscript.cache_file import contents

if TYPE_CHECKING:
    from tiniscript import Compiled

VERSION = 1
FILE_BYTES = 32_000_000
KEPT = 1000  # maps in the cache; the oldest go first


class MapPlace(NamedTuple):
    """The instructions from `offset` on come from `line`, `column` (from 1) to the end."""

    offset: int
    line: int
    column: int
    end_line: int
    end_column: int


class Map(NamedTuple):
    """`lines` are those of the program's text, without their ends."""

    name: str
    lines: tuple[str, ...]
    places: tuple[MapPlace, ...]

    def at(self, offset: int) -> MapPlace | None:
        """Return where the instruction at `offset` comes from."""
        found = None
        for place in self.places:
            if place.offset > offset:
                break
            found = place
        return found

    def line(self, number: int) -> str:
        return self.lines[number - 1] if 1 <= number <= len(self.lines) else ""


def from_compiled(compiled: Compiled) -> Map:
    """Return the map of a program that has just been compiled."""
    source = compiled.source
    places = tuple(
        MapPlace(place.offset, *source.position(place.span.start), *source.position(place.span.end))
        for place in compiled.places
    )
    last = source.position(len(source.text))[0]
    lines = tuple(source.line_text(number) for number in range(1, last + 1))
    return Map(source.name, lines, places)


def as_json(places: Map) -> str:
    """Return a map as JSON: version, name, lines, and places as lists of numbers."""
    import json

    fields = {"version": VERSION, "name": places.name, "lines": places.lines,
              "places": places.places}  # fmt: skip
    return json.dumps(fields, ensure_ascii=False)


def from_json(text: str) -> Map:
    """Return the map in a text. Raises ValueError where it is none."""
    import json

    fields = json.loads(text)
    try:
        if fields["version"] != VERSION:
            raise ValueError("another version")
        places = tuple(MapPlace(*map(int, place)) for place in fields["places"])
        return Map(str(fields["name"]), tuple(map(str, fields["lines"])), places)
    except (KeyError, TypeError, AttributeError) as wrong:
        raise ValueError("no map") from wrong


def remember(image: bytes, places: Map) -> None:
    """Keep a map in the cache. Where the cache cannot be written, it is not kept."""
    path = _path(images.checksum(image))
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        new = path.with_suffix(f".{os.getpid()}")
        new.write_text(as_json(places), encoding="utf-8", errors="backslashreplace")
        new.replace(path)
        _forget_oldest(path.parent)
    except OSError:
        pass


def recall(checksum: int) -> Map | None:
    """Return the map of the image with this checksum, if it is in the cache."""
    try:
        return from_json(contents(_path(checksum), FILE_BYTES).decode("utf-8"))
    except (OSError, ValueError, OverflowError, RecursionError):
        return None


def _path(checksum: int) -> Path:
    from platformdirs import user_cache_path

    return user_cache_path("tiniscript", appauthor=False) / "maps" / f"{checksum:08x}.json"


def _forget_oldest(folder: Path) -> None:
    names = os.listdir(folder)  # noqa: PTH208 - a thousand Paths cost more than their names
    if len(names) > KEPT:
        paths = sorted((folder / name for name in names), key=lambda path: path.stat().st_mtime)
        for path in paths[: len(names) - KEPT]:
            path.unlink(missing_ok=True)
