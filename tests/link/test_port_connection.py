"""The thread of a line passes on all that it hears and is told, whatever came before, and however
the line ends.

Its port waits until there are bytes or somebody wakes it, and its session does what the test says.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from functools import partial
from io import BytesIO
from random import Random
from threading import Condition, Thread
from types import SimpleNamespace
from typing import Any, cast

import pytest
import serial

from tests.support.waiting import until
from tiniscript.link.outcomes import (
    ConnectionLost,
    EchoEvent,
    Event,
    PlaceEvent,
    StartedEvent,
    TextEvent,
    TimedEvent,
)
from tiniscript.link.port_connection import PortConnection
from tiniscript.link.session import Session


class Port:
    """A port at which a read lasts until there are bytes, somebody cancels it, or the port ends."""

    def __init__(self) -> None:
        self._condition = Condition()
        self._data = b""
        self._is_cancelled = False
        self._end_reason = ""
        self.is_closed = False
        self.written = b""
        self.write_failures: list[Exception] = []

    def bring(self, data: bytes) -> None:
        with self._condition:
            self._data += data
            self._condition.notify()

    def end(self, reason: str) -> None:
        with self._condition:
            self._end_reason = reason
            self._condition.notify()

    def read(self, size: int) -> bytes:
        with self._condition:
            self._condition.wait_for(lambda: self._data or self._is_cancelled or self._end_reason)
            self._is_cancelled = False
            data, self._data = self._data[:size], self._data[size:]
            if self._end_reason and not data:
                raise OSError(self._end_reason)
            return data

    @property
    def in_waiting(self) -> int:
        if self._end_reason:
            raise OSError(self._end_reason)
        return len(self._data)

    def write(self, data: bytes) -> None:
        if self.write_failures:
            raise self.write_failures.pop()
        self.written += data

    def cancel_read(self) -> None:
        with self._condition:
            self._is_cancelled = True
            self._condition.notify()

    def close(self) -> None:
        self.is_closed = True
        self.end("closed")


class FakeSession:
    """What a line needs of a session. It echoes requests and stops, and `bug` may be raised."""

    robot = None
    tells_starts = tells_places = False

    def __init__(self) -> None:
        self.received = b""
        self.poll_count = 0
        self.waiting_events: list[Event] = []
        self.bug: Exception | None = None
        self._data_to_send = b""

    def ask(self, data: bytes) -> Any:
        self._data_to_send += data
        return SimpleNamespace(outcome=None)

    def stop(self, now_ms: int) -> None:
        self._data_to_send += b"stop "

    def end_run(self, run: int, now_ms: int) -> None:
        self._data_to_send += b"end "

    def poll(self, now_ms: int) -> bytes:
        self.poll_count += 1
        if self.bug is not None:
            raise self.bug
        data, self._data_to_send = self._data_to_send, b""
        return data

    def receive(self, data: bytes, now_ms: int) -> None:
        self.received += data

    def events(self) -> list[Event]:
        events, self.waiting_events = self.waiting_events, []
        return events


class Lock(BytesIO):
    """The lock of a port: it notes whether the port was closed before it."""

    def __init__(self, port: Port) -> None:
        super().__init__()
        self.was_port_closed = False
        self._port = port

    def close(self) -> None:
        self.was_port_closed = self._port.is_closed
        super().close()


class Line:
    def __init__(self) -> None:
        self.port, self.session = Port(), FakeSession()
        self.lock = Lock(self.port)
        self.connection = PortConnection(
            cast(Any, self.port), cast(Session, self.session), self.lock
        )
        self.heard: list[list[TimedEvent]] = []

    def listen(self) -> None:
        self.connection.listen(self.heard.append)

    def begin(self, data: bytes = b"ask ") -> Any:
        return self.connection.begin(lambda session: cast(FakeSession, session).ask(data))

    def wait_for_poll(self, count: int) -> None:
        until(lambda: self.session.poll_count > count, "the session is looked at once more")

    def wait_for_write(self, written: bytes) -> None:
        until(lambda: self.port.written > written, "more is sent")

    def wait_for_bytes(self, count: int) -> None:
        """Wait until so many were received, and the events after them are passed on."""
        until(lambda: len(self.session.received) >= count, "it has heard them")
        with self.connection._session_lock:
            pass

    def wait_for_event(self) -> None:
        while self.connection.event(1000) is None:
            pass

    def close(self) -> None:
        self.connection.close()


def test_what_is_asked_is_sent_while_nothing_arrives() -> None:
    """A read that lasts is interrupted, and a write that has lasted too long ends nothing."""
    with closing(Line()) as line:
        for k in range(12):
            does: Callable[[], object] = (
                line.begin, line.connection.stop, partial(line.connection.end_run, 1)
            )[k % 3]  # fmt: skip
            poll_count, written = line.session.poll_count, line.port.written
            is_late = k % 4 == 3
            line.port.write_failures = [serial.SerialTimeoutException("late")] * is_late
            does()
            line.wait_for_poll(poll_count)
            if not is_late:
                line.wait_for_write(written)
        line.port.bring(b"answer")
        until(lambda: line.session.received == b"answer", "it still hears")


@pytest.mark.parametrize("seed", range(20))
def test_each_event_and_each_end_of_a_request_is_told_once(seed: int) -> None:
    """They come in their order, those of places alone to who wants them; what has come before the
    line is lost is read before that is said."""
    rng = Random(seed)
    with closing(Line()) as line:
        line.listen()
        requests: list[Any] = []
        expected_calls: list[list[Event]] = []
        expected_events: list[Event] = []
        takes_places = is_echoed = False
        for k in range(12):
            events: list[Event] = [
                rng.choice(
                    (TextEvent(bytes((k, j))), StartedEvent(k, j), PlaceEvent(k, k, j), EchoEvent())
                )
                for j in range(rng.choice((0, 0, 1, 3)))
            ]
            if rng.random() < 0.1:
                line.connection.enable_place_events()
                takes_places = True
            if rng.random() < 0.4:
                requests.append(line.begin())
            with line.connection._session_lock:
                line.session.waiting_events += events
                ended = [request for request in requests if rng.random() < 0.3]
                for request in ended:
                    request.outcome = "done"
                requests = [request for request in requests if request not in ended]
            line.port.bring(b"x")
            line.wait_for_bytes(k + 1)
            if events or ended:
                expected_calls.append(events)
            for event in events:
                if event.name == "PLACE":
                    if not takes_places:
                        continue
                    expected_events = [one for one in expected_events if one.name != "PLACE"]
                expected_events.append(event)
            is_echoed = is_echoed or any(event.name == "ECHO" for event in events)
            assert line.connection.is_echoed == is_echoed
        until(lambda: len(line.heard) >= len(expected_calls), "the listener has heard it")
        assert [[event for _, event in call] for call in line.heard] == expected_calls
        line.port.bring(b"last")
        line.port.end("pulled out")
        until(lambda: line.connection.has_ended, "the line is lost")
        line.wait_for_bytes(len(b"x" * 12 + b"last"))
        assert line.session.received == b"x" * 12 + b"last"
        assert line.heard[len(expected_calls) :] == [[]], "the listener hears of the end"
        found_events = []
        with pytest.raises(ConnectionLost, match="pulled out"):
            while True:
                timed_event = line.connection.event(0)
                found_events += [] if timed_event is None else [timed_event[1]]
        assert found_events == expected_events


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("end", ["the port", "a write", "a bug"])
def test_whoever_waits_hears_why_a_line_has_ended(end: str, seed: int) -> None:
    """So does who asks later, and the lock is free after the port."""
    bug = ValueError("a bug")
    with closing(Line()) as line:
        line.listen()
        failures: list[Exception] = []

        def note_failure(ask: Callable[[], object]) -> None:
            with pytest.raises(Exception) as failure:
                ask()
            failures.append(failure.value)

        request = line.begin()
        asks = partial(line.connection.wait, request), line.wait_for_event
        waiter = Thread(target=note_failure, args=(asks[seed % 2],))
        waiter.start()
        match end:
            case "the port":
                line.port.end("the port")
            case "a write":
                line.port.write_failures = [OSError("a write")]
                line.begin()
            case "a bug":
                line.session.bug = bug
                line.begin()
        waiter.join(100)
        for ask in asks:
            note_failure(ask)
        assert [str(failure) for failure in failures] == [end] * 3
        assert all(failure is bug for failure in failures) == (end == "a bug")
        assert line.heard == [[]]
    assert line.lock.closed and line.lock.was_port_closed
    until(lambda: not line.connection._thread.is_alive(), "its thread ends")
