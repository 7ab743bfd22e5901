"""The path of a robot with two driven wheels.

Knows the geometry: a constant setting of the motors gives a straight line, a turn on the spot or
an arc of a circle, exactly. Knows no clock, no world and no friction: wheels reach their speed at
once.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from tiniscript.robots.profile import Body

ARC_STEP = 5.0  # degrees of an arc between two points; a straight line between them is 0.1 % off


class Pose(NamedTuple):
    """The position of the middle between the wheels, and the robot's heading.

    With `heading` 0, the robot drives along x, and y is to its left. `heading` is in degrees,
    counterclockwise, and does not wrap around after a full turn.
    """

    x_cm: float
    y_cm: float
    heading: float


START = Pose(0.0, 0.0, 0.0)


def move_pose(body: Body, pose: Pose, left: float, right: float, duration_ms: float) -> Pose:
    """Return the pose after the motors ran at `left` and `right` percent for `duration_ms`."""
    left_cm, right_cm = (
        body.speed_cm_s * percent / 100 * duration_ms / 1000 for percent in (left, right)
    )
    turn = body.turn_s * (right - left) / 200 * duration_ms / 1000
    half = math.radians(turn / 2)
    # the chord of an arc points halfway between the headings at its ends
    chord_cm = (left_cm + right_cm) / 2 * (math.sin(half) / half if half else 1.0)
    direction = math.radians(pose.heading) + half
    return Pose(
        pose.x_cm + chord_cm * math.cos(direction),
        pose.y_cm + chord_cm * math.sin(direction),
        pose.heading + turn,
    )


def points(body: Body, pose: Pose, left: float, right: float, duration_ms: float) -> list[Pose]:
    """Return poses along the way, without its first; straight lines join them.

    A straight line and a turn on the spot need only their end. An arc has a point at least every
    STEP degrees, for at most two full circles: further rounds repeat the same circle.
    """
    end = move_pose(body, pose, left, right, duration_ms)
    turn = abs(end.heading - pose.heading)
    if turn == 0 or left == -right:
        return [end]
    drawn_turn = turn if turn <= 360 else 360 + turn % 360
    steps = math.ceil(drawn_turn / ARC_STEP)
    step_ms = duration_ms * drawn_turn / turn / steps
    return [*(move_pose(body, pose, left, right, step_ms * k) for k in range(1, steps)), end]


class Way:
    """The path of a robot whose motor setting changes; times only go forward."""

    def __init__(self, body: Body, pose: Pose = START) -> None:
        self.body = body
        self.left = self.right = 0  # the current setting, in percent,
        self.since_ms: float = 0  # start time of the current movement
        self.start_pose = pose  # pose at that time
        self.corners = [pose]  # points of the path so far, joined by straight lines

    def set_motors(self, now_ms: float, left: int, right: int) -> None:
        if (left, right) == (self.left, self.right):
            return
        self.corners += self.points_ahead(now_ms)
        self.start_pose, self.since_ms = self.pose(now_ms), now_ms
        self.left, self.right = left, right

    def pose(self, now_ms: float) -> Pose:
        """Return the pose at a time that is not before the last setting."""
        return move_pose(self.body, self.start_pose, self.left, self.right, now_ms - self.since_ms)

    def points_ahead(self, now_ms: float) -> list[Pose]:
        """Return the points of the path since the last corner; none if the robot has not moved."""
        if self.left == -self.right:
            return []
        return points(self.body, self.start_pose, self.left, self.right, now_ms - self.since_ms)

    def thin_out(self, most_corners: int) -> None:
        """Drop corners too close to distinguish in a picture; if too many remain, the oldest."""
        across_cm = max(
            max(values) - min(values) for values in list(zip(*self.corners, strict=True))[:2]
        )
        kept_corners = self.corners[:1]
        for corner in self.corners[1:-1]:
            if math.dist(corner[:2], kept_corners[-1][:2]) > across_cm / 500:
                kept_corners.append(corner)
        self.corners = [*kept_corners, self.corners[-1]][-most_corners:]
