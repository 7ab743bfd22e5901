"""Straight lines on a floor: how far they are from each other, and what is seen of them.

All lengths are centimetres, all angles radians. Knows no robots and no worlds.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import NamedTuple


class Point(NamedTuple):
    x: float
    y: float


class Segment(NamedTuple):
    """A straight line from one point to another; both may be the same."""

    a: Point
    b: Point


def joined(points: list[Point]) -> list[Segment]:
    """Return the lines from point to point."""
    return [Segment(a, b) for a, b in pairwise(points)]


def nearest(segment: Segment, x: float, y: float) -> Point:
    """Return the point of a segment that is nearest to a place."""
    (ax, ay), (bx, by) = segment
    dx, dy = bx - ax, by - ay
    length = dx * dx + dy * dy
    if not length:
        return segment.a
    along = ((x - ax) * dx + (y - ay) * dy) / length
    along = 0.0 if along < 0 else 1.0 if along > 1 else along
    return Point(ax + along * dx, ay + along * dy)


def distance(segment: Segment, x: float, y: float) -> float:
    point = nearest(segment, x, y)
    return math.hypot(point.x - x, point.y - y)


def crosses(one: Segment, other: Segment) -> bool:
    """Whether two segments have a point in common, where neither only touches the other's end."""
    (ax, ay), (bx, by) = one
    (cx, cy), (dx, dy) = other

    def side(px: float, py: float, qx: float, qy: float, rx: float, ry: float) -> float:
        return (qx - px) * (ry - py) - (qy - py) * (rx - px)

    return (
        side(ax, ay, bx, by, cx, cy) * side(ax, ay, bx, by, dx, dy) < 0
        and side(cx, cy, dx, dy, ax, ay) * side(cx, cy, dx, dy, bx, by) < 0
    )


def between(one: Segment, other: Segment) -> tuple[float, Point, Point]:
    """Return how far two segments are apart, and the two points that are nearest.

    Where they cross, the distance is 0 and the points are any.
    """
    if crosses(one, other):
        return 0.0, one.a, one.a
    pairs = [(end, nearest(other, *end)) for end in one]
    pairs += [(nearest(one, *end), end) for end in other]
    return min((math.dist(ours, theirs), ours, theirs) for ours, theirs in pairs)


def seen(segment: Segment, eye: Point, heading: float, half_angle: float) -> float | None:
    """Return how near a segment comes to an eye inside its cone, or None where it is outside.

    The cone is `half_angle` (less than a quarter turn) to both sides of `heading`. The nearest
    of all segments hides nothing and is hidden by nothing, so the least of these is what an echo
    tells.
    """
    low, high = 0.0, 1.0  # the part of the segment inside
    (ax, ay), (bx, by) = segment
    ax, ay, bx, by = ax - eye.x, ay - eye.y, bx - eye.x, by - eye.y
    for angle, sign in ((heading - half_angle, 1), (heading + half_angle, -1)):
        # on which side of this border of the cone each end is; 0 or more is inside
        cos, sin = math.cos(angle), math.sin(angle)
        at_a, at_b = sign * (cos * ay - sin * ax), sign * (cos * by - sin * bx)
        if at_a < 0 and at_b < 0:
            return None
        if at_a < 0 or at_b < 0:
            border = at_a / (at_a - at_b)
            if at_a < 0:
                low = max(low, border)
            else:
                high = min(high, border)
    if low > high:
        return None
    dx, dy = bx - ax, by - ay
    inside = Segment(Point(ax + low * dx, ay + low * dy), Point(ax + high * dx, ay + high * dy))
    return distance(inside, 0.0, 0.0)
