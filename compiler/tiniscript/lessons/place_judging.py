"""Compares where a robot was with the criteria of a lesson that name places."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise

from tiniscript.lessons.findings import (
    STILL_CM,
    Finding,
    Task,
    TrackPoint,
    in_cm,
    in_seconds,
    points_between,
)
from tiniscript.lessons.lesson import Criterion
from tiniscript.lessons.running import DONE, LIMIT, STEP_MS, Run
from tiniscript.lessons.variation import shape_of
from tiniscript.robots.kinematics import Pose
from tiniscript.virtual.geometry import Point, distance, nearest_seen
from tiniscript.virtual.sensing import CONE_RADIANS

BACK_CM = 5.0  # nearer than where it was farthest: then it was on its way back
OTHER_WAY_DEGREES = 150.0
STRETCH_CM, APPROACH_SHARE = 20.0, 0.9  # the end of a way, and how much of it must lead to a place


def _end(run: Run) -> Pose:
    return run.track[-1].pose


def _is_outside(criterion: Criterion, task: Task, points: Iterable[Point]) -> bool:
    """Whether one of the points is not in the area of a criterion."""
    assert criterion.area is not None
    (left, right), (low, high) = criterion.area
    if task.mirrored:
        low, high = -high, -low
    x, y = task.point(criterion)
    return not all(left <= point.x - x <= right and low <= point.y - y <= high for point in points)


def _judge_final_place(criterion: Criterion, task: Task) -> Finding | None:
    place, run = task.point(criterion), task.run
    within_cm = criterion.numbers["within_cm"]
    start, end = run.world.start, _end(run)
    away_cm = math.dist(place, end[:2])
    is_missed = away_cm > within_cm
    if criterion.area:
        is_missed = _is_outside(criterion, task, run.robot.driving.hull.outline(end))
    if not is_missed:
        return None
    way_cm = math.dist(place, start[:2])
    gaps_cm = [math.dist(place, pose[:2]) for _, pose in run.track]
    key = "away"
    if way_cm > within_cm:  # else it should come back
        ux, uy = (place.x - start.x_cm) / way_cm, (place.y - start.y_cm) / way_cm
        dx, dy = end.x_cm - start.x_cm, end.y_cm - start.y_cm
        along_cm, beside_cm = dx * ux + dy * uy, abs(dy * ux - dx * uy)
        if math.dist(start[:2], end[:2]) < STILL_CM:
            key = "turned" if run.driven_cm < STILL_CM else "away"
        elif beside_cm <= within_cm and along_cm >= 0:
            key = "short" if along_cm < way_cm else "far"
        if key in ("short", "away") and min(gaps_cm) <= within_cm:
            key = "left"
    elif away_cm > max(gaps_cm) - BACK_CM and not _came_back(gaps_cm, within_cm):
        key = "gone"
    return Finding("ends_in", f"ends_in/{key}", {"cm": in_cm(away_cm)}, criterion.labels)


def _came_back(gaps_cm: list[float], within_cm: float) -> bool:
    """Whether it had left a place, and came by there again."""
    left = next((k for k, gap in enumerate(gaps_cm) if gap > within_cm), len(gaps_cm))
    return any(gap <= within_cm for gap in gaps_cm[left:])


def _judge_places(criterion: Criterion, task: Task) -> Finding | None:
    order = range(len(criterion.places))
    reached, finding = _count_reached(criterion, task, order)
    if finding is not None and criterion.numbers["either_way"]:
        backwards, other = _count_reached(criterion, task, order[::-1])
        finding = other if backwards > reached else finding
    return finding


def _gap(criterion: Criterion, task: Task, number: int, at: TrackPoint) -> float:
    """Return how far a place is from the robot's middle, or a part of the world from a sensor."""
    if not criterion.words:
        return math.dist(task.point(criterion, number), (at.x_cm, at.y_cm))
    sensor = task.run.robot.profile.body.places[criterion.words[0]]
    along = math.radians(at.heading)
    x = at.x_cm + sensor.x_cm * math.cos(along) - sensor.y_cm * math.sin(along)
    y = at.y_cm + sensor.x_cm * math.sin(along) + sensor.y_cm * math.cos(along)
    shape = shape_of(criterion.places[number], task.run.world, task.mirrored)
    return min(distance(segment, x, y) for segment in shape)


