"""A session on a port: a thread of its own reads, writes and keeps the time.

So the heartbeat goes on while the program waits for a person. Knows the clock and when to read;
what is said, `session` knows, and what a port is, `ports`.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from contextlib import suppress
from threading import Condition, Thread
from time import monotonic

import serial

from tiniscript.link.errands import Reply
from tiniscript.link.session import Event, Session, Task

LOOK_S = 0.1  # between two looks at what has come: Windows lets Ctrl-C through only then


class Gone(Exception):
    """The port is not there any more; `why` is what the system says."""

    def __init__(self, why: str) -> None:
        super().__init__(why)
        self.why = why


def now_ms() -> int:
    return int(monotonic() * 1000)


class Line:
    """An open port and the session on it; all methods are for the thread that has made it."""

    def __init__(self, port: serial.SerialBase, session: Session) -> None:
        self.session = session
        self.heard = 0  # bytes
        self.seen: set[str] = set()  # names of all events
        self._port = port
        self._news = Condition()
        self._events: deque[tuple[int, Event]] = deque()
        self._gone: str | None = None
        self._is_closing = False
        self._thread = Thread(target=self._run, name="link", daemon=True)
        self._thread.start()

    def do(self, make: Callable[[Session], Task]) -> Task:
        """Have something done; it is under way when this returns."""
        with self._news:
            task = make(self.session)
        self._wake()
        return task

    def wait(self, task: Task, look: Callable[[], None] | None = None) -> Reply:
        """Wait for the outcome of a task, and call `look` now and then. Raises Gone."""
        while True:
            with self._news:
                if task.outcome is None and self._gone is None:
                    self._news.wait(LOOK_S)
                if task.outcome is not None:
                    return task.outcome
                if self._gone is not None:
                    raise Gone(self._gone)
            if look is not None:
                look()

    def ask(self, make: Callable[[Session], Task]) -> Reply:
        return self.wait(self.do(make))

    def event(self, limit_s: float = LOOK_S) -> tuple[int, Event] | None:
        """Return the next event and when it came, or None where none comes. Raises Gone."""
        with self._news:
            if not self._events and self._gone is None:
                self._news.wait(limit_s)
            if self._events:
                return self._events.popleft()
            if self._gone is not None:
                raise Gone(self._gone)
        return None

    def stop(self) -> None:
        """Stop the robot. STOPPED is among the events when it has confirmed."""
        with self._news:
            self.session.stop(now_ms())
        self._wake()

    def close(self) -> None:
        with self._news:
            self._is_closing = True
        self._wake()
        self._thread.join(2 * LOOK_S)
        with suppress(OSError):  # it is gone already
            self._port.close()

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
            with self._news:
                self._gone = str(why)
                self._news.notify_all()

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
        time_ms = now_ms()
        for event in self.session.events():
            self.seen.add(event.name)
            self._events.append((time_ms, event))
        self._news.notify_all()
