"""Ctrl-C while a program goes to many robots: at whatever stage each of them is, and whoever still
connects, after it none starts anything, and all stand."""

from __future__ import annotations

import random
import threading
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from tests.support.command import inside
from tests.support.robot_fleet import RobotFleet, known_fleet
from tests.support.waiting import HANGS_S
from tiniscript import robots
from tiniscript.cli.robot.fleet import Fleet
from tiniscript.library import opening
from tiniscript.library.client import Client

TINIBOT = robots.load("tinibot").kit
# Where the thread of a robot may be.
OPENING, OPENED, ASKING, ASKED, SENDING, DRIVING = range(6)
# It begins to drive once: that it drives on is no start.
ENDLESS, DRIVES = "SI|M(80, 80);LOOP(FOREVER);W(1);END_LOOP", "MOTORS 80 80"


class Room:
    """Robots, and the stage at which each one's thread waits until Ctrl-C was pressed."""

    def __init__(self, fleet: RobotFleet, stages: list[int]) -> None:
        self.fleet = fleet
        self.stages = {pupil.port: stage for pupil, stage in zip(fleet.pupils, stages, strict=True)}
        self.there: set[str] = set()
        self.pressed = threading.Event()
        self.starts: list[int] = []  # of each robot, when Ctrl-C was pressed

    def at(self, stage: int, port: str) -> None:
        if self.stages[port] == stage and not self.pressed.is_set():
            self.there.add(port)
            assert self.pressed.wait(HANGS_S), "nobody presses Ctrl-C"

    def may_press(self) -> bool:
        return all(
            pupil.moves if self.stages[pupil.port] == DRIVING else pupil.port in self.there
            for pupil in self.fleet.pupils
        )

    def counted(self) -> list[int]:
        return [pupil.did.count(DRIVES) for pupil in self.fleet.pupils]


def stepping(
    monkeypatch: pytest.MonkeyPatch, room: Room, owner: object, name: str, before: int, after: int
) -> None:
    """Let each call of a function, whose first word is a port or has one, reach two stages."""
    whole: Callable[..., Any] = getattr(owner, name)

    def stepped(first: Any, *words: Any, **named: Any) -> Any:
        port = first if isinstance(first, str) else first.port
        room.at(before, port)
        found = whole(first, *words, **named)
        room.at(after, port)
        return found

    monkeypatch.setattr(owner, name, stepped)


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
    first = seed % 6  # each stage comes, beside others
    room = Room(fleet, [first, *(rng.choice((OPENING, OPENED, ASKED, DRIVING)) for _ in "23")])
    stepping(monkeypatch, room, opening, "connection_to", OPENING, OPENED)
    stepping(monkeypatch, room, Client, "meet", ASKING, ASKED)
    stepping(monkeypatch, room, Client, "send_program", SENDING, DRIVING + 1)
    interrupt = Fleet.interrupt

    def press(_: Fleet) -> None:
        if not room.pressed.is_set() and room.may_press():
            raise KeyboardInterrupt

    def interrupted(its: Fleet) -> None:
        interrupt(its)
        room.starts = room.starts or room.counted()
        room.pressed.set()

    monkeypatch.setattr(Fleet, "_refuse_unread", press)
    monkeypatch.setattr(Fleet, "interrupt", interrupted)
    done = inside("upload", "-e", ENDLESS, "--all").gives(2)
    assert room.pressed.is_set()
    assert room.counted() == room.starts, (room.stages, done)
    assert not any(pupil.moves for pupil in fleet.pupils)
