"""The robot's collisions and dead ends: `python -m tools.bench.obstacles`.

Each program drives for half an hour of the robot's time in the world `obstacles`, from 20 places
that the seed draws, with motors that differ by up to 5 % and readings that differ by up to 2 %. A
robot is stuck where it stays within 3 cm of one place for 5 s.
"""

from __future__ import annotations

import math
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from random import Random
from statistics import median
from typing import NamedTuple

from tests.support.virtual_robot import Talk
from tiniscript import robots
from tiniscript.robots.kinematics import Pose
from tiniscript.virtual import worlds
from tiniscript.virtual.driving import Driving
from tiniscript.virtual.robot import Settings, VirtualRobot
from tools import ROOT
from tools.bench import page

RUN_SECONDS = 1800  # length of a run in the robot's time
SEED_COUNT = 20
STUCK_S = 5
STUCK_CM = 3.0
POLL_INTERVAL_MS = 500
PROGRAMS = ("away.ts", "obstacle.ts", "explore.ts")
ROWS = (
    "`away.ts`, four lines with a `WHEN`",
    "`obstacle.ts`, the paper's",
    "`explore.ts`, with a `WHEN`",
)
ROBOT = "tinibot32"


class Drive(NamedTuple):
    contact_count: int
    driven_m: float
    stood_s: float  # the longest time in one place


def main() -> None:
    figure_rows = []
    for row, name in zip(ROWS, PROGRAMS, strict=True):
        text = (ROOT / "examples" / name).read_text(encoding="utf-8")
        with ProcessPoolExecutor() as pool:
            drives = list(pool.map(partial(drive, text), range(SEED_COUNT)))
        contacts = [run.contact_count for run in drives]
        metres = median(run.driven_m for run in drives)
        stood_s = max(run.stood_s for run in drives)
        stuck_count = sum(run.stood_s >= STUCK_S for run in drives)
        longest_text = f"{stood_s:.1f} s" if stood_s < STUCK_S else f"{stood_s:.0f} s"
        figure_rows.append((row, f"{median(contacts):.0f}", f"{max(contacts)}", f"{metres:.0f}",
            longest_text,
                            f"{stuck_count} of {SEED_COUNT}"))  # fmt: skip
    page.show("obstacles", figure_rows)


def drive(text: str, seed: int) -> Drive:
    """Return the drive of a program from a place of this seed."""
    random_source = Random(seed)
    profile = robots.load(ROBOT)
    board = profile.board._replace(max_run_seconds=RUN_SECONDS + 60)  # ten minutes would end it
    profile = profile._replace(board=board)
    world = worlds.load("obstacles")
    start = world.start
    while seed:  # the first one begins at the world's start
        start = Pose(
            random_source.uniform(0, 220),
            random_source.uniform(0, 200),
            random_source.uniform(0, 360),
        )
        if not Driving(profile.body, world.obstacles(), start).is_blocked():
            break
    settings = Settings(seed + 1, noise=0.02, motors=(100.0, random_source.uniform(95, 105)))
    robot = VirtualRobot(profile, world._replace(start=start), settings)
    Talk(robot).upload(text, is_detached=True)
    now_ms = robot.now_ms
    end_ms = now_ms + RUN_SECONDS * 1000
    last_pose = robot.pose
    stood_ms = 0
    while now_ms < end_ms:
        since_ms = now_ms
        while math.dist(last_pose[:2], robot.pose[:2]) <= STUCK_CM:
            stood_ms = max(stood_ms, now_ms - since_ms)
            if now_ms >= end_ms:
                break
            now_ms += POLL_INTERVAL_MS
            robot.step(now_ms)
            robot.take_events()
        last_pose = robot.pose
    assert robot.is_running, f"seed {seed}: its program has ended"
    return Drive(robot.driving.bumps, robot.driving.driven_cm / 100, stood_ms / 1000)


if __name__ == "__main__":
    main()
