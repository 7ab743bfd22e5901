"""Whose run goes on: it is stopped when its command has left, in whatever order that is noticed."""

from __future__ import annotations

from collections import deque
from typing import cast

import pytest

from tests.support.link_events import event
from tiniscript.library import opening
from tiniscript.library.client import Client
from tiniscript.link.connection import LinkConnection, PendingRequest
from tiniscript.link.line import Line
from tiniscript.link.payloads import DoneEvent, ReceiptReply
from tiniscript.link.requests import OK, Reply
from tiniscript.link.sharing.server import ConnectedClient, ServedRequest, Server


class FakeLine:
    """A line on which a run goes on, or none."""

    has_ended = False

    def __init__(self) -> None:
        self.is_running = True
        self.is_closed = False

    def runs(self, run: int) -> bool:
        return self.is_running and run == 7

    def close(self) -> None:
        self.is_closed = True


@pytest.mark.parametrize("end", ["STOPPED", "ENDED", "DONE"])
def test_an_end_that_is_told_late_takes_no_owner_from_the_next_run(end: str) -> None:
    """A stop, and an upload right after it: the server's thread may see both at once."""
    server, line = Server.__new__(Server), FakeLine()
    server._line, server._clients = cast(Line, line), []
    server._owner = cast(ConnectedClient, object()), 7
    server._told = deque([(0, DoneEvent(6) if end == "DONE" else event(end))])
    server._pass_on_events()
    assert server.has_run
    line.is_running = False
    server._told.append((0, DoneEvent(7) if end == "DONE" else event(end)))
    server._pass_on_events()
    assert server._owner is None


def test_a_run_that_begins_while_its_server_leaves_is_stopped(
    monkeypatch: pytest.MonkeyPatch
) -> None:  # fmt: skip
    """Two uploads at once: the first is replaced by its own client, and leaves."""

    class FakeServer:
        may_have_run = False

        def close(self) -> None:
            self.may_have_run = True  # known only now

    stopped: list[object] = []
    monkeypatch.setattr(opening, "confirmed", lambda line, limit_s: stopped.append(line))
    client, line = Client.__new__(Client), FakeLine()
    client.line, client.server = cast(LinkConnection, line), cast(Server, FakeServer())
    client.close()
    assert stopped == [line]
    assert line.is_closed


def test_a_run_that_is_about_to_begin_counts_when_its_server_leaves() -> None:
    server, line = Server.__new__(Server), FakeLine()
    server._line, server._owner = cast(Line, line), None
    server._clients, server._detached_requests = [], []
    assert not server.may_have_run
    for starts, is_detached, outcome, counts in (
        (True, False, None, True), (False, False, None, False), (True, True, None, False),
        (True, False, Reply(OK), False),
    ):  # fmt: skip
        asked: PendingRequest[ReceiptReply] = PendingRequest(starts=starts)
        asked.outcome = outcome
        server._detached_requests = [ServedRequest(asked, is_detached)]
        assert server.may_have_run == counts
        assert not server.has_run
