"""The events of a session, their queue, and the outcomes that the session itself produces.

All listeners share these, also those in another process. An event is identified by its type or its
`name`.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from typing import Literal, NamedTuple, get_args

from tiniscript.link.payloads import (
    DoneEvent,
    FaultEvent,
    HaltedEvent,
    ReadingEvent,
    StoppedEvent,
)

# Outcomes produced by the session. UNKEPT: of a key; UNPROVEN: the other end does not seal, but our
# key's robot does; OTHER_ROBOT: not the robot of our key; its id is the detail.
LOST, CANCELLED, UNKEPT, UNPROVEN, OTHER_ROBOT = -1, -2, -3, -4, -5
DETAIL_MIDWAY = 1  # detail of CANCELLED: it was under way, and the robot may have done it before
POLL_INTERVAL_S = 0.1  # between two checks for events: Windows handles Ctrl-C only then


class ShownEvent(NamedTuple):
    """A program has shown a value, with the SHOW at byte `offset` of its code.

    `program` is the checksum of its image; `offset` is -1 if that is not known.
    """

    value: int
    is_yes_no: int
    run: int = 0
    program: int = 0
    offset: int = -1
    name: Literal["SHOW"] = "SHOW"


class TextEvent(NamedTuple):
    """A line of text has arrived."""

    text: bytes
    name: Literal["TEXT"] = "TEXT"


class MissedEvent(NamedTuple):
    """`count` events did not arrive."""

    count: int  # type: ignore[assignment]  # a tuple has a method of this name
    name: Literal["MISSED"] = "MISSED"


class LostEvent(NamedTuple):
    """The robot no longer answers."""

    name: Literal["LOST"] = "LOST"


class EchoEvent(NamedTuple):
    """The line returns the bytes sent."""

    name: Literal["ECHO"] = "ECHO"


class RestartedEvent(NamedTuple):
    """The robot was reset during one of our runs."""

    name: Literal["RESTARTED"] = "RESTARTED"


class StartedEvent(NamedTuple):
    """A run has begun; another client of the line may have started it."""

    run: int
    program: int
    name: Literal["STARTED"] = "STARTED"


class PlaceEvent(NamedTuple):
    """The program is at another place: byte `offset` of its code, or -1 after the end of the run.

    `program` is the checksum of its image.
    """

    run: int
    program: int
    offset: int
    name: Literal["PLACE"] = "PLACE"


class JoinedEvent(NamedTuple):
    """A client has joined the port: `verb` is its command."""

    verb: bytes
    name: Literal["JOINED"] = "JOINED"


class LeftEvent(NamedTuple):
    """A client has left."""

    verb: bytes
    name: Literal["LEFT"] = "LEFT"


Event = (
    ShownEvent
    | FaultEvent
    | StoppedEvent
    | DoneEvent
    | HaltedEvent
    | ReadingEvent
    | TextEvent
    | MissedEvent
    | LostEvent
    | EchoEvent
    | RestartedEvent
    | StartedEvent
    | PlaceEvent
    | JoinedEvent
    | LeftEvent
)
EVENTS: dict[str, type[Event]] = {
    event_type._field_defaults["name"]: event_type for event_type in get_args(Event)
}


class ConnectionLost(Exception):
    """The connection to the robot has ended; `detail` is the system's message.

    `is_server`: the command that held the port has ended. Otherwise the port is lost.
    """

    def __init__(self, detail: str = "", is_server: bool = False) -> None:
        super().__init__(detail)
        self.detail = detail
        self.is_server = is_server


MAX_EVENTS = 500  # events
DROPPABLE_EVENTS = ("SHOW", "TEXT", "ECHO", "READING")  # the others report the robot's actions

TimedEvent = tuple[int, Event]  # arrival time (ms), event


class Backlog:
    """A queue of events. When it is full, the oldest of DROPPABLE_EVENTS is dropped, or else the
    oldest event. MISSED comes first and counts the dropped ones.
    """

    def __init__(self) -> None:
        self._events: deque[TimedEvent] = deque()
        self._missed_count = 0

    def __len__(self) -> int:
        return len(self._events) + (self._missed_count > 0)

    def add_events(self, timed_events: Iterable[TimedEvent]) -> None:
        for timed_event in timed_events:
            if timed_event[1].name == "PLACE":  # only the newest one matters
                self._events = deque(one for one in self._events if one[1].name != "PLACE")
            self._events.append(timed_event)
            if len(self._events) > MAX_EVENTS:
                self._drop_event()

    def take_event(self) -> TimedEvent:
        """Return the next event. Raises IndexError if there is none."""
        if self._missed_count:
            event = MissedEvent(self._missed_count)
            self._missed_count = 0
            return (self._events[0][0] if self._events else 0), event
        return self._events.popleft()

    def _drop_event(self) -> None:
        self._missed_count += 1
        for index, (_, event) in enumerate(self._events):
            if event.name in DROPPABLE_EVENTS:
                del self._events[index]
                return
        self._events.popleft()
