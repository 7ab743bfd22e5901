"""Ctrl-C during an upload to many robots: at any stage of each, and with late connections, no
program starts afterwards, and all robots are stopped.
"""

from __future__ import annotations

import random
import threading
from argparse import Namespace
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import SimpleNamespace
from typing import Any, cast

import pytest

from tests.support.command import run_in_process
from tests.support.robot_fleet import RobotFleet, known_fleet
from tests.support.waiting import HANG_LIMIT_S
from tiniscript import robots
from tiniscript.cli import streams
from tiniscript.cli.robot import fleet as fleet_of
from tiniscript.cli.robot.fleet import POLL_INTERVAL_S, Fleet
from tiniscript.cli.robot.member import Member, Target
from tiniscript.cli.terminal.fleet_table import FleetTable
from tiniscript.library import opening
from tiniscript.library.client import Client

TINIBOT = robots.load("tinibot").kit
# The stages that the thread of a robot may have reached.
OPENING_STAGE, OPENED_STAGE, ASKING_STAGE, ASKED_STAGE, SENDING_STAGE, DRIVING_STAGE = range(6)
# It begins to drive once: that it drives on is no start.
ENDLESS_PROGRAM, DRIVE_ACTION = "SI|M(80, 80);LOOP(FOREVER);W(1);END_LOOP", "MOTORS 80 80"


class Room:
    """Robots, and the stage at which each one's thread waits until Ctrl-C was pressed."""

    def __init__(self, fleet: RobotFleet, stages: list[int]) -> None:
        self.fleet = fleet
        self.stages = {pupil.port: stage for pupil, stage in zip(fleet.pupils, stages, strict=True)}
        self.waiting_ports: set[str] = set()
        self.has_pressed = threading.Event()
        self.start_times: list[int] = []  # when Ctrl-C was pressed, by robot

    def reach(self, stage: int, port: str) -> None:
        if self.stages[port] == stage and not self.has_pressed.is_set():
            self.waiting_ports.add(port)
            assert self.has_pressed.wait(HANG_LIMIT_S), "nobody presses Ctrl-C"

    def may_press(self) -> bool:
        return all(
            pupil.moves
            if self.stages[pupil.port] == DRIVING_STAGE
            else pupil.port in self.waiting_ports
            for pupil in self.fleet.pupils
        )

    def count_states(self) -> list[int]:
        return [pupil.actions.count(DRIVE_ACTION) for pupil in self.fleet.pupils]


def step_calls(
    monkeypatch: pytest.MonkeyPatch,
    room: Room,
    owner: object,
    name: str,
    early_stage: int,
    late_stage: int,
) -> None:
    """Make calls of a function, whose first argument contains a port, pass two stages."""
    step: Callable[..., Any] = getattr(owner, name)

    def interrupt_step(target: Any, *words: Any, **keyword_arguments: Any) -> Any:
        port = target if isinstance(target, str) else target.port
        room.reach(early_stage, port)
        outcome = step(target, *words, **keyword_arguments)
        room.reach(late_stage, port)
        return outcome

    monkeypatch.setattr(owner, name, interrupt_step)


@pytest.fixture
def fleet() -> Iterator[RobotFleet]:
    with known_fleet([TINIBOT] * 3) as robot_fleet:
        yield robot_fleet


@pytest.mark.sampled("seed", keep=3)
@pytest.mark.parametrize("seed", range(8))
def test_after_ctrl_c_nothing_starts(
    fleet: RobotFleet, monkeypatch: pytest.MonkeyPatch, seed: int
) -> None:
    rng = random.Random(seed)
    first_stage = seed % 6  # the stages of all robots overlap
    room = Room(
        fleet,
        [
            first_stage,
            *(rng.choice((OPENING_STAGE, OPENED_STAGE, ASKED_STAGE, DRIVING_STAGE)) for _ in "23"),
        ],
    )
    step_calls(monkeypatch, room, opening, "connection_to", OPENING_STAGE, OPENED_STAGE)
    step_calls(monkeypatch, room, Client, "meet", ASKING_STAGE, ASKED_STAGE)
    step_calls(monkeypatch, room, Client, "send_program", SENDING_STAGE, DRIVING_STAGE + 1)
    interrupt = Fleet.interrupt_robots

    def press(_: Fleet) -> None:
        if not room.has_pressed.is_set() and room.may_press():
            raise KeyboardInterrupt

    def interrupt_and_note(interrupted_fleet: Fleet) -> None:
        interrupt(interrupted_fleet)
        room.start_times = room.start_times or room.count_states()
        room.has_pressed.set()

    monkeypatch.setattr(Fleet, "_raise_if_reader_gone", press)
    monkeypatch.setattr(Fleet, "interrupt_robots", interrupt_and_note)
    result = run_in_process("upload", "-e", ENDLESS_PROGRAM, "--all").gives(2)
    assert room.has_pressed.is_set()
    assert room.count_states() == room.start_times, (room.stages, result)
    assert not any(pupil.moves for pupil in fleet.pupils)


