"""Where a robot with two driven wheels gets to.

Knows the geometry: a setting of the motors that lasts is a straight line, a turn on the spot or
an arc of a circle, and this is exact. Knows no clock, no world and no friction: wheels are at
once as fast as they are set.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from tiniscript.robots.profile import Body

STEP = 5.0  # degrees of an arc between two points; between them a straight line is 0.1 % off


class Pose(NamedTuple):
    """Where the middle between the wheels is, and where the robot looks.

    A robot that looks along `heading` 0 goes along x; y is to its left. `heading` is in degrees,
    counterclockwise, and goes on counting over full turns.
    """

    x_cm: float
    y_cm: float
    heading: float


START = Pose(0.0, 0.0, 0.0)


def moved(body: Body, pose: Pose, left: float, right: float, duration_ms: float) -> Pose:
    """Return the pose after the motors were set to `left` and `right` percent for so long."""
    left_cm, right_cm = (
        body.speed_cm_s * percent / 100 * duration_ms / 1000 for percent in (left, right)
    )
    turn = (right_cm - left_cm) / body.wheel_base_cm
    half = turn / 2
    # the chord of an arc points halfway between the headings at its ends
    chord_cm = (left_cm + right_cm) / 2 * (math.sin(half) / half if half else 1.0)
    along = math.radians(pose.heading) + half
    return Pose(
        pose.x_cm + chord_cm * math.cos(along),
        pose.y_cm + chord_cm * math.sin(along),
        pose.heading + math.degrees(turn),
    )


def points(body: Body, pose: Pose, left: float, right: float, duration_ms: float) -> list[Pose]:
    """Return poses along the way, without its beginning; straight lines join them.

    A straight line and a turn on the spot need only their end. An arc has a point at least
    every STEP degrees, for two circles at most: more rounds are the same circle.
    """
    end = moved(body, pose, left, right, duration_ms)
    turn = abs(end.heading - pose.heading)
    if turn == 0 or left == -right:
        return [end]
    drawn = turn if turn <= 360 else 360 + turn % 360
    steps = math.ceil(drawn / STEP)
    step_ms = duration_ms * drawn / turn / steps
    return [*(moved(body, pose, left, right, step_ms * k) for k in range(1, steps)), end]


class Way:
    """The way of a robot whose motors are set from time to time; times only go forward."""

    def __init__(self, body: Body, pose: Pose = START) -> None:
        self.body = body
        self.left = self.right = 0  # the setting that lasts, in percent,
        self.since_ms: float = 0  # since when,
        self.begun = pose  # and where it began
        self.corners = [pose]  # straight lines join them; they show the way up to here

    def set_motors(self, now_ms: float, left: int, right: int) -> None:
        if (left, right) == (self.left, self.right):
            return
        self.corners += self.ahead(now_ms)
        self.begun, self.since_ms = self.pose(now_ms), now_ms
        self.left, self.right = left, right

    def pose(self, now_ms: float) -> Pose:
        """Return where the robot is, not before the last setting."""
        return moved(self.body, self.begun, self.left, self.right, now_ms - self.since_ms)

    def ahead(self, now_ms: float) -> list[Pose]:
        """Return the points of the way since the last corner; none where it did not leave it."""
        if self.left == -self.right:
            return []
        return points(self.body, self.begun, self.left, self.right, now_ms - self.since_ms)

    def thin_out(self, most: int) -> None:
        """Forget corners that no picture shows apart; where that is not enough, the oldest."""
        across_cm = max(
            max(values) - min(values) for values in list(zip(*self.corners, strict=True))[:2]
        )
        kept = self.corners[:1]
        for corner in self.corners[1:-1]:
            if math.dist(corner[:2], kept[-1][:2]) > across_cm / 500:
                kept.append(corner)
        self.corners = [*kept, self.corners[-1]][-most:]
