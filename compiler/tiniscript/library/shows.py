"""Which SHOW of a program's text has shown a value: its expression names the value.

Two programs with the same code have one map, the newest; what runs keeps its own. A value whose
program is not known here has no name, and neither has a plain number.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping
from typing import NamedTuple

from tiniscript.base.source import printable
from tiniscript.library import source_map
from tiniscript.library.source_map import Map, MapLocation
from tiniscript.link.outcomes import ShownEvent
from tiniscript.syntax.formatter import instruction_text, pieces_of
from tiniscript.syntax.lexer import scan

_SHOW_START, _SHOW_END = "SHOW(", ")"
_PLAIN_VALUE = re.compile(r"-?[\d.]+|TRUE|FALSE|")


class Show(NamedTuple):
    """A SHOW of a text: its expression as the formatter writes it, and where it begins, from 1.

    `shares_text`: another one has the same expression; `shares_line`: on the same line, too.
    """

    text: str
    line: int
    column: int
    shares_text: bool = False
    shares_line: bool = False


class Shows:
    """The SHOWs of a program. The copies of a DEF, one for each task, have one."""

    def __init__(self, places: Map) -> None:
        self._places = places
        expression_by_place = {place[1:]: expression_of(places, place) for place in places.places}
        named_places = {place: text for place, text in expression_by_place.items() if text}
        texts = Counter(named_places.values())
        lines = Counter((text, place[0]) for place, text in named_places.items())
        self._shows = {
            place: Show(text, *place[:2], texts[text] > 1, lines[text, place[0]] > 1)
            for place, text in named_places.items()
        }

    def at(self, offset: int) -> Show | None:
        """Return the SHOW whose instruction is at `offset`, if it has a name."""
        place = self._places.at(offset)
        return None if place is None else self._shows.get(place[1:])


class Finder:
    """Finds the SHOW of a value. `own_maps` has the maps of programs that are known here, by
    checksum; those of others are in the cache. A run keeps the text that its program had when it
    began, or when it was first heard of: another one may have the same code."""

    def __init__(self, own_maps: Mapping[int, Map] | None = None) -> None:
        self._own = {} if own_maps is None else own_maps
        self._runs: dict[int, tuple[int, Map]] = {}  # its program, which comes round again
        self._shows: tuple[Map, Shows] | None = None

    def begin(self, run: int, program: int) -> None:
        """Note that a run begins."""
        self._runs.pop(run, None)
        self.map_of(run, program)

    def map_of(self, run: int, program: int) -> Map | None:
        """Return the map of a run's program."""
        begin_ms, places = self._runs.get(run, (-1, None))
        if begin_ms != program:
            places = self._own.get(program) or source_map.recall(program)
            if places is not None:
                self._runs[run] = program, places
        return places

    def show_of(self, event: ShownEvent) -> Show | None:
        places = self.map_of(event.run, event.program) if event.at >= 0 else None
        if places is None:
            return None
        if self._shows is None or self._shows[0] is not places:
            self._shows = places, Shows(places)
        return self._shows[1].at(event.at)


def expression_of(places: Map, place: MapLocation) -> str:
    """Return the expression of a SHOW; nothing for another instruction, or for a plain number."""
    lines = list(places.lines[place.line - 1 : place.end_line])
    if not lines:
        return ""
    lines[-1] = lines[-1][: place.end_column - 1]
    lines[0] = lines[0][place.column - 1 :]
    if not lines[0].upper().startswith("SHOW"):
        return ""
    pieces = pieces_of(scan("\n".join(lines)))
    tokens = pieces[0].tokens if len(pieces) == 1 else []
    if not tokens:
        return ""
    text = printable(instruction_text(tokens))
    is_show = text.startswith(_SHOW_START) and text.endswith(_SHOW_END)
    text = text.removeprefix(_SHOW_START).removesuffix(_SHOW_END)
    return text if is_show and not _PLAIN_VALUE.fullmatch(text) else ""