@contextmanager
def interrupt_contained() -> Iterator[None]:
    """A Ctrl-C ends here, and no run of the tests."""
    try:
        yield
    except KeyboardInterrupt:
        pytest.fail("Ctrl-C ends in a traceback")


class WatchedFleet:
    """A fleet whose robots are silent forever, on a clock of the test; somebody presses Ctrl-C."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, presses_s: list[float]) -> None:
        self.now_s = 0.0
        self.presses_s = [*presses_s]
        self.stop_times_s: list[float] = []  # when each robot got its stop
        monkeypatch.setattr(fleet_of, "monotonic", lambda: self.now_s)
        monkeypatch.setattr(streams, "drop_unread_output", lambda: None)
        options = Namespace(verb="upload", detach=True, json=False)
        self.fleet = Fleet([], options, robots.load("tinibot"), "en")
        for port in "12":
            member = Member(Target(port, "", True, True), deque())
            member.connection = cast(Any, SimpleNamespace(
                interrupt=lambda: self.stop_times_s.append(self.now_s),
                connection=SimpleNamespace(robot=None),
            ))  # fmt: skip
            self.fleet.members.append(member)
        news = SimpleNamespace(wait=self.pass_time, clear=lambda: None)
        monkeypatch.setattr(self.fleet, "_result_bell", news)

    def pass_time(self, seconds: float = POLL_INTERVAL_S) -> None:
        assert self.now_s < 300, "it never ends"
        self.now_s += seconds
        if self.presses_s and self.now_s > self.presses_s[0]:
            self.presses_s.pop(0)
            raise KeyboardInterrupt


@pytest.mark.parametrize("interruption", ["lines", "a table", "stop"])
@pytest.mark.parametrize("presses", [1, 2, 3])
def test_the_first_ctrl_c_waits_for_the_robots_and_the_second_does_not(
    monkeypatch: pytest.MonkeyPatch, interruption: str, presses: int
) -> None:
    """They may come at any time; without a second press, it ends by itself."""
    for seed in range(10):
        rng = random.Random(seed)
        times = [5.0]
        for _ in range(presses):
            times.append(
                times[-1]
                + rng.uniform(POLL_INTERVAL_S, opening.CONFIRM_TIMEOUT_S - POLL_INTERVAL_S)
            )
        room = WatchedFleet(monkeypatch, times[:presses])
        timeout_s = opening.CONFIRM_TIMEOUT_S + 1
        if interruption == "stop":  # an unreadable output acts like a first Ctrl-C
            room.presses_s, timeout_s = times[1:presses], opening.CONFIRM_TIMEOUT_S
            room.now_s = times[0]
            with interrupt_contained():
                room.fleet.stop_robots()
        else:
            table = SimpleNamespace(
                draw=room.pass_time, end=lambda _: None, print_line=lambda _: None
            )
            with interrupt_contained():
                room.fleet.print_until_done(
                    cast(FleetTable, table) if interruption == "a table" else None
                )
        assert [
            stop_s for stop_s in room.stop_times_s if stop_s <= times[0] + 2 * POLL_INTERVAL_S
        ], "each is told"
        assert len(room.stop_times_s) == len(room.fleet.members)
        end_s = times[1] if presses > 1 else times[0] + timeout_s
        assert end_s <= room.now_s <= end_s + 3 * POLL_INTERVAL_S
