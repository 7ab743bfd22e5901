"""Line segments on a floor: their distances, and their visibility.

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


def nearest_point(segment: Segment, x: float, y: float) -> Point:
    """Return the point of a segment that is nearest to a place."""
    (ax, ay), (bx, by) = segment
    dx, dy = bx - ax, by - ay
    length = dx * dx + dy * dy
    if not length:
        return segment.a
    fraction = ((x - ax) * dx + (y - ay) * dy) / length
    fraction = 0.0 if fraction < 0 else 1.0 if fraction > 1 else fraction
    return Point(ax + fraction * dx, ay + fraction * dy)


def distance(segment: Segment, x: float, y: float) -> float:
    (ax, ay), (bx, by) = segment
    dx, dy = bx - ax, by - ay
    length = dx * dx + dy * dy
    fraction = ((x - ax) * dx + (y - ay) * dy) / length if length else 0.0
    if fraction > 1:
        return math.hypot(bx - x, by - y)
    return (
        math.hypot(ax - x, ay - y)
        if fraction < 0
        else math.hypot(ax + fraction * dx - x, ay + fraction * dy - y)
    )


def crosses(segment: Segment, other: Segment) -> bool:
    """Return whether two segments cross, other than by touching an end."""
    (ax, ay), (bx, by) = segment
    (cx, cy), (dx, dy) = other
    # The sides of one line on which the other's ends are.
    ux, uy, vx, vy = bx - ax, by - ay, dx - cx, dy - cy
    if (ux * (cy - ay) - uy * (cx - ax)) * (ux * (dy - ay) - uy * (dx - ax)) >= 0:
        return False
    return (vx * (ay - cy) - vy * (ax - cx)) * (vx * (by - cy) - vy * (bx - cx)) < 0


def gap_between(segment: Segment, other: Segment) -> tuple[float, Point, Point]:
    """Return the distance between two segments, and their nearest points.

    If they cross, the distance is 0 and the points are arbitrary.
    """
    if crosses(segment, other):
        return 0.0, segment.a, segment.a
    end_gaps = (
        (distance(other, *segment.a), 0),
        (distance(other, *segment.b), 1),
        (distance(segment, *other.a), 2),
        (distance(segment, *other.b), 3),
    )
    gap, end_number = min(end_gaps)
    if end_number < 2:
        return gap, segment[end_number], nearest_point(other, *segment[end_number])
    end = other[end_number - 2]
    return gap, nearest_point(segment, *end), end


def nearest_seen(
    segments: Iterable[Segment], eye: Point, heading: float, half_angle: float
) -> float | None:
    """Return the distance of the nearest segment inside an eye's cone, or None.

    The cone is `half_angle` (less than a quarter turn) to both sides of `heading`. The nearest
    of all segments hides nothing and is hidden by nothing, so it is what an echo tells.
    """
    right_cos, right_sin = math.cos(heading - half_angle), math.sin(heading - half_angle)
    left_cos, left_sin = math.cos(heading + half_angle), math.sin(heading + half_angle)
    nearest_distance: float | None = None
    for (ax, ay), (bx, by) in segments:
        ax, ay, bx, by = ax - eye.x, ay - eye.y, bx - eye.x, by - eye.y
        # The side of each border of the cone for both ends; 0 or more is inside.
        right_a, right_b = right_cos * ay - right_sin * ax, right_cos * by - right_sin * bx
        left_a, left_b = left_sin * ax - left_cos * ay, left_sin * bx - left_cos * by
        if (right_a < 0 and right_b < 0) or (left_a < 0 and left_b < 0):
            continue
        low, high = 0.0, 1.0  # the part of the segment inside
        for side_a, side_b in ((right_a, right_b), (left_a, left_b)):
            if side_a < 0:
                low = max(low, side_a / (side_a - side_b))
            elif side_b < 0:
                high = min(high, side_a / (side_a - side_b))
        if low > high:
            continue
        dx, dy = bx - ax, by - ay
        start, end = Point(ax + low * dx, ay + low * dy), Point(ax + high * dx, ay + high * dy)
        segment_distance = distance(Segment(start, end), 0.0, 0.0)
        if nearest_distance is None or segment_distance < nearest_distance:
            nearest_distance = segment_distance
    return nearest_distance
