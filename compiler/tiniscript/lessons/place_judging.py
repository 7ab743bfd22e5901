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


def _end_pose(run: Run) -> Pose:
    return run.track[-1].pose


def _is_outside(criterion: Criterion, task: Task, points: Iterable[Point]) -> bool:
    """Return whether a point is outside the area of a criterion."""
    assert criterion.area is not None
    (left, right), (low, high) = criterion.area
    if task.is_flipped:
        low, high = -high, -low
    x, y = task.point(criterion)
    return not all(left <= point.x - x <= right and low <= point.y - y <= high for point in points)


def _judge_final_place(criterion: Criterion, task: Task) -> Finding | None:
    place, run = task.point(criterion), task.run
    within_cm = criterion.number_by_key["within_cm"]
    start, end = run.world.start, _end_pose(run)
    away_cm = math.dist(place, end[:2])
    is_missed = away_cm > within_cm
    if criterion.area:
        is_missed = _is_outside(criterion, task, run.robot.driving.hull.outline(end))
    if not is_missed:
        return None
    way_cm = math.dist(place, start[:2])
    gaps_cm = [math.dist(place, pose[:2]) for _, pose in run.track]
    key = "away"
    if way_cm > within_cm:  # otherwise the robot should come back
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
    """Return whether the robot left a place and came back to it."""
    left_index = next((k for k, gap_cm in enumerate(gaps_cm) if gap_cm > within_cm), len(gaps_cm))
    return any(gap_cm <= within_cm for gap_cm in gaps_cm[left_index:])


def _judge_places(criterion: Criterion, task: Task) -> Finding | None:
    order = range(len(criterion.places))
    count, finding = _count_reached(criterion, task, order)
    if finding is not None and criterion.number_by_key["either_way"]:
        count_backwards, other_finding = _count_reached(criterion, task, order[::-1])
        finding = other_finding if count_backwards > count else finding
    return finding


def _gap_cm(criterion: Criterion, task: Task, number: int, point: TrackPoint) -> float:
    """Return the distance of a place from the robot's middle, or of a part of the world from a
    sensor.
    """
    if not criterion.words:
        return math.dist(task.point(criterion, number), (point.x_cm, point.y_cm))
    sensor = task.run.robot.profile.body.places[criterion.words[0]]
    heading_radians = math.radians(point.heading)
    x = (
        point.x_cm
        + sensor.x_cm * math.cos(heading_radians)
        - sensor.y_cm * math.sin(heading_radians)
    )
    y = (
        point.y_cm
        + sensor.x_cm * math.sin(heading_radians)
        + sensor.y_cm * math.cos(heading_radians)
    )
    shape = shape_of(criterion.places[number], task.run.world, task.is_flipped)
    return min(distance(segment, x, y) for segment in shape)


def _count_reached(
    criterion: Criterion, task: Task, order: Sequence[int]
) -> tuple[int, Finding | None]:
    """Return the number of places reached in this order, and the missing part."""
    within_cm = criterion.number_by_key["within_cm"]
    track_points = points_between(task.run.track)
    points = iter(track_points)
    point = track_points[0]
    for count, number in enumerate(order):
        place = task.point(criterion, number)
        origin, nearest_point = point, None
        nearest_cm = math.inf
        for point in points:
            gap_cm = _gap_cm(criterion, task, number, point)
            if gap_cm < nearest_cm:
                nearest_point, nearest_cm = point, gap_cm
            if gap_cm <= within_cm:
                break
        else:
            values = {"number": str(number + 1), "all": str(len(criterion.places))}
            values |= {"within": f"{within_cm:g}", "seconds": in_seconds(task.run.end_ms)}
            if nearest_point is not None:
                values["cm"] = in_cm(nearest_cm, within_cm)
            key = _missed_sentence(criterion, task, track_points, origin, place, nearest_point)
            if count and key in ("several", "time"):
                past_cm = _overshoot_cm(criterion, task, order[count - 1], origin, track_points)
                if past_cm > within_cm:
                    key = "past"
                    values |= {"number": str(order[count - 1] + 1), "cm": in_cm(past_cm)}
            return count, Finding("reaches", f"reaches/{key}", values, criterion.labels)
    return len(order), _judge_length(criterion, point)


def _overshoot_cm(
    criterion: Criterion,
    task: Task,
    number: int,
    origin: TrackPoint,
    track_points: list[TrackPoint],
) -> float:
    """Return the distance from a reached place at which the robot first stopped."""
    for previous_point, point in pairwise(track_points[track_points.index(origin) :]):
        if point.driven_cm == previous_point.driven_cm:
            return _gap_cm(criterion, task, number, point)
    return 0.0


