"""Straight lines on a floor: how far they are from each other, and what is seen of them.

All lengths are centimetres, all angles radians. Knows no robots and no worlds.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import pairwise
from typing import NamedTuple


class Point(NamedTuple):
    x: float
    y: float


class Segment(NamedTuple):
    """A straight line from one point to another; both may be the same."""

    a: Point
    b: Point


def join_points(points: list[Point]) -> list[Segment]:
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
    (ax, ay), (bx, by) = segment
    dx, dy = bx - ax, by - ay
    length = dx * dx + dy * dy
    along = ((x - ax) * dx + (y - ay) * dy) / length if length else 0.0
    if along > 1:
        return math.hypot(bx - x, by - y)
    return (
        math.hypot(ax - x, ay - y)
        if along < 0
        else math.hypot(ax + along * dx - x, ay + along * dy - y)
    )


def crosses(one: Segment, other: Segment) -> bool:
    """Whether two segments have a point in common, where neither only touches the other's end."""
    (ax, ay), (bx, by) = one
    (cx, cy), (dx, dy) = other
    # on which side of one line the ends of the other are
    ux, uy, vx, vy = bx - ax, by - ay, dx - cx, dy - cy
    if (ux * (cy - ay) - uy * (cx - ax)) * (ux * (dy - ay) - uy * (dx - ax)) >= 0:
        return False
    return (vx * (ay - cy) - vy * (ax - cx)) * (vx * (by - cy) - vy * (bx - cx)) < 0


def gap_between(one: Segment, other: Segment) -> tuple[float, Point, Point]:
    """Return how far two segments are apart, and the two points that are nearest.

    Where they cross, the distance is 0 and the points are any.
    """
    if crosses(one, other):
        return 0.0, one.a, one.a
    ends = (
        (distance(other, *one.a), 0),
        (distance(other, *one.b), 1),
        (distance(one, *other.a), 2),
        (distance(one, *other.b), 3),
    )
    apart, which = min(ends)
    if which < 2:
        return apart, one[which], nearest(other, *one[which])
    end = other[which - 2]
    return apart, nearest(one, *end), end


def nearest_seen(
    segments: Iterable[Segment], eye: Point, heading: float, half_angle: float
) -> float | None:
    """Return how near segments come to an eye inside its cone, or None where none is in it.

    The cone is `half_angle` (less than a quarter turn) to both sides of `heading`. The nearest
    of all segments hides nothing and is hidden by nothing, so it is what an echo tells.
    """
    right_cos, right_sin = math.cos(heading - half_angle), math.sin(heading - half_angle)
    left_cos, left_sin = math.cos(heading + half_angle), math.sin(heading + half_angle)
    best: float | None = None
    for (ax, ay), (bx, by) in segments:
        ax, ay, bx, by = ax - eye.x, ay - eye.y, bx - eye.x, by - eye.y
        # on which side of each border of the cone each end is; 0 or more is inside
        right_a, right_b = right_cos * ay - right_sin * ax, right_cos * by - right_sin * bx
        left_a, left_b = left_sin * ax - left_cos * ay, left_sin * bx - left_cos * by
        if (right_a < 0 and right_b < 0) or (left_a < 0 and left_b < 0):
            continue
        low, high = 0.0, 1.0  # the part of the segment inside
        for at_a, at_b in ((right_a, right_b), (left_a, left_b)):
            if at_a < 0:
                low = max(low, at_a / (at_a - at_b))
            elif at_b < 0:
                high = min(high, at_a / (at_a - at_b))
        if low > high:
            continue
        dx, dy = bx - ax, by - ay
        first, last = Point(ax + low * dx, ay + low * dy), Point(ax + high * dx, ay + high * dy)
        result = distance(Segment(first, last), 0.0, 0.0)
        if best is None or result < best:
            best = result
    return best
