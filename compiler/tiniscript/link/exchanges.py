"""The exchange that is under way, those that wait for it, and what ends them.

Knows no byte and no time: `session` sends and receives.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any, TypeVar

from tiniscript.link.authority import KeyRing
from tiniscript.link.messages import STATUSES
from tiniscript.link.outcomes import LOST, Event, LostEvent, StartedEvent
from tiniscript.link.payloads import ReceiptReply
from tiniscript.link.requests import OK, Exchange, Reply
from tiniscript.link.session_requests import PendingExchange, SessionRequests
from tiniscript.link.transmission import Transmission

_BUSY = STATUSES["BUSY"]
T = TypeVar("T")


class Exchanges(SessionRequests):
    """The part of a session that has exchanges wait and end. `epoch` returns the robot's."""

    def __init__(
        self,
        nonce: int,
        baud: int,
        kit: int,
        isa: tuple[int, int],
        keys: KeyRing | None,
        epoch: Callable[[], int],
    ) -> None:
        super().__init__(nonce, kit, isa, keys, epoch)
        self.tells_starts = False  # STARTED events are wanted
        self._events: list[Event] = []
        self._waiting: deque[PendingExchange[Any]] = deque()
        self._pending: PendingExchange[Any] | None = None
        self._transmission = Transmission(baud)

    def _add(self, exchange: Exchange[T], starts: bool = False) -> PendingExchange[T]:
        pending = PendingExchange(exchange, starts=starts)
        self._waiting.append(pending)
        return pending

    def _finish(self, pending: PendingExchange[Any], outcome: Reply[Any]) -> None:
        pending.outcome = outcome
        if not pending.starts or outcome.status != OK:
            return
        receipt: ReceiptReply = outcome.values
        if self.tells_starts:
            self._events.append(StartedEvent(receipt.run, receipt.program))
        self._state.begin(receipt.run)

    def _lose(self) -> None:
        """Give up: the robot does not answer, or is busy."""
        pending, self._pending = self._pending, None
        assert pending
        if pending.resumes is not None:
            pending = pending.resumes.pending
        # a robot that answers, but is busy for too long, is not lost
        is_busy = pending.is_busy and self._transmission.tries <= 1
        self._transmission.end()
        pending.outcome = Reply(_BUSY if is_busy else LOST)
        if pending.is_own:
            self._close()

    def _close(self) -> None:
        self._cancel(LOST)
        self._lost()

    def _lost(self) -> None:
        self._handshake.is_open = False
        self._state.clear()
        self._events.append(LostEvent())

    def _cancel(self, status: int) -> None:
        if self._pending:
            resumes = self._pending.resumes
            (resumes.pending if resumes else self._pending).outcome = Reply(status)
        self._pending = None
        self._transmission.end()
        self._cancel_waiting(status)

    def _cancel_waiting(self, status: int) -> None:
        for pending in self._waiting:
            pending.outcome = Reply(status)
        self._waiting.clear()
