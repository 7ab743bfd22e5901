"""Events of a robot, for tests that do not depend on their values."""

from __future__ import annotations

from tiniscript.link.outcomes import Event, LostEvent, ShownEvent, StartedEvent
from tiniscript.link.payloads import DoneEvent, FaultEvent, HaltedEvent, ReadingEvent, StoppedEvent

EVENTS: tuple[Event, ...] = (
    ShownEvent(7, 0),
    FaultEvent(1, 2, 0, 0),
    StoppedEvent(1),
    DoneEvent(1),
    HaltedEvent(1, 2, 0),
    ReadingEvent(1, 2, 12_500, 20),
    LostEvent(),
    StartedEvent(1, 1),
)


def event(name: str) -> Event:
    """Return an event of this name."""
    return next(event for event in EVENTS if event.name == name)
