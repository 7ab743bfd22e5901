"""Turns the events of the link into data for users of the library, and says how a run ends."""

from __future__ import annotations

from collections.abc import Mapping
from time import monotonic
from typing import Literal, NamedTuple

from tiniscript.bytecode.opcodes import FAULTS
from tiniscript.codegen import source_map
from tiniscript.codegen.source_map import Map
from tiniscript.library.errors import RobotError
from tiniscript.library.runs import Fault, Value, fault_of, value_of
from tiniscript.link.messages import (
    CAUSES,
    FIRST_LINK_FAULT,
    LINK_FAULTS,
    STATE_FAULTED,
    STATE_IDLE,
    STATES,
)
from tiniscript.link.outcomes import Event
from tiniscript.link.payloads import DoneEvent, FaultEvent, StatusReply
from tiniscript.source import printable

DONE, FAULT, STOPPED = "DONE", "FAULT", "STOPPED"


class End(NamedTuple):
    """`name` is DONE, FAULT or STOPPED; `fault` is the number of a fault."""

    name: str
    fault: int | None = None

    @property
    def is_the_programs(self) -> bool:
        """Whether the program has ended by itself, by a fault of its own too."""
        return self.name == DONE or (self.fault is not None and self.fault < FIRST_LINK_FAULT)


class Follower:
    """Finds the end of a run among events. `run` None matches any run."""

    def __init__(self, run: int | None) -> None:
        self.run = run
        self.has_begun = run is None  # earlier events are of another run

    def is_about(self, event: Event, port: str, language: str = "en") -> bool:
        """Whether an event may be about the run. Raises RobotError if the robot is lost or has
        another program."""
        if event.name == "LOST":
            raise RobotError("link_lost", language, {"port": port})
        if event.name == "RESTARTED":
            raise RobotError("restarted", language, {"port": port})
        if event.name == "STARTED" and self.run is not None:
            is_it = event.run == self.run
            if self.has_begun and not is_it:
                raise RobotError("replaced", language, {"port": port})
            self.has_begun = self.has_begun or is_it
        return self.has_begun or event.name not in ("STOPPED", "ENDED")

    def end(self, event: Event) -> End | None:
        return end_of(event, self.run)


def end_of(event: Event, run: int | None) -> End | None:
    """Return the end of a run if an event is its end, else None. `run` None matches any run."""
    if isinstance(event, DoneEvent) and run in (None, event.run):
        return End(DONE)
    if isinstance(event, FaultEvent) and run in (None, event.run):
        return End(FAULT, event.fault)
    if event.name == "STOPPED":
        return End(STOPPED)
    if event.name == "ENDED":
        if event.status.state == STATE_FAULTED:
            return End(FAULT, event.status.fault)
        return End(DONE if event.status.state == STATE_IDLE else STOPPED)
    return None


class RobotEvent(NamedTuple):
    """An event of a robot, `ms` milliseconds after the connection was made, by the wall clock.

    name      values
    SHOW      value
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
    """How a program has ended. `name` is DONE, FAULT or STOPPED."""

    name: Literal["DONE", "FAULT", "STOPPED"]
    fault: Fault | None = None
    cause: str | None = None


class Reader:
    """Reads the events of one connection. `maps` are the source maps of the sent programs, by
    checksum."""

    def __init__(self) -> None:
        self.maps: dict[int, Map] = {}
        self._began_ms = int(monotonic() * 1000)

    def told(self, time_ms: int, event: Event) -> RobotEvent | None:
        """Return an event as data, or None for an internal event of the link."""
        found: dict[str, Value] = {}
        if event.name == "SHOW":
            found = {"value": value_of(event.value, bool(event.is_yes_no))}
        elif event.name == "STARTED":
            found = {"checksum": event.program}
        elif event.name == "ENDED":
            return self._told_end(time_ms, event.status)
        elif event.name == "FAULT":
            found = self._fault(event.fault, event.at, event.program)
        elif event.name == "STOPPED":
            found = {"cause": CAUSES[event.cause if event.cause < len(CAUSES) else 0][0]}
        elif event.name == "MISSED":
            found = {"count": event.count}
        elif event.name == "TEXT":
            found = {"text": printable(event.text.decode("utf-8", "replace"))}
        elif event.name != "DONE":
            return None
        return RobotEvent(time_ms - self._began_ms, event.name, found)

    def _told_end(self, time_ms: int, status: StatusReply) -> RobotEvent:
        """Return the end of a run for which only the robot's state is known."""
        state, ms = STATES[status.state][0], time_ms - self._began_ms
        if state == "FAULTED":
            fault = self._fault(status.fault, status.fault_at, status.fault_program)
            return RobotEvent(ms, FAULT, fault)
        if state == "IDLE":
            return RobotEvent(ms, DONE, {})
        return RobotEvent(ms, "STOPPED", {"cause": "NONE"})

    def _fault(self, number: int, offset: int, program: int) -> dict[str, Value]:
        names = {each: name for each, name, _ in (*FAULTS, *LINK_FAULTS)}
        places = self.maps.get(program) or source_map.recall(program)
        fault = fault_of(names.get(number, str(number)), offset, places)
        found: dict[str, Value] = {"fault": fault.name, "offset": offset}
        if fault.line is not None and fault.column is not None:
            found |= {"line": fault.line, "column": fault.column}
        return found


def ending_of(event: RobotEvent) -> Ending:
    """Return the ending that an event reports."""
    values = event.values
    if event.name == FAULT:
        line, column = values.get("line"), values.get("column")
        place = (None, None) if line is None or column is None else (int(line), int(column))
        return Ending("FAULT", Fault(str(values["fault"]), int(values["offset"]), *place))
    if event.name == DONE:
        return Ending("DONE")
    return Ending("STOPPED", cause=str(values["cause"]))
