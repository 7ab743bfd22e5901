"""Compares a run with the criteria of a lesson: what is missing becomes findings.

A finding is the name of a sentence and the values of its gaps; `sentences` makes words of it.
Knows no languages, and no texts of programs: `text_judging` looks at those.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

from tiniscript.fixed_point import ONE, as_text
from tiniscript.lessons.criteria import ANY_VALUE
from tiniscript.lessons.lesson import Criterion, Lesson
from tiniscript.lessons.reader import TIME
from tiniscript.lessons.running import ASKS, BUSY, DONE, FAULT, LIMIT, Run, Sample, Shown
from tiniscript.lessons.variation import is_mirrored, point_of
from tiniscript.robots.kinematics import Pose
from tiniscript.virtual.geometry import Point, joined, seen
from tiniscript.virtual.geometry import distance as distance_to
from tiniscript.virtual.sensing import CONE

STILL_CM, STILL_DEGREES = 1.0, 5.0  # less is no move
SAMPLE_CM = 5.0  # between two points of a line that is followed
MOVING = frozenset({"ends_in", "reaches", "stands_before", "follows", "drives", "faces"})
AT_END = frozenset({"ends_in", "stands_before", "faces"})  # where the robot is when it is over
WHERE = AT_END | {"reaches"}


class Finding(NamedTuple):
    """What is missing. `kind` is that of the criterion, or "" for the run as a whole.

    `key` names a sentence. `labels` is what its place is called in each language.
    """

    kind: str
    key: str
    values: Mapping[str, str] = {}
    labels: Mapping[str, str] = {}


class Task(NamedTuple):
    """What a criterion is compared with: a run, and whether its world is mirrored."""

    run: Run
    mirrored: bool

    def point(self, criterion: Criterion, number: int = 0) -> Point:
        return point_of(criterion.places[number], self.run.world, self.mirrored)


def judged(run: Run, lesson: Lesson) -> list[Finding]:
    """Return what is missing in a run; nothing: it is right."""
    if run.ending == ASKS:
        return [Finding("", "asks")]
    if run.ending == BUSY:
        return [Finding("", "busy", {"seconds": _seconds(run.end_ms)})]
    if run.ending == FAULT:
        values = {"fault": run.fault, "seconds": _seconds(run.end_ms)}
        return [Finding("", f"fault/{run.fault}", values)]
    kinds = {criterion.kind for criterion in lesson.criteria}
    if kinds & MOVING and _is_still(run):
        return [Finding("", "still")]
    found: list[Finding] = []
    if run.ending == LIMIT and kinds & AT_END and "ends" not in kinds:
        found.append(Finding("", "long", {"seconds": _seconds(run.end_ms)}))
    task = Task(run, is_mirrored(lesson, run.seed))
    for criterion in lesson.criteria:
        judge = JUDGES.get(criterion.kind)
        finding = judge(criterion, task) if judge is not None else None
        if finding is not None:
            found.append(finding)
    return _causes(found)


def _causes(found: list[Finding]) -> list[Finding]:
    """Leave out what follows from another finding: one misunderstanding gives one sentence."""
    kinds = {finding.kind for finding in found}
    is_lost = bool(kinds & {"never_touches", ""})  # then it is not where it should be
    return [
        each
        for each in found
        if not (is_lost and each.kind in WHERE)
        and not (each.key.startswith("pauses/place") and (is_lost or "reaches" in kinds))
        and not (each.kind == "order" and each.key.rpartition("/")[2] in kinds)
    ]


def _is_still(run: Run) -> bool:
    first = run.track[0].pose
    return all(
        math.dist(first[:2], pose[:2]) < STILL_CM
        and abs(pose.heading - first.heading) < STILL_DEGREES
        for _, pose in run.track
    )


def _seconds(ms: float) -> str:
    return f"{ms / 1000:.1f}"


def _cm(length: float) -> str:
    return f"{length:.0f}"


def _end(run: Run) -> Pose:
    return run.track[-1].pose


# -- places ---------------------------------------------------------------------------------------


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
    return Finding("ends_in", f"ends_in/{key}", {"cm": _cm(away_cm)}, criterion.labels)


def _reaches(criterion: Criterion, task: Task) -> Finding | None:
    within_cm = criterion.numbers["within_cm"]
    points = iter(_between(task.run.track))
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
                values["cm"] = _cm(nearest_cm)
            key = "one" if len(criterion.places) == 1 else "several"
            return Finding("reaches", f"reaches/{key}", values, criterion.labels)
    limit_s, limit_cm = criterion.numbers["by_seconds"], criterion.numbers["by_cm"]
    if at.ms > limit_s * 1000:
        values = {"seconds": _seconds(at.ms), "limit": f"{limit_s:g}"}
        return Finding("reaches", "reaches/late", values, criterion.labels)
    if at.way_cm > limit_cm:
        values = {"cm": _cm(at.way_cm), "limit": f"{limit_cm:g}"}
        return Finding("reaches", "reaches/around", values, criterion.labels)
    return None


class On(NamedTuple):
    """A point on the way: when, where, and how far the robot had driven."""

    ms: float
    x_cm: float
    y_cm: float
    way_cm: float


def _between(track: tuple[Sample, ...]) -> list[On]:
    """Return points of the way, at most a centimetre from each other."""
    found = [On(float(track[0].ms), *track[0].pose[:2], 0.0)]
    for sample in track[1:]:
        ms, x, y, way_cm = found[-1]
        step_cm = math.dist((x, y), sample.pose[:2])
        steps = max(1, math.ceil(step_cm))
        for k in range(1, steps + 1):
            part = k / steps
            found.append(
                On(
                    ms + (sample.ms - ms) * part,
                    x + (sample.pose.x_cm - x) * part,
                    y + (sample.pose.y_cm - y) * part,
                    way_cm + step_cm * part,
                )
            )
    return found


def _stays_in(criterion: Criterion, task: Task) -> Finding | None:
    place, within_cm = task.point(criterion), criterion.numbers["within_cm"]
    for ms, pose in task.run.track:
        if math.dist(place, pose[:2]) > within_cm:
            return Finding("stays_in", "stays_in", {"seconds": _seconds(ms)}, criterion.labels)
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
    values["cm"] = _cm(gap_cm)
    key = "far" if gap_cm > high else "near"
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


# -- ways -----------------------------------------------------------------------------------------


def _never_touches(criterion: Criterion, task: Task) -> Finding | None:
    if not task.run.touches:
        return None
    first = task.run.touches[0]
    return Finding("never_touches", f"touches/{first.what}", {"seconds": _seconds(first.ms)})


def _follows(criterion: Criterion, task: Task) -> Finding | None:
    run, within_cm = task.run, criterion.numbers["within_cm"]
    eyes = [each for each in run.robot.profile.body.places.values() if each.sees == "line"]
    ahead_cm = sum(each.x_cm for each in eyes) / len(eyes) if eyes else 0.0
    segments = [each for line in run.world.lines for each in joined(list(line.points))]
    left = {
        (segment.a.x + (segment.b.x - segment.a.x) * k / n,
         segment.a.y + (segment.b.y - segment.a.y) * k / n)
        for segment in segments
        for n in [max(1, round(math.dist(segment.a, segment.b) / SAMPLE_CM))]
        for k in range(n)
    }  # fmt: skip
    there = len(left)
    off_ms: int | None = None
    for ms, pose in run.track:
        along = math.radians(pose.heading)
        x = pose.x_cm + ahead_cm * math.cos(along)
        y = pose.y_cm + ahead_cm * math.sin(along)
        if min((distance_to(each, x, y) for each in segments), default=math.inf) > within_cm:
            off_ms = ms
            break
        left = {point for point in left if math.dist(point, (x, y)) > within_cm}
    least_cm = criterion.numbers["at_least_cm"]
    followed_cm = (there - len(left)) * SAMPLE_CM
    values = {"cm": _cm(followed_cm), "least": f"{least_cm:g}"}
    if off_ms is not None:
        key = "early" if followed_cm < least_cm / 4 else "off"
        return Finding("follows", f"follows/{key}", {**values, "seconds": _seconds(off_ms)})
    return Finding("follows", "follows/short", values) if followed_cm < least_cm else None


def _drives(criterion: Criterion, task: Task) -> Finding | None:
    low, high = criterion.numbers["at_least_cm"], criterion.numbers["at_most_cm"]
    driven_cm = task.run.driven_cm
    if low <= driven_cm <= high:
        return None
    key, limit = ("short", low) if driven_cm < low else ("long", high)
    return Finding("drives", f"drives/{key}", {"cm": _cm(driven_cm), "limit": f"{limit:g}"})


# -- times ----------------------------------------------------------------------------------------


def _stands(run: Run) -> list[tuple[int, int]]:
    """Return when the robot stood between two moves: from and to."""
    found: list[tuple[int, int]] = []
    stopped_ms: int | None = None
    for ms, left, right in run.motors:
        if left or right:
            if stopped_ms is not None and ms > stopped_ms:
                found.append((stopped_ms, ms))
            stopped_ms = None
        elif stopped_ms is None:
            stopped_ms = ms
    return found


def _pauses(criterion: Criterion, task: Task) -> Finding | None:
    least_s, times = criterion.numbers["at_least_seconds"], int(criterion.numbers["times"])
    stands = _stands(task.run)
    long = [end_ms for begin_ms, end_ms in stands if end_ms - begin_ms >= least_s * 1000 - 1]
    if len(long) >= times:
        return _paused_at(criterion, task, long)
    values = {"least": f"{least_s:g}", "times": str(times), "found": str(len(long))}
    if times > 1:
        return Finding("pauses", "pauses/several", values)
    values["seconds"] = _seconds(max((end_ms - begin_ms for begin_ms, end_ms in stands), default=0))
    return Finding("pauses", "pauses/short" if stands else "pauses/none", values)


def _paused_at(criterion: Criterion, task: Task, long: list[int]) -> Finding | None:
    """Compare where the robot stood until these times with where it should."""
    track, least_s = task.run.track, criterion.numbers["at_least_seconds"]
    poses = [next((pose for ms, pose in track if ms >= end), track[-1].pose) for end in long]
    key = "pauses/place" if len(criterion.places) == 1 else "pauses/places"
    for number in range(len(criterion.places)):
        place, within_cm = task.point(criterion, number), criterion.numbers["within_cm"]
        if all(math.dist(place, pose[:2]) > within_cm for pose in poses):
            values = {"least": f"{least_s:g}", "number": str(number + 1)}
            return Finding("pauses", key, values, criterion.labels)
    return None


def _order(criterion: Criterion, task: Task) -> Finding | None:
    happened = iter(task.run.happened)
    before = ""
    for word in criterion.words:
        if word not in happened:  # which goes on behind the one that it has found
            return Finding("order", f"order/{before}/{word}")
        before = word
    return None


def _ends(criterion: Criterion, task: Task) -> Finding | None:
    over = {"seconds": _seconds(task.run.end_ms)}
    return None if task.run.ending == DONE else Finding("ends", "ends", over)


# -- what it says ---------------------------------------------------------------------------------


def _shows(criterion: Criterion, task: Task) -> Finding | None:
    run, times = task.run, int(criterion.numbers["times"])
    what = criterion.words[0] if criterion.words else ""
    wanted, slack = criterion.numbers["value"], criterion.numbers["tolerance"] * ONE
    values = {"times": str(times), "found": str(len(run.shown)), "what": what}
    if not run.shown:
        return Finding("shows", "shows/nothing", values)
    right = 0
    for each in run.shown:
        should = _should_show(each, what, wanted, run)
        right += should is None or abs(each.value - should) <= slack
    if right >= times:
        return None
    last = run.shown[-1]
    should = _should_show(last, what, wanted, run)
    if should is None or right == len(run.shown):
        return Finding("shows", "shows/few", values)
    values |= {"value": as_text(last.value), "wanted": as_text(round(should / 100) * 100)}
    key = "time" if what == TIME else "sensor" if what else "value"
    return Finding("shows", f"shows/{key}", values)


def _should_show(shown: Shown, what: str, wanted: float, run: Run) -> float | None:
    """Return the thousandths that a value should be, or None for any."""
    if what == TIME:
        return float(shown.ms)
    if what:
        names = [device.name for device in run.robot.profile.kit.sensors]
        return run.robot.sensing.look(names.index(what), shown.pose)
    return None if wanted == ANY_VALUE else wanted * ONE


def _beeps(criterion: Criterion, task: Task) -> Finding | None:
    beeps = task.run.beeps
    times, pitches = int(criterion.numbers["times"]), int(criterion.numbers["pitches"])
    different = len({each.hertz for each in beeps})
    values = {"times": str(times), "found": str(len(beeps)), "pitches": str(pitches),
              "different": str(different)}  # fmt: skip
    if not beeps:
        return Finding("beeps", "beeps/none", values)
    if len(beeps) < times:
        return Finding("beeps", "beeps/few", values)
    return Finding("beeps", "beeps/pitches", values) if different < pitches else None


JUDGES: dict[str, Callable[[Criterion, Task], Finding | None]] = {
    "ends_in": _ends_in,
    "reaches": _reaches,
    "stays_in": _stays_in,
    "stands_before": _stands_before,
    "faces": _faces,
    "never_touches": _never_touches,
    "follows": _follows,
    "drives": _drives,
    "pauses": _pauses,
    "shows": _shows,
    "beeps": _beeps,
    "order": _order,
    "ends": _ends,
}
