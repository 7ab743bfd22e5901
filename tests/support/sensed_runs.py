"""Runs of a whole robot on this computer with changing sensor input.

Its line takes as long for a byte as one of 9600 baud, or a little more or less.
"""

from __future__ import annotations

import random
from typing import NamedTuple

from tests.machines.host_firmware import TICKS
from tests.support.debugging import DebuggedRobot
from tests.support.robot_on_host import KIT
from tests.support.shown_in_loops import TimedAction, largest_difference_ms
from tiniscript.link.outcomes import Event
from tiniscript.link.payloads import ReadingEvent
from tiniscript.link.requests import OK

RUN_MS = 2500
BYTE_TICKS = round(TICKS * 10_000 / 9600)
LARGEST_DELAY_MS = 1  # a byte


class SensedRun(NamedTuple):
    did: list[TimedAction]
    events: list[Event]
    values: list[list[int]]  # successive values of each sensor

    @property
    def readings(self) -> list[ReadingEvent]:
        return [event for event in self.events if isinstance(event, ReadingEvent)]


def sensed_run(
    text: str, seed: int, is_told: bool, byte_ticks: int, max_change_interval_ms: int = 30
) -> SensedRun:
    """Run a program while its sensors' readings change, with or without reporting them."""
    robot = DebuggedRobot(text)
    assert robot.robot.until(robot.session, robot.session.tell_readings(is_told)) == OK
    return run_with_sensors(robot, random.Random(seed), byte_ticks, max_change_interval_ms)


def run_with_sensors(
    robot: DebuggedRobot,
    rng: random.Random,
    byte_ticks: int,
    max_change_interval_ms: int = 30,
    run_ms: int = RUN_MS,
) -> SensedRun:
    """Start the program that a robot holds, and change its sensors' readings meanwhile."""
    readings = [[0] for _ in KIT.sensors]
    robot.robot.set_readings(*(0 for _ in KIT.sensors))
    first_row = len(robot.robot.did)
    robot.start()
    robot.robot.set_byte_ticks(byte_ticks)
    events, end_ms = list[Event](), robot.robot.now_ms + run_ms
    while robot.robot.now_ms < end_ms:
        for row in readings:
            row.append(row[-1] if rng.random() < 0.5 else rng.randrange(0, 400_000, 100))
        robot.robot.set_readings(*(row[-1] for row in readings))
        events += robot.talk(rng.randint(1, max_change_interval_ms))
    rows = (line.split(" ", 1) for line in robot.robot.did[first_row:])
    return SensedRun([(float(ms), action) for ms, action in rows], events, readings)


def is_steady(text: str, seed: int) -> bool:
    """Return whether a program acts at the same times on a line that is 5 % slower or faster."""
    usual_run, *other_runs = (
        sensed_run(text, seed, False, BYTE_TICKS + tick_shift).did for tick_shift in (0, -1, 1)
    )
    return all(
        largest_difference_ms(usual_run, other_run) <= LARGEST_DELAY_MS for other_run in other_runs
    )