def _judge_length(criterion: Criterion, point: TrackPoint) -> Finding | None:
    limit_s, limit_cm = criterion.number_by_key["by_seconds"], criterion.number_by_key["by_cm"]
    if point.ms > limit_s * 1000:
        values = {"seconds": in_seconds(point.ms), "limit": f"{limit_s:g}"}
        return Finding("reaches", "reaches/late", values, criterion.labels)
    if point.driven_cm > limit_cm:
        values = {"cm": in_cm(point.driven_cm, limit_cm), "limit": f"{limit_cm:g}"}
        return Finding("reaches", "reaches/around", values, criterion.labels)
    return None


def _missed_sentence(
    criterion: Criterion,
    task: Task,
    track_points: list[TrackPoint],
    origin: TrackPoint,
    place: Point,
    nearest_point: TrackPoint | None,
) -> str:
    """Return the sentence for a place that the robot has missed.

    `origin`: the point from which the robot had to reach the place. `nearest_point`: where it
    came closest.
    """
    run, start = task.run, task.run.world.start
    if run.driven_cm < STILL_CM:
        return "turned"
    if len(criterion.places) > 1:
        gap_cm = math.dist(place, (origin.x_cm, origin.y_cm))
        if run.ending == DONE and track_points[-1].driven_cm - origin.driven_cm < gap_cm / 2:
            return "ended"
        was_coming = nearest_point is None or run.track[-1].ms - nearest_point.ms <= STEP_MS
        return "time" if run.ending == LIMIT and was_coming else "several"
    if run.ending == DONE and _is_approaching(track_points, place):
        return "over"
    if nearest_point is None:
        return "one"
    if run.ending == LIMIT and nearest_point.driven_cm >= track_points[-1].driven_cm - STILL_CM > 0:
        return "slow"
    way_cm = math.dist(place, start[:2])
    ux, uy = (place.x - start.x_cm) / way_cm, (place.y - start.y_cm) / way_cm
    dx, dy = nearest_point.x_cm - start.x_cm, nearest_point.y_cm - start.y_cm
    is_straight = abs(dy * ux - dx * uy) <= STILL_CM and nearest_point.driven_cm > STILL_CM
    return "short" if is_straight and 0 < dx * ux + dy * uy < way_cm else "one"


def _is_approaching(track_points: list[TrackPoint], place: Point) -> bool:
    """Return whether the last STRETCH_CM led to a place, which was never nearer before."""
    gaps_cm = [math.dist(place, (point.x_cm, point.y_cm)) for point in track_points]
    start_index = next(
        k
        for k, point in enumerate(track_points)
        if point.driven_cm >= track_points[-1].driven_cm - STRETCH_CM
    )
    gained_cm = gaps_cm[start_index] - gaps_cm[-1]
    return gained_cm > STRETCH_CM * APPROACH_SHARE and gaps_cm[-1] < min(gaps_cm) + STILL_CM


def _judge_area(criterion: Criterion, task: Task) -> Finding | None:
    place, within_cm = task.point(criterion), criterion.number_by_key["within_cm"]
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
    run, pose = task.run, _end_pose(task.run)
    hull = run.robot.driving.hull
    heading_radians = math.radians(pose.heading)
    front = hull.spine(pose).b
    eye = Point(
        front.x + hull.radius_cm * math.cos(heading_radians),
        front.y + hull.radius_cm * math.sin(heading_radians),
    )
    obstacles = run.world.obstacles()
    if criterion.places:
        obstacles = shape_of(criterion.places[0], run.world, task.is_flipped)
    gap_cm = nearest_seen(obstacles, eye, heading_radians, CONE_RADIANS)
    low_cm, high_cm = criterion.number_by_key["low_cm"], criterion.number_by_key["high_cm"]
    values = {"low": f"{low_cm:g}", "high": f"{high_cm:g}"}
    if gap_cm is None:
        key = "other" if criterion.places else "nothing"
        return Finding("stands_before", f"stands_before/{key}", values, criterion.labels)
    if low_cm <= gap_cm <= high_cm:
        return None
    key, limit_cm = ("far", high_cm) if gap_cm > high_cm else ("near", low_cm)
    values["cm"] = in_cm(gap_cm, limit_cm)
    return Finding("stands_before", f"stands_before/{key}", values)


def _judge_heading(criterion: Criterion, task: Task) -> Finding | None:
    expected_degrees = criterion.number_by_key["heading"]
    if task.is_flipped:
        expected_degrees = -expected_degrees
    off_degrees = (_end_pose(task.run).heading - expected_degrees + 180) % 360 - 180
    if abs(off_degrees) <= criterion.number_by_key["within_degrees"]:
        return None
    key = "left" if off_degrees > 0 else "right"  # the robot faces too far to the left
    if abs(off_degrees) > OTHER_WAY_DEGREES:
        key = "behind"
    return Finding("faces", f"faces/{key}", {"degrees": f"{abs(off_degrees):.0f}"})


JUDGES: dict[str, Callable[[Criterion, Task], Finding | None]] = {
    "ends_in": _judge_final_place,
    "reaches": _judge_places,
    "stays_in": _judge_area,
    "stands_before": _judge_distance_to_obstacle,
    "faces": _judge_heading,
}
