"""A page's view of its robot's runs: which one is its own, and whether it still continues."""

from __future__ import annotations

import random
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any, cast

import pytest

from tests.support.link_events import event
from tiniscript import compile
from tiniscript.link.connection import LinkConnection, PendingRequest, Requester
from tiniscript.link.outcomes import CANCELLED, Event, LostEvent, RestartedEvent, StartedEvent
from tiniscript.link.payloads import DoneEvent, FaultEvent, ReceiptReply
from tiniscript.link.requests import OK, Reply
from tiniscript.studio.robot_link import RobotLink

PROGRAM = 7
LINE = compile("F(1, 50)").image.hex()
ACTIONS = ("ask", "answer", "refuse", "other", "end", "lost", "restart")


class Robot:
    """A connection to a robot scripted by the test, with one run at a time."""

    robot = None
    boot = 1

    def __init__(self) -> None:
        self.events: list[Event] = []
        self.run = 0  # the last one that has begun
        self.runs_own: bool | None = None  # the current run is the page's; None: no run
        self.is_program = False
        self.pending_request: PendingRequest[Any] | None = None

    def enable_place_events(self) -> None:
        """The robot sends none."""

    def begin(
        self, make_request: Callable[[Requester], PendingRequest[Any]]
    ) -> PendingRequest[Any]:
        session = SimpleNamespace(
            start=lambda: PendingRequest[Any](), live=lambda *_: PendingRequest[Any]()
        )
        self.pending_request = make_request(cast(Requester, session))
        self.pending_request.starts_program = True
        return self.pending_request

    def event(self, timeout_s: float) -> tuple[int, Event] | None:
        return (0, self.events.pop(0)) if self.events else None

    def end_run(self, event_name: str) -> None:
        """Report that a run has ended so: the current one or, as a late message, an earlier one."""
        self.runs_own = None
        if event_name == "DONE":
            self.events.append(DoneEvent(self.run))
        elif event_name == "FAULT":
            self.events.append(FaultEvent(self.run, 1, 0, PROGRAM))
        else:
            self.events.append(event("STOPPED") if event_name == "STOPPED" else LostEvent())

    def begin_run(self, is_own: bool, look_at_end: Callable[[], object] | None = None) -> None:
        """A run begins; the answer about its starter may come after its end."""
        self.run += 1
        self.runs_own = is_own
        if look_at_end is not None:
            self.end_run("DONE")
            look_at_end()
        if is_own and self.pending_request is not None:
            fields = {**dict.fromkeys(ReceiptReply._fields, 0), "run": self.run}
            self.pending_request.outcome = Reply(OK, 0, ReceiptReply(**fields))
            self.pending_request = None
        self.events.append(StartedEvent(self.run, PROGRAM))

    def restart(self) -> None:
        if self.runs_own is not None:
            self.events.append(RestartedEvent())
        self.boot, self.run, self.runs_own = self.boot + 1, 0, None


@pytest.mark.parametrize("seed", range(40))
def test_the_run_of_a_page_is_tracked_until_its_end(seed: int) -> None:
    """Earlier runs, whoever started them, and late messages do not matter: its run counts until it
    ends, or another one begins."""
    rng = random.Random(seed)
    robot = Robot()
    link = RobotLink(cast(LinkConnection, robot), "en")
    own_programs, own_runs = set[tuple[int, int]](), 0
    for number in range(120):
        match rng.choice((*ACTIONS, "ask", "answer")):
            case "ask" if robot.pending_request is None:
                robot.is_program = rng.random() < 0.5
                fields = {"do": "start"} if robot.is_program else {"do": "live", "image": LINE}
                link.ask({"id": number, "robot": "tinibot", **fields})
                link.news()
            case "answer" if robot.pending_request is not None:
                if rng.random() < 0.3:
                    robot.end_run(rng.choice(("STOPPED", "DONE")))  # that of the run before
                on_end = rng.choice((lambda: None, link.news))
                robot.begin_run(is_own=True, look_at_end=on_end if rng.random() < 0.3 else None)
                if robot.is_program:
                    own_programs.add((robot.boot, robot.run))
            case "refuse" if robot.pending_request is not None:
                robot.pending_request.outcome, robot.pending_request = Reply(CANCELLED), None
            case "other":
                robot.begin_run(is_own=False)
            case "end":
                robot.end_run(rng.choice(("DONE", "FAULT", "STOPPED")))
            case "lost" | "restart" as event_name:
                link.news()  # earlier reports have arrived
                robot.end_run("LOST") if event_name == "lost" else robot.restart()
                link.news()  # no run begins soon after it
            case _:
                continue
        if rng.random() < 0.7:
            boot_and_runs = [
                (robot.boot, event.run) for event in robot.events if event.name == "STARTED"
            ]
            is_program_values = [
                news["is_program"] for news in link.news() if news.get("event") == "STARTED"
            ]
            assert is_program_values == [run in own_programs for run in boot_and_runs]
            assert link.owns_run == (robot.pending_request is not None or robot.runs_own is True)
            own_runs += robot.runs_own is True
    assert own_runs
