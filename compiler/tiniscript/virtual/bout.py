"""The path of a robot among rivals: bodies that drive, push it and are pushed.

A push slows down the wheels of whom it meets, as that of a wall does (`driving`): both bodies get
the same push, as large as it takes that neither comes into the other. Unlike a wall's, it also
moves a body aside, whose wheels slip then. All happens on a grid of milliseconds, so nothing
depends on when it is asked.

A rival begins when the robot first moves. It drives at the robot that is before it, looks around
if none is, and turns back at the edge of a ring.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import combinations

from tiniscript.robots.kinematics import Pose, move_pose
from tiniscript.robots.profile import Body
from tiniscript.virtual.driving import (
    EXACT_CM,
    MAX_PUSHES,
    PUSHING_CM,
    TOUCH_CM,
    Contact,
    Driving,
    Hull,
)
from tiniscript.virtual.geometry import Point, Segment, gap_between, join_points
from tiniscript.virtual.world import Ring, Rival, World

TICK_MS = 1.0
CORNER_INTERVAL_MS = 20.0  # between two corners of the way
MAX_SWEEPS = 4  # rounds over all contacts, until no bodies come nearer to each other
GRIP = 0.7  # share of a push that acts as friction between touching bodies
SLIP_RATIO = 0.5  # motion from a push at the side, as a share of that from a push at the back
DECISION_INTERVAL_MS = 10.0  # time between two decisions of a rival
# Range of a rival's sight, and its angle to each side.
SIGHT_CM, SIGHT_RADIANS = 100.0, math.radians(25)
BACK_UP_MS, TURN_AWAY_DEGREES = (
    300.0,
    150.0,
)  # at an edge it backs up for this time, and turns by this angle
OUTLINE_CORNERS = 16  # corners of a rival's outline, as distance sensors see it
STANDSTILL: tuple[float, float] = (0.0, 0.0)


class Mover:
    """A body that drives and is pushed: where it is, what its wheels do, and how it slips aside."""

    def __init__(self, body: Body, pose: Pose) -> None:
        self.body = body
        self.hull = Hull(body)
        self.pose = pose
        self.wanted_speeds = STANDSTILL  # percent of each wheel, as its motors are set
        self.left = self.right = 0.0  # current speeds of its wheels
        self.aside_cm_s = 0.0  # cm in a second, to its left
        self._turn_radians_s = math.radians(body.turn_s)
        self._spine: Segment | None = None
        self._free_cm = 0.0  # no obstacle is nearer

    def begin(self) -> None:
        (self.left, self.right), self.aside_cm_s = self.wanted_speeds, 0.0

    def _push_parts(self, point: Point, direction: Point) -> tuple[float, float, float]:
        """Return the parts of a push along the body, aside, and its lever in cm."""
        heading = math.radians(self.pose.heading)
        cos, sin = math.cos(heading), math.sin(heading)
        x, y = point.x - self.pose.x_cm, point.y - self.pose.y_cm
        return (
            direction.x * cos + direction.y * sin,
            direction.y * cos - direction.x * sin,
            x * direction.y - y * direction.x,
        )

    def speed_along(self, point: Point, direction: Point) -> float:
        """Return the speed of `point` in a direction, in cm/s."""
        forward_part, side_part, lever = self._push_parts(point, direction)
        percent_cm_s = self.body.speed_cm_s / 100
        turn_radians_s = (self.right - self.left) / 200 * self._turn_radians_s
        return (
            (self.left + self.right) / 2 * percent_cm_s * forward_part
            + self.aside_cm_s * side_part
            + turn_radians_s * lever
        )

    def speed_gain(self, point: Point, direction: Point) -> float:
        """Return the increase of that speed for a push of one percent of the stall force."""
        forward_part, side_part, lever = self._push_parts(point, direction)
        full_cm_s = self.body.speed_cm_s
        straight_gain = (
            forward_part * forward_part + SLIP_RATIO * side_part * side_part
        ) * full_cm_s
        return (straight_gain + (self._turn_radians_s * lever) ** 2 / full_cm_s) / 100

    def push(self, point: Point, direction: Point, percent: float) -> None:
        forward_part, side_part, lever = self._push_parts(point, direction)
        full_cm_s = self.body.speed_cm_s
        turn_share = lever * self._turn_radians_s / full_cm_s
        self.left += percent * (forward_part - turn_share)
        self.right += percent * (forward_part + turn_share)
        self.aside_cm_s += percent / 100 * SLIP_RATIO * side_part * full_cm_s

    def move(self) -> None:
        old_pose = self.pose
        if not (self.left or self.right or self.aside_cm_s):
            return
        new_pose = move_pose(self.body, old_pose, self.left, self.right, TICK_MS)
        heading = math.radians(old_pose.heading)
        slid_cm = self.aside_cm_s * TICK_MS / 1000
        self.move_to(
            Pose(
                new_pose.x_cm - slid_cm * math.sin(heading),
                new_pose.y_cm + slid_cm * math.cos(heading),
                new_pose.heading,
            )
        )

    def move_to(self, pose: Pose) -> None:
        turned_cm = abs(math.radians(pose.heading - self.pose.heading)) * self.hull.reach_cm
        self._free_cm -= math.dist(pose[:2], self.pose[:2]) + turned_cm
        self.pose = pose
        self._spine = None

    def spine(self) -> Segment:
        if self._spine is None:
            self._spine = self.hull.spine(self.pose)
        return self._spine

    def shift(self, direction: Point, cm: float) -> None:
        x_cm, y_cm, heading = self.pose
        self.move_to(Pose(x_cm + direction.x * cm, y_cm + direction.y * cm, heading))

    def nearest_contact(self, obstacles: Sequence[Segment]) -> Contact | None:
        """Return the nearest obstacle, or None if none is near."""
        if self._free_cm > TOUCH_CM or not obstacles:
            return None
        contact = self.hull.contact(self.pose, obstacles)
        assert contact is not None
        self._free_cm = contact.gap_cm
        return contact


def rival_body(rival: Rival) -> Body:
    """Return the body of a rival: its wheels are at its sides, and do not slip when it turns."""
    turn_s = math.degrees(2 * rival.speed_cm_s / rival.width_cm)
    sizes = (rival.width_cm, rival.speed_cm_s, turn_s, rival.length_cm, rival.width_cm)
    return Body(*sizes, {})


def rival_hull(rival: Rival) -> Hull:
    return Hull(rival_body(rival))


class Opponent(Mover):
    """A rival, and what it is about to do."""

    def __init__(self, rival: Rival, rings: Sequence[Ring]) -> None:
        super().__init__(rival_body(rival), rival.start)
        self._power = rival.power_percent
        self._rings = rings
        # Time in ms, and powers of its wheels.
        self._manoeuvres: list[tuple[float, tuple[float, float]]] = []
        self.is_out = False
        self.has_stopped = False  # whether the bout is over

    def decide(self, target: Segment) -> None:
        power = self._power
        if self.is_out or self.has_stopped or not power:
            self.wanted_speeds = STANDSTILL
            return
        if not self._manoeuvres and self._is_at_edge():
            around_ms = TURN_AWAY_DEGREES / (self.body.turn_s * power / 100) * 1000
            self._manoeuvres = [(BACK_UP_MS, (-power, -power)), (around_ms, (-power, power))]
        if self._manoeuvres:
            (left_ms, self.wanted_speeds), *later_manoeuvres = self._manoeuvres
            left_ms -= DECISION_INTERVAL_MS
            self._manoeuvres = (
                [(left_ms, self.wanted_speeds), *later_manoeuvres]
                if left_ms > 0
                else later_manoeuvres
            )
        elif self._sees(target):
            self.wanted_speeds = (power, power)
        else:
            self.wanted_speeds = (-power / 2, power / 2)

    def _is_at_edge(self) -> bool:
        heading, front = math.radians(self.pose.heading), self.hull.reach_cm
        x, y = (
            self.pose.x_cm + front * math.cos(heading),
            self.pose.y_cm + front * math.sin(heading),
        )
        return bool(self._rings) and not any(ring.is_dark(x, y) for ring in self._rings)

    def _sees(self, target: Segment) -> bool:
        gap_cm, _, point = gap_between(
            Segment(Point(*self.pose[:2]), Point(*self.pose[:2])), target
        )
        angle = math.atan2(point.y - self.pose.y_cm, point.x - self.pose.x_cm)
        angle = (angle - math.radians(self.pose.heading) + math.pi) % (2 * math.pi) - math.pi
        return gap_cm <= SIGHT_CM and abs(angle) <= SIGHT_RADIANS


class Bout(Driving):
    """A robot and its rivals. Contacts, and its `bumps`, are those with things that do not move."""

    def __init__(self, body: Body, world: World) -> None:
        self._rings = world.rings
        self._rivals = [Opponent(rival, world.rings) for rival in world.rivals]
        self._outlines: list[Segment] | None = None
        super().__init__(body, world.obstacles(), world.start)
        self._robot = Mover(body, world.start)
        self._movers: list[Mover] = [self._robot, *self._rivals]
        self._ticks = 0  # ticks since the robot began to move
        self._has_begun = False
        self._is_at_wall = False

    @property
    def rivals(self) -> list[Pose]:
        return [rival.pose for rival in self._rivals]

    @property
    def pushed_out_count(self) -> int:
        return sum(rival.is_out for rival in self._rivals)

    def bodies(self) -> list[tuple[Hull, Pose]]:
        """Return the outlines of all that moves, the robot's first, and where they are."""
        return [(mover.hull, mover.pose) for mover in self._movers]

    def other_outlines(self) -> list[Segment]:
        # asked many times in a millisecond
        if self._outlines is None:
            self._outlines = []
            for rival in self._rivals:
                corners = rival.hull.outline(rival.pose, OUTLINE_CORNERS)
                self._outlines += join_points([*corners, corners[0]])
        return self._outlines

    def is_blocked(self) -> bool:
        return super().is_blocked() or any(
            self._gap(self._robot, rival)[0] < 0 for rival in self._rivals
        )

    def set_motors(self, now_ms: float, left: float, right: float) -> None:
        super().set_motors(now_ms, left, right)
        self._robot.wanted_speeds = (left, right)
        self._has_begun = self._has_begun or bool(left or right)

    def rest(self) -> None:
        for mover in self._movers:
            mover.wanted_speeds = STANDSTILL
        self._has_begun = False

    def advance_to(self, now_ms: float) -> Pose:
        while self._kept_ms + TICK_MS <= now_ms:
            self._kept_ms += TICK_MS
            if self._has_begun:
                self._tick()
        self._pose = self._robot.pose
        return self._pose

    def pose_at(self, now_ms: float) -> Pose:
        return self.advance_to(now_ms)

    # -- a millisecond ----------------------------------------------------------------------------

    def _tick(self) -> None:
        if self._ticks % DECISION_INTERVAL_MS == 0:
            for rival in self._rivals:
                rival.decide(self._robot.spine())
        self._ticks += 1
        self._outlines = None
        old_poses = [mover.pose for mover in self._movers]
        for mover in self._movers:
            mover.begin()
        self._push_all()
        for mover in self._movers:
            mover.move()
        self._separate_bodies(old_poses)
        self._record(old_poses[0])

    def _push_all(self) -> None:
        """Apply pushes between the bodies, so that touching bodies come no nearer."""
        wall_contacts = [(mover, mover.nearest_contact(self.obstacles)) for mover in self._movers]
        pairs = [
            (first, second, *self._gap(first, second))
            for first, second in combinations(self._movers, 2)
        ]
        touching_pairs = [pair for pair in pairs if pair[2] < PUSHING_CM]
        # A single contact depends on its own two pushes only.
        sweeps = (
            MAX_SWEEPS
            if len(touching_pairs) > 1 or any(contact for _, contact in wall_contacts)
            else 2
        )
        for _ in range(sweeps if touching_pairs else 1):
            for first, second, _, own_point, other_point in touching_pairs:
                direction = _direction(other_point, own_point)
                radius = second.hull.radius_cm
                point = Point(
                    other_point.x + direction.x * radius, other_point.y + direction.y * radius
                )
                percent = _push_apart(first, second, point, direction, math.inf)
                _push_apart(first, second, point, Point(-direction.y, direction.x), GRIP * percent)
            for mover, contact in wall_contacts:
                if contact is None or contact.gap_cm >= PUSHING_CM:
                    continue
                direction = _direction(contact.obstacle_point, contact.body_point)
                closing_cm_s = mover.speed_along(contact.body_point, direction)
                if closing_cm_s < 0:
                    speed_gain = mover.speed_gain(contact.body_point, direction)
                    mover.push(contact.body_point, direction, -closing_cm_s / speed_gain)

    def _separate_bodies(self, old_poses: Sequence[Pose]) -> None:
        """Move bodies apart that have come into each other, or into an obstacle.

        If that is impossible, they stay where they were.
        """
        for _ in range(MAX_PUSHES):
            if self._separate_once():
                return
        for mover, pose in zip(self._movers, old_poses, strict=True):
            mover.move_to(pose)

    def _separate_once(self) -> bool:
        """Move what overlaps; return whether nothing has."""
        is_parted = True
        for first, second in combinations(self._movers, 2):
            gap, own_point, other_point = self._gap(first, second)
            if gap < -EXACT_CM:
                direction = _direction(other_point, own_point)
                first.shift(direction, -gap / 2)
                second.shift(Point(-direction.x, -direction.y), -gap / 2)
                is_parted = False
        for mover in self._movers:
            contact = mover.nearest_contact(self.obstacles)
            if contact is not None and contact.gap_cm < -EXACT_CM:
                direction = _direction(contact.obstacle_point, contact.body_point)
                mover.shift(direction, -contact.gap_cm)
                is_parted = False
        return is_parted

    @staticmethod
    def _gap(first: Mover, second: Mover) -> tuple[float, Point, Point]:
        """Return the distance of two bodies, and the nearest points of their spines."""
        distance_cm, own_point, other_point = gap_between(first.spine(), second.spine())
        return distance_cm - first.hull.radius_cm - second.hull.radius_cm, own_point, other_point

    def _record(self, old_pose: Pose) -> None:
        """Take down the way, what it bumps into, and who has left the ring."""
        pose = self._robot.pose
        self.driven_cm += math.dist(pose[:2], old_pose[:2])
        if self._ticks % CORNER_INTERVAL_MS == 0:
            self._keep_corner(pose)
        contact = self._robot.nearest_contact(self.obstacles)
        is_at_wall = contact is not None and contact.gap_cm < TOUCH_CM
        self.bumps += is_at_wall and not self._is_at_wall
        self._is_at_wall = is_at_wall
        if not self._rings or self.has_fallen:
            return
        if not self._is_inside(pose):
            self.has_fallen = True
            for rival in self._rivals:
                rival.has_stopped = True
            return
        for rival in self._rivals:
            rival.is_out = rival.is_out or not self._is_inside(rival.pose)

    def _is_inside(self, pose: Pose) -> bool:
        return any(ring.holds(*pose[:2]) for ring in self._rings)


def _push_apart(
    first: Mover, second: Mover, point: Point, direction: Point, most_percent: float
) -> float:
    """Push two bodies at a place, so that they come no nearer along `direction`; return how much.

    With a `most_percent`, so that they slide neither way.
    """
    opposite = Point(-direction.x, -direction.y)
    closing_cm_s = first.speed_along(point, direction) + second.speed_along(point, opposite)
    percent = -closing_cm_s / (
        first.speed_gain(point, direction) + second.speed_gain(point, opposite)
    )
    percent = (
        max(0.0, percent)
        if most_percent == math.inf
        else max(-most_percent, min(most_percent, percent))
    )
    first.push(point, direction, percent)
    second.push(point, opposite, percent)
    return percent


def _direction(start: Point, end: Point) -> Point:
    """Return the direction from a point to another, of length 1."""
    distance_cm = math.dist(start, end)
    return (
        Point((end.x - start.x) / distance_cm, (end.y - start.y) / distance_cm)
        if distance_cm
        else Point(1.0, 0.0)
    )


def driving_in(body: Body, world: World) -> Driving:
    """Return the driving of a body in a world, alone or among rivals."""
    return Bout(body, world) if world.rivals else Driving(body, world.obstacles(), world.start)
