"""The exchanges of a session: the one that is under way, those that wait, and what ends them.

Knows no byte and no time: `session` sends and receives.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple, TypeVar

from tiniscript.link.authority import KeyRing
from tiniscript.link.connection import DEADLINE_MS, PendingRequest, Requester
from tiniscript.link.handshake import EXCHANGES, NEED_NO_HELLO, Handshake, ping
from tiniscript.link.messages import PLACES, STATUSES
from tiniscript.link.outcomes import LOST, Event, LostEvent, StartedEvent
from tiniscript.link.payloads import PingReply, ReceiptReply
from tiniscript.link.requests import OK, DeviceInfo, Exchange, Reply
from tiniscript.link.robot_state import RobotState
from tiniscript.link.transmission import Transmission

_BUSY = STATUSES["BUSY"]
T = TypeVar("T")


class PendingExchange(PendingRequest[T]):
    """An exchange and its timeout, from its first request on."""

    def __init__(
        self,
        exchange: Exchange[T],
        limit_ms: int = DEADLINE_MS,
        starts: bool = False,
        is_own: bool = False,
    ) -> None:
        super().__init__(limit_ms, starts)
        self.exchange = exchange
        self.deadline_ms = 0
        self.is_own = is_own  # made by the session itself
        self.is_busy = False  # the robot's last answer was BUSY
        self.shown = 0  # how often a key was shown again for it
        self.resumes: Interrupted | None = None


class Interrupted(NamedTuple):
    """An exchange whose request goes on when a key was shown again."""

    pending: PendingExchange[Any]
    transmission: Transmission


class Exchanges(Requester):
    """The part of a session that has exchanges wait and end, and says what is known of the robot.

    `epoch` returns the robot's.
    """

    def __init__(
        self,
        nonce: int,
        baud: int,
        kit: int,
        isa: tuple[int, int],
        keys: KeyRing | None,
        epoch: Callable[[], int],
    ) -> None:
        self.tells_places = False  # PLACE events are wanted
        self._state = RobotState()
        self._handshake = Handshake(nonce, kit, isa, self._state, keys, epoch)
        self.tells_starts = False  # STARTED events are wanted
        self._events: list[Event] = []
        self._waiting: deque[PendingExchange[Any]] = deque()
        self._pending: PendingExchange[Any] | None = None
        self._transmission = Transmission(baud)

    @property
    def robot(self) -> DeviceInfo | None:
        """The robot's description of itself, once it has answered HELLO."""
        return self._handshake.robot

    @property
    def is_latched(self) -> bool:
        return self._state.is_latched

    @property
    def is_running(self) -> bool:
        return self._state.is_running

    @property
    def is_open(self) -> bool:
        """Whether the robot has answered HELLO, and has not been lost since."""
        return self._handshake.is_open

    @property
    def run(self) -> int | None:
        """The last run that this session has started."""
        return self._state.run

    def _ask(
        self, name: str, kind: type[T], starts: bool = False, /, **given: object
    ) -> PendingExchange[T]:
        make: Callable[[], Exchange[T]] = partial(EXCHANGES[name], self._handshake, **given)
        if name == "hello":
            exchange = make()
        elif name in NEED_NO_HELLO:
            exchange = self._handshake.with_key(make)
        else:
            exchange = self._handshake.open_then(make)
        return self._add(exchange, starts)

    def _add(self, exchange: Exchange[T], starts: bool = False) -> PendingExchange[T]:
        pending = PendingExchange(exchange, starts=starts)
        self._waiting.append(pending)
        return pending

    def _beat(self) -> Exchange[PingReply]:
        """Ping, and ask where the program is, if that is wanted and the robot tells it."""
        asks = self.tells_places and self.robot and self.robot.values.features & PLACES
        return self._handshake.with_key(lambda: ping(b"\1" if asks else b""))

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
