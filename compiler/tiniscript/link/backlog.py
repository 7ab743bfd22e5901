"""A bounded queue of events that have not been taken yet.

The bound is needed because a consumer may block (it waits for a person, or writes into a pipe that
nobody reads) while a device goes on sending.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable

from tiniscript.link.outcomes import Event, MissedEvent

KEPT = 500  # events
MAY_MISS = ("SHOW", "TEXT", "ECHO")  # the others say what the robot does

Told = tuple[int, Event]  # arrival time (ms), event


class Backlog:
    """When it is full, the oldest event of MAY_MISS is dropped, else the oldest of all. MISSED
    comes first and says how many were dropped."""

    def __init__(self) -> None:
        self._events: deque[Told] = deque()
        self._missed = 0

    def __len__(self) -> int:
        return len(self._events) + (self._missed > 0)

    def put(self, told: Iterable[Told]) -> None:
        for each in told:
            if each[1].name == "PLACE":  # the newest one says all
                self._events = deque(one for one in self._events if one[1].name != "PLACE")
            self._events.append(each)
            if len(self._events) > KEPT:
                self._drop()

    def take(self) -> Told:
        """Return the next event. Raises IndexError if there is none."""
        if self._missed:
            event = MissedEvent(self._missed)
            self._missed = 0
            return (self._events[0][0] if self._events else 0), event
        return self._events.popleft()

    def _drop(self) -> None:
        self._missed += 1
        for number, (_, event) in enumerate(self._events):
            if event.name in MAY_MISS:
                del self._events[number]
                return
        self._events.popleft()
