"""The events of a session, and the outcomes that the session itself produces.

All listeners share these, also those in another process. An event is identified by its type or its
`name`.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

from tiniscript.link.payloads import (
    EVENTS,
    DoneEvent,
    FaultEvent,
    ShowEvent,
    StatusReply,
    StoppedEvent,
)

# Outcomes that the session produces. UNKEPT: of a key; UNPROVEN: whoever answers does not seal, and
# our key says that the robot does.
LOST, CANCELLED, UNKEPT, UNPROVEN = -1, -2, -3, -4
LOOK_S = 0.1  # between two checks for events: Windows handles Ctrl-C only then


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
    """The line returns what is sent."""

    name: Literal["ECHO"] = "ECHO"


class EndedEvent(NamedTuple):
    """The program has ended, but the event that says how did not arrive."""

    status: StatusReply
    name: Literal["ENDED"] = "ENDED"


class RestartedEvent(NamedTuple):
    """The robot was reset while a run of ours went on."""

    name: Literal["RESTARTED"] = "RESTARTED"


class StartedEvent(NamedTuple):
    """A run has begun; another client of the line may have started it."""

    run: int
    program: int
    name: Literal["STARTED"] = "STARTED"


class PlaceEvent(NamedTuple):
    """The program is at another place: byte `at` of its code, or -1 when nothing runs any more.

    `program` is the checksum of its image.
    """

    run: int
    program: int
    at: int
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
    ShowEvent
    | FaultEvent
    | StoppedEvent
    | DoneEvent
    | TextEvent
    | MissedEvent
    | LostEvent
    | EchoEvent
    | EndedEvent
    | RestartedEvent
    | StartedEvent
    | PlaceEvent
    | JoinedEvent
    | LeftEvent
)
OWN_EVENTS: dict[str, type[Event]] = {
    "TEXT": TextEvent,
    "MISSED": MissedEvent,
    "LOST": LostEvent,
    "ECHO": EchoEvent,
    "RESTARTED": RestartedEvent,
    "STARTED": StartedEvent,
    "PLACE": PlaceEvent,
    "JOINED": JoinedEvent,
    "LEFT": LeftEvent,
}
ALL_EVENTS: dict[str, type[Event]] = {**EVENTS, **OWN_EVENTS}


class Gone(Exception):
    """The connection to the robot has ended; `why` is what the system says.

    `is_server`: the command that held the port has ended. Otherwise the port is gone.
    """

    def __init__(self, why: str = "", is_server: bool = False) -> None:
        super().__init__(why)
        self.why = why
        self.is_server = is_server
