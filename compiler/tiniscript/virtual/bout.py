"""The path of a robot among rivals: bodies that drive, push it and are pushed.

A push slows down the wheels of whom it meets, as that of a wall does (`driving`): both bodies get
the same push, as large as it takes that neither comes into the other. Unlike a wall's, it also
moves a body aside, whose wheels slip then. All happens on a grid of milliseconds, so nothing
depends on when it is asked.

A rival begins when the robot first moves. It drives at the robot that is before it, looks around
where none is, and turns back at the edge of a ring.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import combinations

from tiniscript.robots.kinematics import Pose, move_pose
from tiniscript.robots.profile import Body
from tiniscript.virtual.driving import (
    EXACT_CM,
    MOST_PUSHES,
    PUSHING_CM,
    TOUCH_CM,
    Contact,
    Driving,
    Hull,
)
from tiniscript.virtual.geometry import Point, Segment, gap_between, join_points
from tiniscript.virtual.world import Ring, Rival, World

TICK_MS = 1.0
KEPT_MS = 20.0  # between two corners of the way
SWEEPS = 4  # over all contacts, until no two bodies come nearer to each other
GRIP = 0.7  # how much of a push holds the bodies together where they touch, so that none slides off
SLIPS = 0.5  # how far a push from the side moves a body, of what it would do from behind
DECIDES_MS = 10.0  # of a rival: between two looks
SIGHT_CM, SIGHT = 100.0, math.radians(25)  # how far a rival sees, and to both sides
BACK_MS, AROUND = 300.0, 150.0  # at an edge: it goes back so long, and turns by so many degrees
CORNERS = 16  # of what a distance sensor sees of a rival
NOBODY: tuple[float, float] = (0.0, 0.0)


class Mover:
    """A body that drives and is pushed: where it is, what its wheels do, and how it slips aside."""

    def __init__(self, body: Body, pose: Pose) -> None:
        self.body = body
        self.hull = Hull(body)
        self.pose = pose
        self.wanted = NOBODY  # percent of each wheel, as its motors are set
        self.left = self.right = 0.0  # and as it goes
        self.aside = 0.0  # cm in a second, to its left
        self._turn = math.radians(body.turn_s)
        self._spine: Segment | None = None
        self._free_cm = 0.0  # no obstacle is nearer

    def begin(self) -> None:
        (self.left, self.right), self.aside = self.wanted, 0.0

    def _parts(self, point: Point, away: Point) -> tuple[float, float, float]:
        """Return how much of a push is along it, aside, and turns it: its lever in cm."""
        along = math.radians(self.pose.heading)
        cos, sin = math.cos(along), math.sin(along)
        x, y = point.x - self.pose.x_cm, point.y - self.pose.y_cm
        return away.x * cos + away.y * sin, away.y * cos - away.x * sin, x * away.y - y * away.x

    def speed_along(self, point: Point, away: Point) -> float:
        """Return how fast its `point` goes in a direction, in cm/s."""
        ahead, aside, lever = self._parts(point, away)
        full = self.body.speed_cm_s / 100
        turning = (self.right - self.left) / 200 * self._turn
        return (self.left + self.right) / 2 * full * ahead + self.aside * aside + turning * lever

    def ease(self, point: Point, away: Point) -> float:
        """Return by how much that grows with a push of one percent of what stalls it."""
        ahead, aside, lever = self._parts(point, away)
        full = self.body.speed_cm_s
        straight = (ahead * ahead + SLIPS * aside * aside) * full
        return (straight + (self._turn * lever) ** 2 / full) / 100

    def push(self, point: Point, away: Point, percent: float) -> None:
        ahead, aside, lever = self._parts(point, away)
        full = self.body.speed_cm_s
        turning = lever * self._turn / full
        self.left += percent * (ahead - turning)
        self.right += percent * (ahead + turning)
        self.aside += percent / 100 * SLIPS * aside * full

    def go(self) -> None:
        before = self.pose
        if not (self.left or self.right or self.aside):
            return
        moved = move_pose(self.body, before, self.left, self.right, TICK_MS)
        along = math.radians(before.heading)
        slid = self.aside * TICK_MS / 1000
        self.put(
            Pose(
                moved.x_cm - slid * math.sin(along),
                moved.y_cm + slid * math.cos(along),
                moved.heading,
            )
        )

    def put(self, pose: Pose) -> None:
        turned = abs(math.radians(pose.heading - self.pose.heading)) * self.hull.reach_cm
        self._free_cm -= math.dist(pose[:2], self.pose[:2]) + turned
        self.pose = pose
        self._spine = None

    def spine(self) -> Segment:
        if self._spine is None:
            self._spine = self.hull.spine(self.pose)
        return self._spine

    def shift(self, away: Point, cm: float) -> None:
        x_cm, y_cm, heading = self.pose
        self.put(Pose(x_cm + away.x * cm, y_cm + away.y * cm, heading))

    def nearest(self, obstacles: Sequence[Segment]) -> Contact | None:
        """Return the nearest obstacle, or None where none is near."""
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
        self._does: list[tuple[float, tuple[float, float]]] = []  # ms, and what its wheels do
        self.is_out = False
        self.stands = False  # for ever: the bout is over

    def decide(self, target: Segment) -> None:
        power = self._power
        if self.is_out or self.stands or not power:
            self.wanted = NOBODY
            return
        if not self._does and self._is_at_edge():
            around_ms = AROUND / (self.body.turn_s * power / 100) * 1000
            self._does = [(BACK_MS, (-power, -power)), (around_ms, (-power, power))]
        if self._does:
            (left_ms, self.wanted), *later = self._does
            left_ms -= DECIDES_MS
            self._does = [(left_ms, self.wanted), *later] if left_ms > 0 else later
        elif self._sees(target):
            self.wanted = (power, power)
        else:
            self.wanted = (-power / 2, power / 2)

    def _is_at_edge(self) -> bool:
        along, front = math.radians(self.pose.heading), self.hull.reach_cm
        x, y = self.pose.x_cm + front * math.cos(along), self.pose.y_cm + front * math.sin(along)
        return bool(self._rings) and not any(ring.is_dark(x, y) for ring in self._rings)

    def _sees(self, target: Segment) -> bool:
        apart, _, point = gap_between(Segment(Point(*self.pose[:2]), Point(*self.pose[:2])), target)
        off = math.atan2(point.y - self.pose.y_cm, point.x - self.pose.x_cm)
        off = (off - math.radians(self.pose.heading) + math.pi) % (2 * math.pi) - math.pi
        return apart <= SIGHT_CM and abs(off) <= SIGHT


class Bout(Driving):
    """A robot and its rivals. What it touches, and its `bumps`, is what stands still."""

    def __init__(self, body: Body, world: World) -> None:
        self._rings = world.rings
        self._rivals = [Opponent(rival, world.rings) for rival in world.rivals]
        self._outlines: list[Segment] | None = None
        super().__init__(body, world.obstacles(), world.start)
        self._robot = Mover(body, world.start)
        self._all: list[Mover] = [self._robot, *self._rivals]
        self._ticks = 0  # since the robot has begun to move
        self._has_begun = False
        self._is_at_wall = False

    @property
    def rivals(self) -> list[Pose]:
        return [rival.pose for rival in self._rivals]

    @property
    def pushed_out(self) -> int:
        return sum(rival.is_out for rival in self._rivals)

    def bodies(self) -> list[tuple[Hull, Pose]]:
        """Return the outlines of all that moves, the robot's first, and where they are."""
        return [(each.hull, each.pose) for each in self._all]

    def others(self) -> list[Segment]:
        # asked many times in a millisecond
        if self._outlines is None:
            self._outlines = []
            for rival in self._rivals:
                corners = rival.hull.outline(rival.pose, CORNERS)
                self._outlines += join_points([*corners, corners[0]])
        return self._outlines

    def is_blocked(self) -> bool:
        return super().is_blocked() or any(
            self._gap(self._robot, rival)[0] < 0 for rival in self._rivals
        )

    def set_motors(self, now_ms: float, left: float, right: float) -> None:
        super().set_motors(now_ms, left, right)
        self._robot.wanted = (left, right)
        self._has_begun = self._has_begun or bool(left or right)

    def rest(self) -> None:
        for each in self._all:
            each.wanted = NOBODY
        self._has_begun = False

    def go_on(self, now_ms: float) -> Pose:
        while self._kept_ms + TICK_MS <= now_ms:
            self._kept_ms += TICK_MS
            if self._has_begun:
                self._tick()
        self._pose = self._robot.pose
        return self._pose

    def look(self, now_ms: float) -> Pose:
        return self.go_on(now_ms)

    # -- a millisecond ----------------------------------------------------------------------------

    def _tick(self) -> None:
        if self._ticks % DECIDES_MS == 0:
            for rival in self._rivals:
                rival.decide(self._robot.spine())
        self._ticks += 1
        self._outlines = None
        before = [each.pose for each in self._all]
        for each in self._all:
            each.begin()
        self._push_all()
        for each in self._all:
            each.go()
        self._part_all(before)
        self._note(before[0])

    def _push_all(self) -> None:
        """Have the bodies push each other, so that no two come nearer where they touch."""
        walls = [(each, each.nearest(self.obstacles)) for each in self._all]
        pairs = [(one, other, *self._gap(one, other)) for one, other in combinations(self._all, 2)]
        touching = [pair for pair in pairs if pair[2] < PUSHING_CM]
        # where one contact is all, only its two pushes change each other
        sweeps = SWEEPS if len(touching) > 1 or any(contact for _, contact in walls) else 2
        for _ in range(sweeps if touching else 1):
            for one, other, _, ours, theirs in touching:
                away = _direction(theirs, ours)
                radius = other.hull.radius_cm
                place = Point(theirs.x + away.x * radius, theirs.y + away.y * radius)
                percent = _push_apart(one, other, place, away, math.inf)
                _push_apart(one, other, place, Point(-away.y, away.x), GRIP * percent)
            for each, contact in walls:
                if contact is None or contact.gap_cm >= PUSHING_CM:
                    continue
                away = _direction(contact.obstacle_point, contact.body_point)
                comes = each.speed_along(contact.body_point, away)
                if comes < 0:
                    ease = each.ease(contact.body_point, away)
                    each.push(contact.body_point, away, -comes / ease)

    def _part_all(self, before: Sequence[Pose]) -> None:
        """Move bodies apart that have come into each other, or into an obstacle.

        Where that cannot be done they stay where they were.
        """
        for _ in range(MOST_PUSHES):
            if self._is_parted():
                return
        for each, pose in zip(self._all, before, strict=True):
            each.put(pose)

    def _is_parted(self) -> bool:
        """Move what overlaps; return whether nothing has."""
        is_parted = True
        for one, other in combinations(self._all, 2):
            gap, ours, theirs = self._gap(one, other)
            if gap < -EXACT_CM:
                away = _direction(theirs, ours)
                one.shift(away, -gap / 2)
                other.shift(Point(-away.x, -away.y), -gap / 2)
                is_parted = False
        for each in self._all:
            contact = each.nearest(self.obstacles)
            if contact is not None and contact.gap_cm < -EXACT_CM:
                away = _direction(contact.obstacle_point, contact.body_point)
                each.shift(away, -contact.gap_cm)
                is_parted = False
        return is_parted

    @staticmethod
    def _gap(one: Mover, other: Mover) -> tuple[float, Point, Point]:
        """Return how far two bodies are apart, and the nearest points of their spines."""
        apart, ours, theirs = gap_between(one.spine(), other.spine())
        return apart - one.hull.radius_cm - other.hull.radius_cm, ours, theirs

    def _note(self, before: Pose) -> None:
        """Take down the way, what it bumps into, and who has left the ring."""
        pose = self._robot.pose
        self.driven_cm += math.dist(pose[:2], before[:2])
        if self._ticks % KEPT_MS == 0:
            self._keep_corner(pose)
        contact = self._robot.nearest(self.obstacles)
        is_at_wall = contact is not None and contact.gap_cm < TOUCH_CM
        self.bumps += is_at_wall and not self._is_at_wall
        self._is_at_wall = is_at_wall
        if not self._rings or self.has_fallen:
            return
        if not self._is_inside(pose):
            self.has_fallen = True
            for rival in self._rivals:
                rival.stands = True
            return
        for rival in self._rivals:
            rival.is_out = rival.is_out or not self._is_inside(rival.pose)

    def _is_inside(self, pose: Pose) -> bool:
        return any(ring.holds(*pose[:2]) for ring in self._rings)


def _push_apart(one: Mover, other: Mover, place: Point, away: Point, most: float) -> float:
    """Push two bodies at a place, so that they come no nearer along `away`; return how much.

    With a `most`, so that they slide neither way.
    """
    back = Point(-away.x, -away.y)
    comes = one.speed_along(place, away) + other.speed_along(place, back)
    percent = -comes / (one.ease(place, away) + other.ease(place, back))
    percent = max(0.0, percent) if most == math.inf else max(-most, min(most, percent))
    one.push(place, away, percent)
    other.push(place, back, percent)
    return percent


def _direction(start: Point, end: Point) -> Point:
    """Return the direction from a point to another, of length 1."""
    apart = math.dist(start, end)
    return Point((end.x - start.x) / apart, (end.y - start.y) / apart) if apart else Point(1.0, 0.0)


def driving_in(body: Body, world: World) -> Driving:
    """Return how a body drives in a world, alone or among rivals."""
    return Bout(body, world) if world.rivals else Driving(body, world.obstacles(), world.start)
