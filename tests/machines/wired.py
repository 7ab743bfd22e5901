"""A computer and the simulated Uno with the real firmware, on one wire."""

from __future__ import annotations

from typing import Any, TypeVar

from tiniscript.link.connection import PendingRequest
from tiniscript.link.requests import OK
from tiniscript.link.session import Session
from tools.uno import CYCLES_PER_MS, Uno

T = TypeVar("T")


class Wired:
    """Lets time pass for both, millisecond by millisecond."""

    def __init__(self, uno: Uno, session: Session) -> None:
        self.uno, self.session = uno, session
        self._seen = len(uno.events)

    @property
    def now_ms(self) -> int:
        return self.uno.cycle // CYCLES_PER_MS

    def run(self, milliseconds: int) -> None:
        for _ in range(milliseconds):
            data = self.session.poll(self.now_ms)
            if data:
                self.uno.send(data)
            self.uno.run_ms(1)
            new_events = self.uno.events[self._seen :]
            self._seen += len(new_events)
            sent_bytes = bytes(event["byte"] for event in new_events if event.kind == "sent")
            self.session.receive(sent_bytes, self.now_ms)

    def until(self, request: PendingRequest[Any], limit_ms: int = 20_000) -> int:
        """Run until a request is over; return how that ended."""
        for _ in range(limit_ms):
            if request.outcome is not None:
                return request.outcome.status
            self.run(1)
        raise AssertionError(f"not over after {limit_ms} ms")

    def complete(self, request: PendingRequest[T]) -> T:
        """Run until the robot has carried out a request; return its answer."""
        assert self.until(request) == OK and request.outcome
        return request.outcome.values