def _count_reached(
    criterion: Criterion, task: Task, order: Sequence[int]
) -> tuple[int, Finding | None]:
    """Return how many of its places the robot has reached in this order, and what is missing."""
    within_cm = criterion.numbers["within_cm"]
    way = points_between(task.run.track)
    points = iter(way)
    at = way[0]
    for count, number in enumerate(order):
        place = task.point(criterion, number)
        since, nearest = at, None
        nearest_cm = math.inf
        for at in points:
            gap_cm = _gap(criterion, task, number, at)
            if gap_cm < nearest_cm:
                nearest, nearest_cm = at, gap_cm
            if gap_cm <= within_cm:
                break
        else:
            values = {"number": str(number + 1), "all": str(len(criterion.places))}
            values |= {"within": f"{within_cm:g}", "seconds": in_seconds(task.run.end_ms)}
            if nearest is not None:
                values["cm"] = in_cm(nearest_cm, within_cm)
            key = _missed_sentence(criterion, task, way, since, place, nearest)
            if count and key in ("several", "time"):
                past_cm = _overshoot_cm(criterion, task, order[count - 1], since, way)
                if past_cm > within_cm:
                    key = "past"
                    values |= {"number": str(order[count - 1] + 1), "cm": in_cm(past_cm)}
            return count, Finding("reaches", f"reaches/{key}", values, criterion.labels)
    return len(order), _too_long(criterion, at)


def _overshoot_cm(
    criterion: Criterion, task: Task, number: int, since: TrackPoint, way: list[TrackPoint]
) -> float:
    """Return how far from a place that it had reached the robot stood for the first time."""
    for before, at in pairwise(way[way.index(since) :]):
        if at.way_cm == before.way_cm:
            return _gap(criterion, task, number, at)
    return 0.0


def _too_long(criterion: Criterion, at: TrackPoint) -> Finding | None:
    limit_s, limit_cm = criterion.numbers["by_seconds"], criterion.numbers["by_cm"]
    if at.ms > limit_s * 1000:
        values = {"seconds": in_seconds(at.ms), "limit": f"{limit_s:g}"}
        return Finding("reaches", "reaches/late", values, criterion.labels)
    if at.way_cm > limit_cm:
        values = {"cm": in_cm(at.way_cm, limit_cm), "limit": f"{limit_cm:g}"}
        return Finding("reaches", "reaches/around", values, criterion.labels)
    return None


def _missed_sentence(
    criterion: Criterion,
    task: Task,
    way: list[TrackPoint],
    since: TrackPoint,
    place: Point,
    nearest: TrackPoint | None,
) -> str:
    """Return the sentence for a place that the robot has missed.

    `since` is where it had to go there from; it was `nearest` at that point.
    """
    run, start = task.run, task.run.world.start
    if run.driven_cm < STILL_CM:
        return "turned"
    if len(criterion.places) > 1:
        gap_cm = math.dist(place, (since.x_cm, since.y_cm))
        if run.ending == DONE and way[-1].way_cm - since.way_cm < gap_cm / 2:
            return "ended"
        was_coming = nearest is None or run.track[-1].ms - nearest.ms <= STEP_MS
        return "time" if run.ending == LIMIT and was_coming else "several"
    if run.ending == DONE and _is_approaching(way, place):
        return "over"
    if nearest is None:
        return "one"
    if run.ending == LIMIT and nearest.way_cm >= way[-1].way_cm - STILL_CM > 0:
        return "slow"
    way_cm = math.dist(place, start[:2])
    ux, uy = (place.x - start.x_cm) / way_cm, (place.y - start.y_cm) / way_cm
    dx, dy = nearest.x_cm - start.x_cm, nearest.y_cm - start.y_cm
    is_straight = abs(dy * ux - dx * uy) <= STILL_CM and nearest.way_cm > STILL_CM
    return "short" if is_straight and 0 < dx * ux + dy * uy < way_cm else "one"


