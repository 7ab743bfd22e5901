"""A session on a port: a thread of its own reads, writes and keeps the time.

So the heartbeat goes on while the program waits for a person. Knows the clock and when to read;
what is said, `session` knows, and what a port is, `ports`.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from threading import Condition, Thread
from time import monotonic
from typing import IO

import serial

from tiniscript.link.backlog import Backlog, Told
from tiniscript.link.connection import Asked, Asks
from tiniscript.link.outcomes import LOOK_S, Event, Gone
from tiniscript.link.requests import Reply, Robot
from tiniscript.link.session import Session


def now_ms() -> int:
    return int(monotonic() * 1000)


class Line:
    """An open port and the session on it.

    `event` and `close` are for the thread that has made it, the rest is for any.
    """

    held_by = ""  # this process

    def __init__(
        self, port: serial.SerialBase, session: Session, lock: IO[bytes] | None = None
    ) -> None:
        """`lock` is closed after the port."""
        self.session = session
        session.tells_starts = True  # others may share the line
        self.heard = 0  # bytes
        self.is_echoed = False
        self._port = port
        self._lock = lock
        self._news = Condition()
        self._events = Backlog()
        self._under_way: list[Asked] = []
        self._listener: Callable[[list[Told]], None] | None = None
        self._gone: str | None = None
        self._bug: Exception | None = None
        self._is_closing = False
        self._thread = Thread(target=self._run, name="link", daemon=True)
        self._thread.start()

    @property
    def robot(self) -> Robot | None:
        return self.session.robot

    @property
    def gone(self) -> str | None:
        """Return why the port is not there any more, or None while it is."""
        return self._gone

    @property
    def has_ended(self) -> bool:
        return self._gone is not None

    def do(self, make: Callable[[Asks], Asked]) -> Asked:
        """Have something done; it is under way when this returns."""
        with self._news:
            task = make(self.session)
            self._under_way.append(task)
        self._wake()
        return task

    def wait(self, task: Asked, look: Callable[[], None] | None = None) -> Reply:
        """Wait for the outcome of a task, and call `look` now and then. Raises Gone."""
        while True:
            with self._news:
                if task.outcome is None and self._gone is None:
                    self._news.wait(LOOK_S)
                if task.outcome is not None:
                    return task.outcome
                if self._gone is not None:
                    raise self._bug or Gone(self._gone)
            if look is not None:
                look()

    def event(self, limit_s: float = LOOK_S) -> Told | None:
        """Return the next event and when it came, or None where none comes. Raises Gone."""
        with self._news:
            if not self._events and self._gone is None:
                self._news.wait(limit_s)
            if self._events:
                return self._events.take()
            if self._gone is not None:
                raise self._bug or Gone(self._gone)
        return None

    def stop(self) -> None:
        """Stop the robot. STOPPED is among the events when it has confirmed."""
        with self._news:
            self.session.stop(now_ms())
        self._wake()

    def tell(self, event: Event) -> None:
        """Add an event of this process to those that `event` returns."""
        with self._news:
            self._events.put([(now_ms(), event)])
            self._news.notify_all()

    def fail(self, bug: Exception) -> None:
        """End the line because of a mistake of ours, which whoever waits here is to hear of."""
        self._bug = bug
        self._end(str(bug))

    def listen(self, listener: Callable[[list[Told]], None]) -> None:
        """Have somebody called with new events, and when a task is over or the port is gone.

        The thread of the line calls it, which waits meanwhile.
        """
        with self._news:
            self._listener = listener

    def runs(self, run: int) -> bool:
        """Whether a run that was started here still goes on."""
        with self._news:
            return self.session.is_running and self.session.run == run

    def close(self) -> None:
        with self._news:
            self._is_closing = True
        self._wake()
        self._thread.join(2 * LOOK_S)
        with suppress(OSError):  # it is gone already
            self._port.close()
        if self._lock is not None:
            self._lock.close()

    def __enter__(self) -> Line:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # -- the thread -------------------------------------------------------------------------------

    def _wake(self) -> None:
        """End a read that waits, where the system can; it ends soon anyway."""
        cancel = getattr(self._port, "cancel_read", None)
        if cancel is not None:
            with suppress(OSError, TypeError):  # it is gone
                cancel()

    def _run(self) -> None:
        try:
            while not self._is_closing:
                with self._news:
                    data = self.session.poll(now_ms())
                    self._tell()
                if data:
                    self._write(data)
                heard = self._read()
                if heard:
                    with self._news:
                        self.heard += len(heard)
                        self.session.receive(heard, now_ms())
                        self._tell()
        except (OSError, TypeError) as why:  # TypeError: pyserial's, where a port is closed
            self._end(str(why))
        except Exception as bug:
            self.fail(bug)

    def _end(self, why: str) -> None:
        with self._news:
            self._gone = why
            self._news.notify_all()
            if self._listener is not None:
                self._listener([])

    def _read(self) -> bytes:
        found = bytes(self._port.read(1))
        if found:
            more = self._port.in_waiting
            if more:
                found += self._port.read(more)
        return found

    def _write(self, data: bytes) -> None:
        with suppress(serial.SerialTimeoutException):  # as if lost on the way: it is sent again
            self._port.write(data)

    def _tell(self) -> None:
        """Pass on what has happened: to who waits here, and to who listens."""
        time_ms = now_ms()
        told = [(time_ms, event) for event in self.session.events()]
        over = [task for task in self._under_way if task.outcome is not None]
        if over:
            self._under_way = [task for task in self._under_way if task.outcome is None]
        self.is_echoed = self.is_echoed or any(event.name == "ECHO" for _, event in told)
        self._events.put(told)
        self._news.notify_all()
        if self._listener is not None and (told or over):
            self._listener(told)
