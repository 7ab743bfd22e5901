"""How a run ends: what the events of a connection say of it.

The command and the connections of the library both use it.
"""

from __future__ import annotations

from typing import NamedTuple

from tiniscript.library.errors import RobotError
from tiniscript.link.messages import FIRST_LINK_FAULT, STATE_FAULTED, STATE_IDLE
from tiniscript.link.outcomes import Event

DONE, FAULT, STOPPED = "DONE", "FAULT", "STOPPED"


class End(NamedTuple):
    """`name` is DONE, FAULT or STOPPED; `fault` is the number of a fault."""

    name: str
    fault: int | None = None

    @property
    def is_the_programs(self) -> bool:
        """Whether the program has ended itself, if only by a fault."""
        return self.name == DONE or (self.fault is not None and self.fault < FIRST_LINK_FAULT)


class Follower:
    """Looks for the end of a run among events. A run of None is any."""

    def __init__(self, run: int | None) -> None:
        self.run = run
        self.has_begun = run is None  # what comes before was about another run

    def is_about(self, event: Event, port: str, language: str = "en") -> bool:
        """Whether an event may be about the run. Raises RobotError where it is not followed any
        more: the robot is lost, or has another program."""
        if event.name == "LOST":
            raise RobotError("link_lost", language, {"port": port})
        if event.name == "STARTED" and self.run is not None:
            is_it = event.values["run"] == self.run
            if self.has_begun and not is_it:
                raise RobotError("replaced", language, {"port": port})
            self.has_begun = self.has_begun or is_it
        return self.has_begun or event.name not in ("STOPPED", "ENDED")

    def end(self, event: Event) -> End | None:
        return end_of(event, self.run)


def end_of(event: Event, run: int | None) -> End | None:
    """Return how a run has ended where an event ends it, else None. A `run` of None is any."""
    name, values = event
    if name in ("DONE", "FAULT") and run in (None, values["run"]):
        return End(name, _number(event, "fault") if name == "FAULT" else None)
    if name == "STOPPED":
        return End(STOPPED)
    if name == "ENDED":
        state = _number(event, "state")
        if state == STATE_FAULTED:
            return End(FAULT, _number(event, "fault"))
        return End(DONE if state == STATE_IDLE else STOPPED)
    return None


def _number(event: Event, name: str) -> int:
    value = event.values[name]
    assert isinstance(value, int)
    return value