def _is_approaching(way: list[TrackPoint], place: Point) -> bool:
    """Whether the last STRETCH_CM led to a place, and never before it was nearer."""
    gaps_cm = [math.dist(place, (at.x_cm, at.y_cm)) for at in way]
    began = next(k for k, at in enumerate(way) if at.way_cm >= way[-1].way_cm - STRETCH_CM)
    gained_cm = gaps_cm[began] - gaps_cm[-1]
    return gained_cm > STRETCH_CM * APPROACH_SHARE and gaps_cm[-1] < min(gaps_cm) + STILL_CM


def _judge_area(criterion: Criterion, task: Task) -> Finding | None:
    place, within_cm = task.point(criterion), criterion.numbers["within_cm"]
    for ms, pose in task.run.track:
        is_out = math.dist(place, pose[:2]) > within_cm
        if criterion.area:
            is_out = _is_outside(criterion, task, _wheels(task.run, pose))
        if is_out:
            return Finding(
                "stays_in", "stays_in", {"seconds": in_seconds(ms)}, criterion.labels, ms
            )
    return None


def _wheels(run: Run, pose: Pose) -> list[Point]:
    half_cm = run.robot.profile.body.wheel_base_cm / 2
    across = math.radians(pose.heading + 90)
    return [
        Point(pose.x_cm + side * math.cos(across), pose.y_cm + side * math.sin(across))
        for side in (half_cm, -half_cm)
    ]


def _judge_distance_to_obstacle(criterion: Criterion, task: Task) -> Finding | None:
    """Compare with the nearest thing that an echo from the middle of its front would tell."""
    run, pose = task.run, _end(task.run)
    hull = run.robot.driving.hull
    along = math.radians(pose.heading)
    front = hull.spine(pose).b
    eye = Point(
        front.x + hull.radius_cm * math.cos(along), front.y + hull.radius_cm * math.sin(along)
    )
    ahead = run.world.obstacles()
    if criterion.places:
        ahead = shape_of(criterion.places[0], run.world, task.mirrored)
    gap_cm = nearest_seen(ahead, eye, along, CONE_RADIANS)
    low, high = criterion.numbers["low_cm"], criterion.numbers["high_cm"]
    values = {"low": f"{low:g}", "high": f"{high:g}"}
    if gap_cm is None:
        key = "other" if criterion.places else "nothing"
        return Finding("stands_before", f"stands_before/{key}", values, criterion.labels)
    if low <= gap_cm <= high:
        return None
    key, limit = ("far", high) if gap_cm > high else ("near", low)
    values["cm"] = in_cm(gap_cm, limit)
    return Finding("stands_before", f"stands_before/{key}", values)


def _faces(criterion: Criterion, task: Task) -> Finding | None:
    expected = criterion.numbers["heading"]
    if task.mirrored:
        expected = -expected
    off = (_end(task.run).heading - expected + 180) % 360 - 180
    if abs(off) <= criterion.numbers["within_degrees"]:
        return None
    key = "left" if off > 0 else "right"  # it looks too far to the left
    if abs(off) > OTHER_WAY_DEGREES:
        key = "behind"
    return Finding("faces", f"faces/{key}", {"degrees": f"{abs(off):.0f}"})


JUDGES: dict[str, Callable[[Criterion, Task], Finding | None]] = {
    "ends_in": _judge_final_place,
    "reaches": _judge_places,
    "stays_in": _judge_area,
    "stands_before": _judge_distance_to_obstacle,
    "faces": _faces,
}
