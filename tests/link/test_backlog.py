"""A device that chatters forever without a reader costs no more than a silent one."""

from __future__ import annotations

import threading
import tracemalloc
from contextlib import closing

import pytest

from tests.support.waiting import until
from tiniscript.link.outcomes import (
    MAX_EVENTS,
    Backlog,
    MissedEvent,
    ShownEvent,
    StartedEvent,
    TimedEvent,
)
from tiniscript.link.payloads import DoneEvent, FaultEvent
from tiniscript.link.port_connection import PortConnection
from tiniscript.link.session import Session

CHATTER = b"debug: the battery has 7.4 V and all is well\r\n" * 20
PIECE_COUNT = 400  # of it, 8,000 lines: half a minute at 115200 baud
MAX_KEPT_BYTES = 500_000  # most bytes kept of these


class Chatterbox:
    """A port at which something talks, as fast as it is heard, and ends."""

    def __init__(self) -> None:
        self.pieces = PIECE_COUNT
        self.unread = b""
        self.is_over = threading.Event()

    @property
    def in_waiting(self) -> int:
        return len(self.unread)

    def read(self, count: int) -> bytes:
        if count == 1:
            self.pieces -= 1
            if self.pieces < 0:
                self.is_over.set()
                self.is_over.wait(0.01)
                return b""
            self.unread = CHATTER[1:]
            return CHATTER[:1]
        data, self.unread = self.unread, b""
        return data

    def write(self, data: bytes) -> int:
        return len(data)

    def close(self) -> None:
        pass


def test_an_unread_line_keeps_few_events() -> None:
    """This happens at the prompt of `tsc live`, and when `tsc monitor` writes into a full pipe."""
    port = Chatterbox()
    tracemalloc.start()
    try:
        line = PortConnection(port, Session(1))
        assert port.is_over.wait(120)
        kept_bytes, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    events = []
    while (row := line.event(0.5)) is not None:
        events.append(row[1])
    line.close()
    assert kept_bytes < MAX_KEPT_BYTES
    assert len(events) <= MAX_EVENTS + 1
    assert events[0].name == "MISSED"
    assert events[0].count + len(events) - 1 == 20 * PIECE_COUNT


class Socket(Chatterbox):
    """Tells of one byte that waits, or of its end, as a socket of pyserial does."""

    def __init__(self) -> None:
        super().__init__()
        self.unread = CHATTER

    @property
    def in_waiting(self) -> int:
        return 1

    def read(self, count: int) -> bytes:
        data, self.unread = self.unread[:count], self.unread[count:]
        if not data:
            raise OSError("socket disconnected")
        return data


def test_all_available_socket_data_is_read_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """With two bytes per turn, a stop waited for seconds after the values. The peer may have sent
    its reason before it closes.
    """
    pieces: list[bytes] = []
    session = Session(1)
    monkeypatch.setattr(session, "receive", lambda data, now_ms: pieces.append(data))
    with closing(PortConnection(Socket(), session)) as line:
        until(lambda: line.has_ended, "the socket is at its end")
    assert (pieces, line.end_reason) == ([CHATTER], "socket disconnected")


def make_shown_event(number: int) -> TimedEvent:
    return number, ShownEvent(number, 0)


def test_state_events_are_kept_in_preference_to_values() -> None:
    backlog = Backlog()
    backlog.add_events([(0, StartedEvent(1, 2)), make_shown_event(0)])
    backlog.add_events(make_shown_event(number) for number in range(1, 10 * MAX_EVENTS))
    backlog.add_events([(0, FaultEvent(1, 2, 3, 4))])
    events = [backlog.take_event()[1] for _ in range(len(backlog))]
    assert [event.name for event in events[:3]] == ["MISSED", "STARTED", "SHOW"]
    assert events[-1].name == "FAULT" and len(events) == MAX_EVENTS + 1
    assert events[-2] == ShownEvent(10 * MAX_EVENTS - 1, 0), "the newest is there"
    assert events[0] == MissedEvent(10 * MAX_EVENTS + 2 - MAX_EVENTS)
    assert len(backlog) == 0


def test_events_that_fit_are_not_missed() -> None:
    backlog = Backlog()
    backlog.add_events(make_shown_event(number) for number in range(MAX_EVENTS))
    assert [backlog.take_event()[0] for _ in range(MAX_EVENTS)] == list(range(MAX_EVENTS))


def test_end_events_alone_are_also_bounded() -> None:
    backlog = Backlog()
    backlog.add_events((number, DoneEvent(number)) for number in range(5 * MAX_EVENTS))
    assert len(backlog) == MAX_EVENTS + 1
