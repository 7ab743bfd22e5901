"""Finds the SHOW in a program's text that has shown a value: its expression names the value.

Two programs with the same code share one map, the newest; a running program keeps its own. A value
of an unknown program has no name, and neither has a plain number.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping
from typing import NamedTuple

from tiniscript.base.source import printable
from tiniscript.library import source_map
from tiniscript.library.source_map import MapLocation, SourceMap
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

    def __init__(self, program_map: SourceMap) -> None:
        self._program_map = program_map
        expression_by_location = {
            location[1:]: expression_of(program_map, location) for location in program_map.locations
        }
        text_by_location = {
            location: text for location, text in expression_by_location.items() if text
        }
        text_counts = Counter(text_by_location.values())
        line_counts = Counter((text, location[0]) for location, text in text_by_location.items())
        self._shows = {
            location: Show(
                text, *location[:2], text_counts[text] > 1, line_counts[text, location[0]] > 1
            )
            for location, text in text_by_location.items()
        }

    def show_at(self, offset: int) -> Show | None:
        """Return the SHOW whose instruction is at `offset`, if it has a name."""
        location = self._program_map.location_at(offset)
        return None if location is None else self._shows.get(location[1:])


class ShowFinder:
    """Finds the SHOW of a value. `own_maps` has the maps of programs that are known here, by
    checksum; those of others are in the cache. A run keeps the text that its program had when it
    began, or when it was first heard of: another one may have the same code."""

    def __init__(self, own_maps: Mapping[int, SourceMap] | None = None) -> None:
        self._own_maps = {} if own_maps is None else own_maps
        # Program and map by run; numbers of runs repeat.
        self._runs: dict[int, tuple[int, SourceMap]] = {}
        self._shows: tuple[SourceMap, Shows] | None = None

    def begin(self, run: int, program: int) -> None:
        """Note that a run begins."""
        self._runs.pop(run, None)
        self.map_of(run, program)

    def map_of(self, run: int, program: int) -> SourceMap | None:
        """Return the map of a run's program."""
        known_program, program_map = self._runs.get(run, (-1, None))
        if known_program != program:
            program_map = self._own_maps.get(program) or source_map.recall(program)
            if program_map is not None:
                self._runs[run] = program, program_map
        return program_map

    def show_of(self, event: ShownEvent) -> Show | None:
        program_map = self.map_of(event.run, event.program) if event.offset >= 0 else None
        if program_map is None:
            return None
        if self._shows is None or self._shows[0] is not program_map:
            self._shows = program_map, Shows(program_map)
        return self._shows[1].show_at(event.offset)


def expression_of(program_map: SourceMap, location: MapLocation) -> str:
    """Return the expression of a SHOW; or an empty text for another instruction or a plain
    number."""
    lines = list(program_map.lines[location.line - 1 : location.end_line])
    if not lines:
        return ""
    lines[-1] = lines[-1][: location.end_column - 1]
    lines[0] = lines[0][location.column - 1 :]
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
