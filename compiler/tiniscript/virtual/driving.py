"""The path of a robot among obstacles: it turns along what it touches, and passes through nothing.

An obstacle pushes against the body and so slows its motors down, one more than the other. Knows the
geometry of bodies and walls. Knows no clock, no sensors and no friction. The results depend on when
the motors were set, not on how many times they are queried.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from tiniscript.robots.kinematics import Pose, move_pose, points
from tiniscript.robots.profile import Body
from tiniscript.virtual.geometry import Point, Segment, distance, gap_between

TOUCH_CM = 0.3  # a smaller distance is contact
STEP_MS = 10.0  # time step of a robot in contact
KEEP_INTERVAL_MS = 100.0  # time between two kept poses
NEAR_CM = 20.0  # obstacles further away than this are checked later
MAX_CORNERS = 20_000  # corners of the path; beyond that every other one is dropped
PUSHING_CM = 0.05  # a smaller one, and the obstacle pushes back
EXACT_CM = 1e-6  # a smaller overlap does not count
MAX_PUSHES = 6  # attempts to push the body out of obstacles in one place


class Contact(NamedTuple):
    """The nearest obstacle: its distance, and the nearest points of body and obstacle."""

    gap_cm: float
    body_point: Point  # point on the body's middle line
    obstacle_point: Point


class Hull:
    """The outline of a robot: all that is `radius_cm` from a line along its middle.

    As wide as the body; as long as the body around the wheels, and further to the front or to
    the back where a sensor sits there.
    """

    def __init__(self, body: Body) -> None:
        places_x_cm = [place.x_cm for place in body.places.values()]
        front = max([body.length_cm / 2, *places_x_cm])
        back = min([-body.length_cm / 2, *places_x_cm])
        self.radius_cm = min(body.width_cm, body.length_cm) / 2
        self.front_cm = front - self.radius_cm
        self.back_cm = min(back + self.radius_cm, self.front_cm)
        self.reach_cm = max(front, -back)  # distance of the farthest point from the wheels

    def spine(self, pose: Pose) -> Segment:
        heading = math.radians(pose.heading)
        cos, sin = math.cos(heading), math.sin(heading)
        return Segment(
            Point(pose.x_cm + self.back_cm * cos, pose.y_cm + self.back_cm * sin),
            Point(pose.x_cm + self.front_cm * cos, pose.y_cm + self.front_cm * sin),
        )

    def contact(self, pose: Pose, obstacles: Sequence[Segment]) -> Contact | None:
        """Return the nearest obstacle, or None if there is none at all."""
        spine = self.spine(pose)
        middle_x, middle_y = (spine.a.x + spine.b.x) / 2, (spine.a.y + spine.b.y) / 2
        reach = (self.front_cm - self.back_cm) / 2 + self.radius_cm
        nearest_contact: Contact | None = None
        for obstacle in obstacles:
            # far away is known more quickly
            if (
                nearest_contact is not None
                and distance(obstacle, middle_x, middle_y) >= nearest_contact.gap_cm + reach
            ):
                continue
            distance_cm, body_point, obstacle_point = gap_between(spine, obstacle)
            gap_cm = distance_cm - self.radius_cm
            if nearest_contact is None or gap_cm < nearest_contact.gap_cm:
                nearest_contact = Contact(gap_cm, body_point, obstacle_point)
        return nearest_contact

    def outline(self, pose: Pose, corners: int = 24) -> list[Point]:
        """Return points around the robot, for a picture."""
        back, front = self.spine(pose)
        points = []
        for k in range(corners):
            center = front if k < corners // 2 else back
            angle = math.radians(pose.heading - 90) + math.pi * (
                k / (corners // 2 - 1) if k < corners // 2 else (k - 1) / (corners // 2 - 1)
            )
            x, y = self.radius_cm * math.cos(angle), self.radius_cm * math.sin(angle)
            points.append(Point(center.x + x, center.y + y))
        return points


class Drive(NamedTuple):
    """Points of a path, joined by straight lines, and the least free distance beyond its end."""

    path: list[Pose]
    free_cm: float


class Driving:
    """A body that drives from `start`; times only go forward."""

    def __init__(self, body: Body, obstacles: Sequence[Segment], start: Pose) -> None:
        self.body = body
        self.hull = Hull(body)
        self.obstacles = obstacles
        self.left = self.right = 0.0  # actual speed of the wheels, in percent
        self.corners = [start]  # straight lines join them; they show the way
        self.bumps = 0  # number of contacts so far
        self.has_fallen = False  # out of a ring
        self.driven_cm = 0.0
        self._pose = start
        self._near_obstacles: Sequence[Segment] = obstacles  # everything that may come near
        self._near_pose: Pose | None = None  # last pose near an obstacle of a robot that is present
        self._kept_ms = 0.0  # time of that pose
        self._free_cm = 0.0  # no point of the body touches anything before this distance
        self._is_touching = self.touch_point(start) is not None

    @property
    def rivals(self) -> list[Pose]:
        """Return the poses of other bodies, in the order of the world."""
        return []

    @property
    def pushed_out_count(self) -> int:
        """Return the number of rivals that have left the ring."""
        return 0

    def other_outlines(self) -> list[Segment]:
        """Return the outlines of other bodies, which sensors see besides fixed objects."""
        return []

    def rest(self) -> None:
        """Stop everything, because the robot's time is over."""

    def is_blocked(self) -> bool:
        """Return whether the robot is inside an obstacle."""
        contact = self.hull.contact(self._pose, self.obstacles)
        return contact is not None and contact.gap_cm < 0

    def touch_point(self, pose: Pose) -> Point | None:
        """Return the place where a robot at `pose` touches an obstacle, or None."""
        contact = self._contact(pose)
        return contact.obstacle_point if contact is not None and contact.gap_cm < TOUCH_CM else None

    def _contact(self, pose: Pose) -> Contact | None:
        """Return the nearest obstacle, or None if each is further away than NEAR_CM."""
        centre = self._near_pose
        if centre is None or math.dist(centre[:2], pose[:2]) > NEAR_CM:
            least_cm = self.hull.reach_cm + 2 * NEAR_CM
            self._near_obstacles = [
                obstacle for obstacle in self.obstacles if distance(obstacle, *pose[:2]) < least_cm
            ]
            self._near_pose = pose
        contact = self.hull.contact(pose, self._near_obstacles)
        return None if contact is None or contact.gap_cm > NEAR_CM else contact

    def set_motors(self, now_ms: float, left: float, right: float) -> None:
        self.advance_to(now_ms)
        self.left, self.right = left, right

    def advance_to(self, now_ms: float) -> Pose:
        """Return the pose at `now_ms`, and continue the path from there."""
        while self._kept_ms + KEEP_INTERVAL_MS <= now_ms:
            self._advance(KEEP_INTERVAL_MS)
        if self._kept_ms < now_ms:
            self._advance(now_ms - self._kept_ms)
        return self._pose

    def pose_at(self, now_ms: float) -> Pose:
        """Return the pose at `now_ms`. This does not change the later path."""
        while self._kept_ms + KEEP_INTERVAL_MS <= now_ms:
            self._advance(KEEP_INTERVAL_MS)
        return self._drive_free(self._pose, self._free_cm, now_ms - self._kept_ms).path[-1]

    def _advance(self, duration_ms: float) -> None:
        drive = self._drive_free(self._pose, self._free_cm, duration_ms)
        self._kept_ms += duration_ms
        last_pose = self._pose
        self._pose, self._free_cm = drive.path[-1], drive.free_cm
        if not self.left and not self.right:
            return
        for pose in drive.path:
            self.driven_cm += math.dist(pose[:2], last_pose[:2])
            last_pose = pose
            self._keep_corner(pose)
        is_touching = self._free_cm < TOUCH_CM and self.touch_point(self._pose) is not None
        self.bumps += is_touching and not self._is_touching
        self._is_touching = is_touching

    def _keep_corner(self, pose: Pose) -> None:
        last_corner = self.corners[-1]
        if len(self.corners) > 1 and self._is_straight(self.corners[-2], last_corner, pose):
            self.corners[-1] = pose
        elif pose[:2] != last_corner[:2]:
            self.corners.append(pose)
        if len(self.corners) > MAX_CORNERS:
            self.corners = [*self.corners[:-1:2], self.corners[-1]]

    @staticmethod
    def _is_straight(first: Pose, second: Pose, third: Pose) -> bool:
        """Return whether a corner lies on the straight line between its neighbours."""
        ax, ay = second.x_cm - first.x_cm, second.y_cm - first.y_cm
        bx, by = third.x_cm - second.x_cm, third.y_cm - second.y_cm
        return abs(ax * by - ay * bx) < 1e-6 and ax * bx + ay * by >= 0

    def _drive_free(self, pose: Pose, free_cm: float, duration_ms: float) -> Drive:
        """Return the path from a pose, of which `free_cm` are known to be free."""
        if (not self.left and not self.right) or duration_ms <= 0:
            return Drive([pose], free_cm)
        speed = self._fastest_cm_ms()
        path: list[Pose] = []
        left_ms = duration_ms
        is_gap_known = False  # whether the free distance is exact
        while left_ms > 0:
            if free_cm < speed * left_ms and not is_gap_known:
                contact = self._contact(pose)
                free_cm = NEAR_CM if contact is None else max(0.0, contact.gap_cm)
            step_ms = min(left_ms, max(free_cm / speed, STEP_MS))
            if free_cm >= speed * step_ms:
                path += points(self.body, pose, self.left, self.right, step_ms)
                free_cm -= speed * step_ms
                is_gap_known = False
            else:
                wanted_pose = move_pose(self.body, pose, *self._pushed_wheel_speeds(pose), step_ms)
                pushed_pose, free_cm = self._slide_along(pose, wanted_pose)
                path.append(pushed_pose)
                is_gap_known = True
            pose = path[-1]
            left_ms -= step_ms
        return Drive(path, free_cm)

    def _fastest_cm_ms(self) -> float:
        """Return the highest possible speed of a point of the body."""
        percent_cm_ms = self.body.speed_cm_s / 100 / 1000
        ahead_cm_ms = abs(self.left + self.right) / 2 * percent_cm_ms
        turn_radians_ms = abs(self.right - self.left) / 200 * math.radians(self.body.turn_s) / 1000
        return ahead_cm_ms + turn_radians_ms * self.hull.reach_cm

    def _pushed_wheel_speeds(self, pose: Pose) -> tuple[float, float]:
        """Return the wheel speeds in percent while an obstacle pushes against the body.

        It pushes as much as keeps the body out. Each motor is slowed by the force against it, and
        no wheel slips sideways, so the side that has touched something lags.
        """
        left, right = self.left, self.right
        contact = self._contact(pose)
        if contact is None or contact.gap_cm > PUSHING_CM:
            return left, right
        heading = math.radians(pose.heading)
        cos, sin = math.cos(heading), math.sin(heading)
        distance_cm = math.dist(contact.body_point, contact.obstacle_point) or 1.0
        away_x, away_y = (
            (body_coordinate - obstacle_coordinate) / distance_cm
            for body_coordinate, obstacle_coordinate in zip(
                contact.body_point, contact.obstacle_point, strict=True
            )
        )
        forward_part = away_x * cos + away_y * sin  # the part of the push that is along the robot,
        side_part = away_y * cos - away_x * sin
        lever_cm = (contact.body_point.x - pose.x_cm) * cos + (
            contact.body_point.y - pose.y_cm
        ) * sin
        lever = lever_cm * math.radians(self.body.turn_s) / self.body.speed_cm_s
        torque = side_part * lever  # the torque that turns it
        closing_speed = (left + right) / 2 * forward_part + (right - left) / 2 * torque
        if closing_speed >= 0:
            return left, right
        push_percent = closing_speed / (forward_part * forward_part + torque * torque)
        return left - push_percent * (forward_part - torque), right - push_percent * (
            forward_part + torque
        )

    def _slide_along(self, old_pose: Pose, pose: Pose) -> tuple[Pose, float]:
        """Return the end of a robot's way to `pose`, and the free distance there.

        It is pushed out of every obstacle; if that is not possible it stays where it was.
        """
        for _ in range(MAX_PUSHES):
            contact = self._contact(pose)
            if contact is None:
                return pose, NEAR_CM
            if contact.gap_cm > -EXACT_CM:
                return pose, max(0.0, contact.gap_cm)
            distance_cm = math.dist(contact.body_point, contact.obstacle_point)
            if distance_cm < self.hull.radius_cm / 2:  # deeper than a step leads: it was forced in
                break
            scale = -contact.gap_cm / distance_cm
            pose = Pose(
                pose.x_cm + (contact.body_point.x - contact.obstacle_point.x) * scale,
                pose.y_cm + (contact.body_point.y - contact.obstacle_point.y) * scale,
                pose.heading,
            )
        return old_pose, 0.0
