"""Turns the events of the link into data for users of the library."""

from __future__ import annotations

from collections.abc import Mapping
from time import monotonic
from typing import Literal, NamedTuple

from tiniscript.base.fixed_point import value_of
from tiniscript.base.source import printable
from tiniscript.library.endings import DONE, FAULT
from tiniscript.library.runs import Fault, Value, fault_of
from tiniscript.library.shows import ShowFinder
from tiniscript.library.source_map import SourceMap
from tiniscript.link.names import cause_name, fault_name
from tiniscript.link.outcomes import Event
from tiniscript.link.payloads import FaultEvent


class RobotEvent(NamedTuple):
    """An event of a robot, `ms` milliseconds after the connection was made, by the wall clock.

    name      values
    SHOW      value; name: the expression, line and column of its SHOW, if the text is known
    STARTED   checksum of the program
    DONE      none
    FAULT     fault: its name; offset in the code; line and column, if the text is known
    STOPPED   cause: NONE, SEQUENCE, MESSAGE, BUTTON, CABLE or TEXT
    MISSED    count of events that did not arrive
    TEXT      text that is no message of the link
    """

    ms: int
    name: str
    values: Mapping[str, Value]


class Ending(NamedTuple):
    """The end of a program. `name` is DONE, FAULT or STOPPED."""

    name: Literal["DONE", "FAULT", "STOPPED"]
    fault: Fault | None = None
    cause: str | None = None


class EventReader:
    """Reads the events of one connection. `map_by_checksum` are the source maps of the sent
    programs, by checksum."""

    def __init__(self) -> None:
        self.map_by_checksum: dict[int, SourceMap] = {}
        self._shows = ShowFinder(self.map_by_checksum)
        self._began_ms = int(monotonic() * 1000)

    def begin(self, run: int, program: int) -> None:
        """Note that a run begins: its events refer to the text that its program has now."""
        self._shows.begin(run, program)

    def to_robot_event(self, time_ms: int, event: Event) -> RobotEvent | None:
        """Return an event as data, or None for an internal event of the link."""
        fields: dict[str, Value] = {}
        if event.name == "SHOW":
            fields = {"value": value_of(event.value, bool(event.is_yes_no))}
            show = self._shows.show_of(event)
            if show is not None:
                fields |= {"name": show.text, "line": show.line, "column": show.column}
        elif event.name == "STARTED":
            fields = {"checksum": event.program}
        elif event.name == "FAULT":
            fields = self._fault_values(event)
        elif event.name == "STOPPED":
            fields = {"cause": cause_name(event.cause)}
        elif event.name == "MISSED":
            fields = {"count": event.count}
        elif event.name == "TEXT":
            fields = {"text": printable(event.text.decode("utf-8", "replace"))}
        elif event.name != "DONE":
            return None
        return RobotEvent(time_ms - self._began_ms, event.name, fields)

    def _fault_values(self, event: FaultEvent) -> dict[str, Value]:
        program_map = self._shows.map_of(event.run, event.program)
        fault = fault_of(fault_name(event.fault), event.offset, program_map)
        values: dict[str, Value] = {"fault": fault.name, "offset": event.offset}
        if fault.line is not None and fault.column is not None:
            values |= {"line": fault.line, "column": fault.column}
        return values


def ending_of(event: RobotEvent) -> Ending:
    """Return the ending that an event reports."""
    values = event.values
    if event.name == FAULT:
        line, column = values.get("line"), values.get("column")
        position = (None, None) if line is None or column is None else (int(line), int(column))
        return Ending("FAULT", Fault(str(values["fault"]), int(values["offset"]), *position))
    if event.name == DONE:
        return Ending("DONE")
    return Ending("STOPPED", cause=str(values["cause"]))
