"""Events that nobody has taken yet: as many as are of use, however long nobody comes.

Whoever waits for a person, or writes into a pipe that nobody reads, does not look meanwhile, and a
device that chatters does not stop.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable

from tiniscript.link.outcomes import Event

KEPT = 500  # events
MAY_MISS = ("SHOW", "TEXT", "ECHO")  # the others say what the robot does

Told = tuple[int, Event]  # when it came (ms), and what


class Backlog:
    """Where it is full, the oldest one goes that may be missed, else the oldest of all. MISSED
    says how many went, before what is left."""

    def __init__(self) -> None:
        self._events: deque[Told] = deque()
        self._missed = 0

    def __len__(self) -> int:
        return len(self._events) + (self._missed > 0)

    def put(self, told: Iterable[Told]) -> None:
        for each in told:
            self._events.append(each)
            if len(self._events) > KEPT:
                self._drop()

    def take(self) -> Told:
        """Return the next event. Raises IndexError where there is none."""
        if self._missed:
            event = Event("MISSED", {"count": self._missed})
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
