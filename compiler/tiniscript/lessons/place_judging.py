"""Compares where a robot was with the criteria of a lesson that name places."""

from __future__ import annotations

import math
from collections.abc import Callable

from tiniscript.lessons.findings import (
    STILL_CM,
    Finding,
    On,
    Task,
    between,
    in_cm,
    in_seconds,
)
from tiniscript.lessons.lesson import Criterion
from tiniscript.lessons.running import DONE, Run
from tiniscript.robots.kinematics import Pose
from tiniscript.virtual.geometry import Point, seen
from tiniscript.virtual.sensing import CONE

STRETCH_CM, TOWARDS = 20.0, 0.9  # the end of a way, and how much of it must lead to a place


def _end(run: Run) -> Pose:
    return run.track[-1].pose


def _ends_in(criterion: Criterion, task: Task) -> Finding | None:
    place, run = task.point(criterion), task.run
    within_cm = criterion.numbers["within_cm"]
    start, end = run.world.start, _end(run)
    away_cm = math.dist(place, end[:2])
    if away_cm <= within_cm:
        return None
    way_cm = math.dist(place, start[:2])
    key = "away"
    if way_cm > within_cm:  # else it should come back
        ux, uy = (place.x - start.x_cm) / way_cm, (place.y - start.y_cm) / way_cm
        dx, dy = end.x_cm - start.x_cm, end.y_cm - start.y_cm
        along_cm, beside_cm = dx * ux + dy * uy, abs(dy * ux - dx * uy)
        if math.dist(start[:2], end[:2]) < STILL_CM:
            key = "turned" if run.driven_cm < STILL_CM else "away"
        elif beside_cm <= within_cm and along_cm >= 0:
            key = "short" if along_cm < way_cm else "far"
    return Finding("ends_in", f"ends_in/{key}", {"cm": in_cm(away_cm)}, criterion.labels)


def _reaches(criterion: Criterion, task: Task) -> Finding | None:
    within_cm = criterion.numbers["within_cm"]
    way = between(task.run.track)
    points = iter(way)
    at = On(0.0, 0.0, 0.0, 0.0)
    for number in range(len(criterion.places)):
        place = task.point(criterion, number)
        nearest_cm = math.inf
        for at in points:
            nearest_cm = min(nearest_cm, math.dist(place, (at.x_cm, at.y_cm)))
            if nearest_cm <= within_cm:
                break
        else:
            values = {"number": str(number + 1), "all": str(len(criterion.places))}
            if nearest_cm < math.inf:
                values["cm"] = in_cm(nearest_cm)
            key = "one" if len(criterion.places) == 1 else "several"
            if key == "one" and task.run.ending == DONE and _is_on_its_way(way, place):
                key = "over"
            return Finding("reaches", f"reaches/{key}", values, criterion.labels)
    limit_s, limit_cm = criterion.numbers["by_seconds"], criterion.numbers["by_cm"]
    if at.ms > limit_s * 1000:
        values = {"seconds": in_seconds(at.ms), "limit": f"{limit_s:g}"}
        return Finding("reaches", "reaches/late", values, criterion.labels)
    if at.way_cm > limit_cm:
        values = {"cm": in_cm(at.way_cm, limit_cm), "limit": f"{limit_cm:g}"}
        return Finding("reaches", "reaches/around", values, criterion.labels)
    return None


def _is_on_its_way(way: list[On], place: Point) -> bool:
    """Whether the last STRETCH_CM led to a place, and never before it was nearer."""
    gaps_cm = [math.dist(place, (at.x_cm, at.y_cm)) for at in way]
    began = next(k for k, at in enumerate(way) if at.way_cm >= way[-1].way_cm - STRETCH_CM)
    gained_cm = gaps_cm[began] - gaps_cm[-1]
    return gained_cm > STRETCH_CM * TOWARDS and gaps_cm[-1] < min(gaps_cm) + STILL_CM


def _stays_in(criterion: Criterion, task: Task) -> Finding | None:
    place, within_cm = task.point(criterion), criterion.numbers["within_cm"]
    for ms, pose in task.run.track:
        if math.dist(place, pose[:2]) > within_cm:
            return Finding("stays_in", "stays_in", {"seconds": in_seconds(ms)}, criterion.labels)
    return None


def _stands_before(criterion: Criterion, task: Task) -> Finding | None:
    """Compare with the nearest thing that an echo from the middle of its front would tell."""
    run, pose = task.run, _end(task.run)
    hull = run.robot.driving.hull
    along = math.radians(pose.heading)
    front = hull.spine(pose).b
    eye = Point(
        front.x + hull.radius_cm * math.cos(along), front.y + hull.radius_cm * math.sin(along)
    )
    gap_cm = seen(run.world.obstacles(), eye, along, CONE)
    low, high = criterion.numbers["low_cm"], criterion.numbers["high_cm"]
    values = {"low": f"{low:g}", "high": f"{high:g}"}
    if gap_cm is None:
        return Finding("stands_before", "stands_before/nothing", values)
    if low <= gap_cm <= high:
        return None
    key, limit = ("far", high) if gap_cm > high else ("near", low)
    values["cm"] = in_cm(gap_cm, limit)
    return Finding("stands_before", f"stands_before/{key}", values)


def _faces(criterion: Criterion, task: Task) -> Finding | None:
    wanted = criterion.numbers["heading"]
    if task.mirrored:
        wanted = -wanted
    off = (_end(task.run).heading - wanted + 180) % 360 - 180
    if abs(off) <= criterion.numbers["within_degrees"]:
        return None
    key = "left" if off > 0 else "right"  # it looks too far to the left
    return Finding("faces", f"faces/{key}", {"degrees": f"{abs(off):.0f}"})


JUDGES: dict[str, Callable[[Criterion, Task], Finding | None]] = {
    "ends_in": _ends_in,
    "reaches": _reaches,
    "stays_in": _stays_in,
    "stands_before": _stands_before,
    "faces": _faces,
}
