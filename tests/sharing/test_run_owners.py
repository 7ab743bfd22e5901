"""Whose run goes on: it is stopped when its command has left, in whatever order that is noticed."""

from __future__ import annotations

from collections import deque
from typing import cast

import pytest

from tiniscript.cli.robot import run_monitor
from tiniscript.cli.robot.connect import Connection
from tiniscript.link.line import Line
from tiniscript.link.outcomes import Event
from tiniscript.link.requests import OK, Reply, single
from tiniscript.link.session import Task as Asked
from tiniscript.sharing.server import Guest, Host, Task


class FakeLine:
    """A line on which a run goes on, or none."""

    def __init__(self) -> None:
        self.is_running = True
        self.is_closed = False

    def runs(self, run: int) -> bool:
        return self.is_running and run == 7

    def close(self) -> None:
        self.is_closed = True


@pytest.mark.parametrize("end", ["STOPPED", "ENDED", "DONE"])
def test_an_end_that_is_told_late_takes_no_owner_from_the_next_run(end: str) -> None:
    """A stop, and an upload right after it: the holder's thread may see both at once."""
    host, line = Host.__new__(Host), FakeLine()
    host._line, host._guests = cast(Line, line), []
    host._owner = cast(Guest, object()), 7
    host._told = deque([(0, Event(end, {"run": 6} if end == "DONE" else {}))])
    host._pass_on_events()
    assert host.has_run
    line.is_running = False
    host._told.append((0, Event(end, {"run": 7} if end == "DONE" else {})))
    host._pass_on_events()
    assert host._owner is None


def test_a_run_that_begins_while_its_holder_leaves_is_stopped(
    monkeypatch: pytest.MonkeyPatch
) -> None:  # fmt: skip
    """Two uploads at once: the first is replaced by its own guest, and leaves."""

    class FakeHost:
        may_have_run = False

        def close(self) -> None:
            self.may_have_run = True  # known only now

    stopped: list[object] = []
    monkeypatch.setattr(run_monitor, "confirmed", lambda line, limit_s: stopped.append(line))
    connection, line = Connection.__new__(Connection), FakeLine()
    connection.line, connection.host = cast(Line, line), cast(Host, FakeHost())
    connection.company, connection.drives = None, True
    connection.__exit__(None)
    assert stopped == [line]
    assert line.is_closed


def test_a_run_that_is_about_to_begin_counts_when_its_holder_leaves() -> None:
    host, line = Host.__new__(Host), FakeLine()
    host._line, host._guests, host._orphans, host._owner = cast(Line, line), [], [], None
    assert not host.may_have_run
    for starts, is_detached, outcome, counts in (
        (True, False, None, True), (False, False, None, False), (True, True, None, False),
        (True, False, Reply(OK), False),
    ):  # fmt: skip
        asked = Asked(single("START"), starts=starts)
        asked.outcome = outcome
        host._orphans = [Task(asked, is_detached)]
        assert host.may_have_run == counts
        assert not host.has_run
