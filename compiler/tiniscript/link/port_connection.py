"""A session on a port: a separate thread reads, writes and keeps the time.

So the heartbeat continues while the program waits for a person. Knows the clock and when to read;
`session` knows the messages, and `ports` opens ports.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from threading import RLock, Thread
from time import monotonic
from typing import IO, Any, TypeVar

import serial

from tiniscript.base.bell import Bell
from tiniscript.link.connection import LinkConnection, PendingRequest, Requester
from tiniscript.link.outcomes import POLL_INTERVAL_S, Backlog, ConnectionLost, Event, TimedEvent
from tiniscript.link.requests import DeviceInfo, Reply
from tiniscript.link.session import Session
from tiniscript.link.transports import Port

T = TypeVar("T")

READ_BYTES = 1024  # bytes read at a time


def now_ms() -> int:
    return int(monotonic() * 1000)


class PortConnection(LinkConnection):
    """An open port and the session on it.

    Call `event` and `close` only from the thread that made it; any thread may call the rest.
    """

    def __init__(
        self,
        port: Port,
        session: Session,
        lock: IO[bytes] | None = None,
        address: str = "",
    ) -> None:
        """`lock` is closed after the port. `address` is the port's, where it has a name, too.

        A port may have a clock of its own, `now_ms`: that of a simulation.
        """
        self.session = session
        self.address = address
        session.tells_starts = True  # other clients may share the line
        self._port = port
        self._now_ms: Callable[[], int] = getattr(port, "now_ms", now_ms)
        self._port_lock = lock
        self._session_lock = RLock()  # guards the session and the fields below
        self._bell = Bell()
        self._events = Backlog()
        self._pending_requests: list[PendingRequest[Any]] = []
        self._listener: Callable[[list[TimedEvent]], None] | None = None
        self._end_reason: str | None = None
        self._bug: Exception | None = None
        self._takes_places = False
        self._is_closing = False
        self._thread = Thread(target=self._run, name="link", daemon=True)
        self._thread.start()

    @property
    def robot(self) -> DeviceInfo | None:
        return self.session.robot

    @property
    def end_reason(self) -> str | None:
        """Return the reason why the port is gone, or None while it is open."""
        return self._end_reason

    @property
    def has_ended(self) -> bool:
        return self._end_reason is not None

    def begin(self, make_request: Callable[[Requester], PendingRequest[T]]) -> PendingRequest[T]:
        with self._session_lock:
            request = make_request(self.session)
            self._pending_requests.append(request)
        self._wake()
        return request

    def wait(self, request: PendingRequest[T], look: Callable[[], None] | None = None) -> Reply[T]:
        while True:
            with self._session_lock:
                if request.outcome is not None:
                    return request.outcome
                if self._end_reason is not None:
                    raise self._bug or ConnectionLost(self._end_reason)
            self._bell.wait(POLL_INTERVAL_S)
            if look is not None:
                look()

    def event(self, timeout_s: float = POLL_INTERVAL_S) -> TimedEvent | None:
        if not self._events and self._end_reason is None:
            self._bell.wait(timeout_s)
        with self._session_lock:
            if self._events:
                return self._events.take_event()
            if self._end_reason is not None:
                raise self._bug or ConnectionLost(self._end_reason)
        return None

    def stop(self) -> int:
        with self._session_lock:
            began_ms = self._now_ms()
            self.session.stop(began_ms)
        self._wake()
        return began_ms

    def end_run(self, run: int) -> None:
        """End a run whose client has left; requests of others continue."""
        with self._session_lock:
            self.session.end_run(run, self._now_ms())
        self._wake()

    def withdraw(self, request: PendingRequest[Any]) -> None:
        """Abandon a request whose client has left."""
        with self._session_lock:
            self.session.withdraw(request)

    def enable_place_events(self) -> None:
        self._takes_places = self.session.tells_places = True

    def post_event(self, event: Event) -> None:
        """Add an event of this process to those that `event` returns."""
        with self._session_lock:
            self._events.add_events([(self._now_ms(), event)])
            self._bell.ring()

    def fail(self, bug: Exception) -> None:
        """End the line because of a bug of ours, which is passed to the waiting caller."""
        self._bug = bug
        self._end(str(bug))

    def listen(self, listener: Callable[[list[TimedEvent]], None]) -> None:
        """Call `listener` with new events, and when a request is over or the port is lost.

        The line's thread makes the call, and is blocked until it returns.
        """
        with self._session_lock:
            self._listener = listener

    def runs(self, run: int) -> bool:
        """Return whether a run that was started here is still running."""
        with self._session_lock:
            return self.session.is_running and self.session.run == run

    def close(self) -> None:
        with self._session_lock:
            self._is_closing = True
        self._wake()
        self._thread.join(2 * POLL_INTERVAL_S)
        with suppress(OSError):  # the port is lost already
            self._port.close()
        if self._port_lock is not None:
            self._port_lock.close()

    # -- the thread -------------------------------------------------------------------------------

    def _wake(self) -> None:
        """Interrupt a waiting read, if the system can; without this it ends within READ_S."""
        cancel = getattr(self._port, "cancel_read", None)
        if cancel is not None:
            with suppress(OSError, TypeError):  # the port is lost
                cancel()

    def _run(self) -> None:
        try:
            while not self._is_closing:
                with self._session_lock:
                    data = self.session.poll(self._now_ms())
                    self._notify()
                if data:
                    self._write(data)
                new_bytes = self._read()
                if new_bytes:
                    with self._session_lock:
                        self.note_heard(new_bytes)
                        self.session.receive(new_bytes, self._now_ms())
                        self._notify()
        except (OSError, TypeError) as error:  # TypeError: from pyserial, if the port is closed
            self._end(str(error))
        except Exception as bug:
            self.fail(bug)

    def _end(self, reason: str) -> None:
        with self._session_lock:
            self._end_reason = reason
            self._bell.ring()
            if self._listener is not None:
                self._listener([])

    def _read(self) -> bytes:
        """Wait for a byte and return it with those after it: a socket of pyserial reports only
        one."""
        data = bytes(self._port.read(1))
        with suppress(OSError):  # the port is lost: the next read reports it, after its last bytes
            while 0 < len(data) < READ_BYTES and (waiting_count := self._port.in_waiting):
                data += self._port.read(waiting_count)
        return data

    def _write(self, data: bytes) -> None:
        with suppress(serial.SerialTimeoutException):  # counts as lost: the session sends it again
            self._port.write(data)

    def _notify(self) -> None:
        """Pass events and outcomes on to the waiting thread and to the listener."""
        time_ms = self._now_ms()
        timed_events = [(time_ms, event) for event in self.session.events()]
        finished_requests = [
            request for request in self._pending_requests if request.outcome is not None
        ]
        if finished_requests:
            self._pending_requests = [
                request for request in self._pending_requests if request.outcome is None
            ]
        self.is_echoed = self.is_echoed or any(event.name == "ECHO" for _, event in timed_events)
        queued_events = [
            timed_event
            for timed_event in timed_events
            if self._takes_places or timed_event[1].name != "PLACE"
        ]
        self._events.add_events(queued_events)
        self._bell.ring()
        if self._listener is not None and (timed_events or finished_requests):
            self._listener(timed_events)
