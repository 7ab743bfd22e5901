"""The end of a run by the events of the link, independent of programs."""

from __future__ import annotations

from typing import NamedTuple

from tiniscript.library.errors import RobotError
from tiniscript.link.messages import FIRST_LINK_FAULT
from tiniscript.link.outcomes import Event
from tiniscript.link.payloads import DoneEvent, FaultEvent

DONE, FAULT, STOPPED = "DONE", "FAULT", "STOPPED"


class End(NamedTuple):
    """`name` is DONE, FAULT or STOPPED; `fault` is the number of a fault."""

    name: str
    fault: int | None = None

    @property
    def was_caused_by_program(self) -> bool:
        """Return whether the program ended by itself, including by a fault of its own."""
        return self.name == DONE or (self.fault is not None and self.fault < FIRST_LINK_FAULT)


class Follower:
    """Finds the end of a run among events. `run` None matches any run."""

    def __init__(self, run: int | None) -> None:
        self.run = run
        self.has_begun = run is None  # earlier events are of another run

    def follow(self, event: Event, port: str, language: str = "en") -> bool:
        """Return whether an event may concern the run. Raises RobotError if the robot is lost or
        has another program.
        """
        if event.name == "LOST":
            raise RobotError("link_lost", language, {"port": port})
        if event.name == "RESTARTED":
            raise RobotError("restarted", language, {"port": port})
        if event.name == "STARTED" and self.run is not None:
            is_own_run = event.run == self.run
            if self.has_begun and not is_own_run:
                raise RobotError("replaced", language, {"port": port})
            self.has_begun = self.has_begun or is_own_run
        return self.has_begun or event.name != "STOPPED"

    def end(self, event: Event) -> End | None:
        return end_of(event, self.run)


def end_of(event: Event, run: int | None) -> End | None:
    """Return the end of a run if this event ends it, else None. `run` None matches any run."""
    if isinstance(event, DoneEvent) and run in (None, event.run):
        return End(DONE)
    if isinstance(event, FaultEvent) and run in (None, event.run):
        return End(FAULT, event.fault)
    return End(STOPPED) if event.name == "STOPPED" else None
