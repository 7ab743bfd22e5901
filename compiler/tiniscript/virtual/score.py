"""How far a robot has come with the flags of its world, in their order, and what that is worth.

Knows robots and flags. The same run has the same score, however often it is looked at.
"""

from __future__ import annotations

import math
from typing import Any

from tiniscript.virtual.robot import VirtualRobot
from tiniscript.virtual.world import World

FLAG_POINTS, BUMP_POINTS, SECOND_POINTS = 100, 10, 5  # points; for each second that is left
LOOK_PAUSE_MS = 5  # between two looks


class Score:
    """What a robot has done with the flags of a world since its program began.

    Where it stands once the program has ended counts, too.
    """

    def __init__(self, world: World) -> None:
        self._world = world
        self._taken = self._bumps = self._ms = 0

    @property
    def is_whole(self) -> bool:
        return self._taken == len(self._world.flags)

    def look(self, robot: VirtualRobot) -> None:
        """See where the robot is now. What it does with all flags taken counts no more."""
        if self.is_whole or robot.now_ms % LOOK_PAUSE_MS:
            return
        if robot.started_ms is None:
            return
        self._bumps = robot.driving.bumps
        self._ms = (robot.now_ms if robot.is_running else robot.ended_ms or 0) - robot.started_ms
        flag = self._world.flags[self._taken]
        x_cm, y_cm, _ = robot.pose
        stands = not (robot.driving.left or robot.driving.right)
        if math.hypot(x_cm - flag.place.x, y_cm - flag.place.y) <= flag.reach_cm:
            self._taken += stands or not flag.needs_rest

    def state(self) -> dict[str, Any] | None:
        """Return what is to be shown, or None where there are no flags."""
        world = self._world
        if not world.flags:
            return None
        left_s = world.seconds - self._ms / 1000
        is_in_time = not world.seconds or left_s >= 0
        points = FLAG_POINTS * self._taken - BUMP_POINTS * self._bumps
        if self.is_whole:
            points += SECOND_POINTS * max(0, math.floor(left_s))
        return {
            "taken": self._taken,
            "of": len(world.flags),
            "points": max(0, points),
            "stars": self.is_whole * (1 + (not self._bumps) + is_in_time),
        }
