"""The robot's progress with its world's flags and rivals, and its score.

Knows robots, flags and rivals. The same run has the same score, however often it is looked at.
"""

from __future__ import annotations

import math
from typing import Any

from tiniscript.virtual.robot import VirtualRobot
from tiniscript.virtual.world import World

FLAG_POINTS, BUMP_POINTS, SECOND_POINTS = 100, 10, 5  # a rival as a flag; each second left
MAX_STARS = 3  # for a task that is done, without a collision, in time
SCORE_INTERVAL_MS = 5  # between two looks


class Score:
    """The results of a robot with the flags and rivals since the start of its program.

    Its position after the end of the program counts, too.
    """

    def __init__(self, world: World) -> None:
        self._world = world
        self._flag_count = self._pushed_count = self._bump_count = self._run_ms = 0
        self._has_fallen = False

    @property
    def is_complete(self) -> bool:
        world = self._world
        return self._flag_count == len(world.flags) and self._pushed_count == self._rival_count

    @property
    def _rival_count(self) -> int:
        """Return the number of rivals to push out; none in a world without a ring."""
        return len(self._world.rivals) if self._world.rings else 0

    def update(self, robot: VirtualRobot) -> None:
        """See where the robot is now. After all is done, or after a fall, nothing counts."""
        if self.is_complete or self._has_fallen or robot.now_ms % SCORE_INTERVAL_MS:
            return
        if robot.started_ms is None:
            return
        self._bump_count = robot.driving.bumps
        self._run_ms = (
            robot.now_ms if robot.is_running else robot.ended_ms or 0
        ) - robot.started_ms
        x_cm, y_cm, _ = robot.pose
        self._has_fallen = robot.driving.has_fallen
        self._pushed_count = robot.driving.pushed_out_count
        if self._flag_count == len(self._world.flags):
            return
        flag = self._world.flags[self._flag_count]
        is_standing = not (robot.driving.left or robot.driving.right)
        if math.hypot(x_cm - flag.place.x, y_cm - flag.place.y) <= flag.reach_cm:
            self._flag_count += is_standing or not flag.needs_rest

    def state(self) -> dict[str, Any] | None:
        """Return the state to show, or None if there is no task."""
        world = self._world
        if not world.flags and not self._rival_count:
            return None
        left_s = world.seconds - self._run_ms / 1000
        is_in_time = not world.seconds or left_s >= 0
        points = (
            FLAG_POINTS * (self._flag_count + self._pushed_count) - BUMP_POINTS * self._bump_count
        )
        if self.is_complete:
            points += SECOND_POINTS * max(0, math.floor(left_s))
        return {
            "taken": self._flag_count,
            "of": len(world.flags),
            "pushed": self._pushed_count,
            "rivals": self._rival_count,
            "has_fallen": self._has_fallen,
            "points": max(0, points),
            "stars": self.is_complete * (1 + (not self._bump_count) + is_in_time),
        }
