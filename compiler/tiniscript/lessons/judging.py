"""Compares a run with the criteria of a lesson: missing results become findings.

A finding is the name of a sentence and the values of its gaps; `sentences` makes words of it.
Knows no languages. `place_judging` has the criteria that name places, `text_judging` those of the
text of a program.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise

from tiniscript.base.fixed_point import ONE, as_text
from tiniscript.lessons import place_judging
from tiniscript.lessons.findings import STILL_CM, Finding, Task, in_cm, in_seconds, points_between
from tiniscript.lessons.lesson import ANY_VALUE, TIME, Criterion, Lesson
from tiniscript.lessons.running import ASKS, BUSY, DONE, FAULT, LIMIT, Run, ShownValue
from tiniscript.lessons.variation import is_mirrored
from tiniscript.robots.kinematics import Pose
from tiniscript.virtual.geometry import distance as distance_to
from tiniscript.virtual.geometry import join_points

STILL_DEGREES = 5.0  # less is no turn
EARLY_MS = 5000  # within them a robot that turns to the wrong side has lost its line
STANDING_LOOP_MS = 1000  # a loop that takes no time counts as standing for so long
REST_MS = 3000  # time without power after which the robot is at its end
SAMPLE_CM = 5.0  # between two points of a line that is followed
LATE_MS = 600  # time after which a robot obeys the keys held now
OBEYED_CM, OBEYED_DEGREES = 3.0, 10.0  # more is a move, or a turn
MOVE_CRITERIA = frozenset({"ends_in", "reaches", "stands_before", "follows", "drives", "faces"})
END_CRITERIA = frozenset(
    {"ends_in", "stands_before", "faces"}
)  # the robot's place at the end of the run
PLACE_CRITERIA = END_CRITERIA | {"reaches"}
# Causes to mend before the place of a wait or a sound.
EARLIER_CRITERIA = {"pauses": {"reaches"}, "beeps": {"reaches", "ends_in", "pauses"}}


def judge_run(run: Run, lesson: Lesson) -> list[Finding]:
    """Return the findings about a run; none if it is right."""
    if run.ending == ASKS:
        return [Finding("", "asks")]
    if run.ending == FAULT:
        values = {"fault": run.fault, "seconds": in_seconds(run.end_ms)}
        return [Finding("", f"fault/{run.fault}", values)]
    kinds = {criterion.kind for criterion in lesson.criteria}
    if kinds & MOVE_CRITERIA and _is_still(run):
        return [Finding("", "still/brief" if _had_power(run) else "still")]
    busy_findings = [Finding("", "busy", {"seconds": in_seconds(run.end_ms)})]
    stood_ms = run.end_ms - run.track[-1].ms
    if run.ending == BUSY and (stood_ms < STANDING_LOOP_MS or _is_still(run)):
        return busy_findings
    findings: list[Finding] = []
    if (
        run.ending == LIMIT
        and kinds & END_CRITERIA
        and "ends" not in kinds
        and not _ends_at_rest(run)
    ):
        findings.append(Finding("", "long", {"seconds": in_seconds(run.end_ms)}))
    task = Task(run, is_mirrored(lesson, run.seed))
    for criterion in lesson.criteria:
        judge = JUDGES.get(criterion.kind)
        finding = judge(criterion, task) if judge is not None else None
        if finding is not None:
            findings.append(finding)
    if run.ending == BUSY and not findings:  # it is in the right place, and may drive on from there
        return busy_findings
    return _drop_consequences(findings)


def _drop_consequences(findings: list[Finding]) -> list[Finding]:
    """Leave out consequences of another finding: one misunderstanding gives one sentence."""
    kinds = {finding.kind for finding in findings}
    keys = {finding.key for finding in findings}
    has_touched = any(finding.kind == "never_touches" for finding in findings)
    findings.sort(
        key=lambda finding: has_touched and finding.key == "long"
    )  # it may push against a wall
    has_missed = any(
        finding.kind == "reaches" and finding.key not in ("reaches/late", "reaches/around")
        for finding in findings
    )  # in that case its way back is not the first thing to change
    is_lost = bool(kinds & {"never_touches", ""})  # a lost robot is not at its place
    return [
        finding
        for finding in findings
        if not (is_lost and finding.kind in PLACE_CRITERIA)
        and not (finding.key == "ends_in/gone" and has_missed)
        and not (finding.kind == "pauses" and "ends_in/gone" in keys)  # it may have waited there
        and not ("/place" in finding.key and (is_lost or kinds & EARLIER_CRITERIA[finding.kind]))
        and not (finding.kind == "order" and finding.key.rpartition("/")[2] in kinds)
    ]


def _is_still(run: Run) -> bool:
    first_pose = run.track[0].pose
    return all(
        math.dist(first_pose[:2], pose[:2]) < STILL_CM
        and abs(pose.heading - first_pose.heading) < STILL_DEGREES
        for _, pose in run.track
    )


def _had_power(run: Run) -> bool:
    return any(any(powers) for _, *powers in run.motors)


def _ends_at_rest(run: Run) -> bool:
    """Return whether the motors were off at the end, for at least REST_MS."""
    powered_rows = [k for k, (_, *powers) in enumerate(run.motors) if any(powers)]
    rows_at_rest = run.motors[powered_rows[-1] + 1 :] if powered_rows else ()
    return not powered_rows or bool(rows_at_rest and run.end_ms - rows_at_rest[0][0] >= REST_MS)


# -- ways -----------------------------------------------------------------------------------------


def _judge_collisions(criterion: Criterion, task: Task) -> Finding | None:
    collisions = task.run.collisions
    if criterion.places:
        place, within_cm = task.point(criterion), criterion.number_by_key["within_cm"]
        arrivals_ms = (
            point.ms
            for point in points_between(task.run.track)
            if math.dist(place, point[1:3]) <= within_cm
        )
        arrival_ms = next(arrivals_ms, math.inf)
        collisions = tuple(collision for collision in collisions if collision.ms < arrival_ms)
    if not collisions:
        return None
    first_collision = collisions[0]
    seconds = {"seconds": in_seconds(first_collision.ms)}
    return Finding(
        "never_touches", f"touches/{first_collision.obstacle}", seconds, ms=first_collision.ms
    )


def _judge_line(criterion: Criterion, task: Task) -> Finding | None:
    run, within_cm = task.run, criterion.number_by_key["within_cm"]
    eyes = [place for place in run.robot.profile.body.places.values() if place.sees == "line"]
    ahead_cm = sum(eye.x_cm for eye in eyes) / len(eyes) if eyes else 0.0
    segments = [segment for line in run.world.lines for segment in join_points(list(line.points))]
    points_left = {
        (segment.a.x + (segment.b.x - segment.a.x) * k / n,
         segment.a.y + (segment.b.y - segment.a.y) * k / n)
        for segment in segments
        for n in [max(1, round(math.dist(segment.a, segment.b) / SAMPLE_CM))]
        for k in range(n)
    }  # fmt: skip
    point_count = len(points_left)
    off_ms: int | None = None
    for ms, pose in run.track:
        heading_radians = math.radians(pose.heading)
        x = pose.x_cm + ahead_cm * math.cos(heading_radians)
        y = pose.y_cm + ahead_cm * math.sin(heading_radians)
        if min((distance_to(segment, x, y) for segment in segments), default=math.inf) > within_cm:
            off_ms = ms
            break
        points_left = {point for point in points_left if math.dist(point, (x, y)) > within_cm}
    least_cm = criterion.number_by_key["at_least_cm"]
    followed_cm = (point_count - len(points_left)) * SAMPLE_CM
    values = {"cm": in_cm(followed_cm, least_cm), "least": f"{least_cm:g}"}
    if off_ms is not None:
        key = "early" if followed_cm < least_cm / 4 and off_ms < EARLY_MS else "off"
        values["seconds"] = in_seconds(off_ms)
        return Finding("follows", f"follows/{key}", values, ms=off_ms)
    if followed_cm >= least_cm:
        return None
    values["seconds"] = in_seconds(run.end_ms)
    is_going_on = run.ending == LIMIT and not _ends_at_rest(run)
    return Finding("follows", f"follows/{'slow' if is_going_on else 'short'}", values)


def _judge_distance(criterion: Criterion, task: Task) -> Finding | None:
    low_cm, high_cm = criterion.number_by_key["at_least_cm"], criterion.number_by_key["at_most_cm"]
    driven_cm = task.run.driven_cm
    if low_cm <= driven_cm <= high_cm:
        return None
    key, limit_cm = ("short", low_cm) if driven_cm < low_cm else ("long", high_cm)
    stopped_ms = task.run.track[-1].ms
    if key == "short" and task.run.ending == LIMIT and task.run.end_ms - stopped_ms >= REST_MS:
        key = "stood"
    values = {"cm": in_cm(driven_cm, limit_cm), "limit": f"{limit_cm:g}"}
    values["seconds"] = in_seconds(stopped_ms)
    return Finding("drives", f"drives/{key}", values)


# -- times ----------------------------------------------------------------------------------------


def _standstills(run: Run) -> list[tuple[int, int]]:
    """Return the start and end of each pause between two moves."""
    standstills: list[tuple[int, int]] = []
    stopped_ms: int | None = None
    for ms, left, right in run.motors:
        if left or right:
            if stopped_ms is not None and ms > stopped_ms:
                standstills.append((stopped_ms, ms))
            stopped_ms = None
        elif stopped_ms is None:
            stopped_ms = ms
    return standstills


def _judge_pauses(criterion: Criterion, task: Task) -> Finding | None:
    least_s, times = (
        criterion.number_by_key["at_least_seconds"],
        int(criterion.number_by_key["times"]),
    )
    standstills = _standstills(task.run)
    long_pauses = [
        standstill
        for standstill in standstills
        if standstill[1] - standstill[0] >= least_s * 1000 - 1
    ]
    if len(long_pauses) >= times:
        return _judge_pause_places(criterion, task, long_pauses)
    values = {"least": f"{least_s:g}", "times": str(times), "found": str(len(long_pauses))}
    if long_pauses:
        return Finding("pauses", "pauses/several", values)
    values["seconds"] = in_seconds(
        max((end_ms - begin_ms for begin_ms, end_ms in standstills), default=0)
    )
    return Finding("pauses", "pauses/short" if standstills else "pauses/none", values)


def _judge_pause_places(
    criterion: Criterion, task: Task, pauses: list[tuple[int, int]]
) -> Finding | None:
    """Compare the robot's resting places in these times with the expected ones."""
    track = task.run.track
    poses = [next((pose for ms, pose in track if ms >= end), track[-1].pose) for _, end in pauses]
    seconds = [in_seconds(end_ms - begin_ms) for begin_ms, end_ms in pauses]
    return _first_missed_place(
        criterion,
        task,
        poses,
        {"least": f"{criterion.number_by_key['at_least_seconds']:g}"},
        seconds,
    )


def _first_missed_place(
    criterion: Criterion,
    task: Task,
    poses: list[Pose],
    values: Mapping[str, str],
    seconds: Sequence[str],
) -> Finding | None:
    """Return the first place of a criterion that is not near any of the poses, or None."""
    within_cm = criterion.number_by_key.get("within_cm", 0.0)  # empty if it has no places
    kind = criterion.kind
    key = f"{kind}/place" if len(criterion.places) == 1 else f"{kind}/places"
    for number in range(len(criterion.places)):
        place = task.point(criterion, number)
        gaps_cm = [math.dist(place, pose[:2]) for pose in poses]
        nearest_cm = min(gaps_cm)
        if nearest_cm > within_cm:
            place_values = {"number": str(number + 1), "within": f"{within_cm:g}"}
            place_values["cm"] = in_cm(nearest_cm, within_cm)
            place_values["seconds"] = seconds[gaps_cm.index(nearest_cm)]
            return Finding(kind, key, {**values, **place_values}, criterion.labels)
    return None


def _judge_order(criterion: Criterion, task: Task) -> Finding | None:
    event_words = iter(task.run.event_words)
    previous_word = ""
    for k, word in enumerate(criterion.words):
        if word not in event_words:  # the event comes after the one just found
            times = criterion.words[:k].count(previous_word) if word in criterion.words[:k] else 1
            return Finding("order", f"order/{previous_word}/{word}", {"times": str(times)})
        previous_word = word
    return None


def _judge_end(criterion: Criterion, task: Task) -> Finding | None:
    values = {"seconds": in_seconds(task.run.end_ms)}
    return None if task.run.ending == DONE else Finding("ends", "ends", values)


def _judge_keys(criterion: Criterion, task: Task) -> Finding | None:
    """Compare the robot's behaviour with each key held, and with none, in order."""
    rested_ms = 0.0
    for press in task.run.presses:
        at_ms, end_ms = press.at_seconds * 1000, press.end_seconds * 1000 + LATE_MS
        if not _stood_still(task.run, rested_ms, at_ms):
            return _motion_finding(rested_ms, at_ms)
        rested_ms = end_ms
        effect_key, is_done = _key_effect(press.key, task.run, at_ms, end_ms)
        if not is_done:
            values = {"seconds": in_seconds(at_ms), "word": press.key}
            return Finding("obeys", f"obeys/{effect_key}", values, ms=round(end_ms))
    is_still = _stood_still(task.run, rested_ms, task.run.end_ms)
    return None if is_still else _motion_finding(rested_ms, task.run.end_ms)


def _motion_finding(from_ms: float, to_ms: float) -> Finding:
    return Finding("obeys", "obeys/rest", {"seconds": in_seconds(from_ms)}, ms=round(to_ms))


def _key_effect(key: str, run: Run, from_ms: float, to_ms: float) -> tuple[str, bool]:
    """Return the purpose of a key, and whether the robot did it."""
    ahead_cm, degrees = _displacement(run, from_ms, to_ms)
    effect_of_key = {
        "KEY_UP": ("forward", ahead_cm > OBEYED_CM),
        "KEY_DOWN": ("back", ahead_cm < -OBEYED_CM),
        "KEY_LEFT": ("left", degrees > OBEYED_DEGREES),
        "KEY_RIGHT": ("right", degrees < -OBEYED_DEGREES),
    }
    return effect_of_key.get(key) or (
        "beep",
        any(from_ms <= beep.ms <= to_ms for beep in run.beeps),
    )


def _stood_still(run: Run, from_ms: float, to_ms: float) -> bool:
    ahead_cm, degrees = _displacement(run, from_ms, to_ms)
    return abs(ahead_cm) < STILL_CM and abs(degrees) < STILL_DEGREES


def _displacement(run: Run, from_ms: float, to_ms: float) -> tuple[float, float]:
    """Return the robot's distance ahead in a time, and its rotation to the left."""
    ahead_cm = degrees = 0.0
    for sample, next_sample in pairwise(run.track):
        if from_ms <= sample.ms and next_sample.ms <= to_ms:
            heading_radians = math.radians(sample.pose.heading)
            dx = next_sample.pose.x_cm - sample.pose.x_cm
            dy = next_sample.pose.y_cm - sample.pose.y_cm
            ahead_cm += dx * math.cos(heading_radians) + dy * math.sin(heading_radians)
            turn_degrees = next_sample.pose.heading - sample.pose.heading
            degrees += (turn_degrees + 180) % 360 - 180
    return ahead_cm, degrees


# -- its sentences --------------------------------------------------------------------------------


def _judge_shown(criterion: Criterion, task: Task) -> Finding | None:
    run, times = task.run, int(criterion.number_by_key["times"])
    sensor_name = criterion.words[0] if criterion.words else ""
    expected_number, tolerance = (
        criterion.number_by_key["value"],
        criterion.number_by_key["tolerance"] * ONE,
    )
    values = {"times": str(times), "found": str(len(run.shown_values)), "what": sensor_name}
    if not run.shown_values:
        return Finding("shows", "shows/nothing", values)
    right_count = 0
    for shown_value in run.shown_values:
        expected_value = _expected_value(shown_value, sensor_name, expected_number, run)
        right_count += (
            expected_value is None or abs(shown_value.value - expected_value) <= tolerance
        )
    if right_count >= times:
        return None
    last_value = run.shown_values[-1]
    expected_value = _expected_value(last_value, sensor_name, expected_number, run)
    if expected_value is None or right_count == len(run.shown_values):
        return Finding("shows", "shows/few", values)
    values |= {
        "value": as_text(last_value.value),
        "wanted": as_text(round(expected_value / 100) * 100),
    }
    key = "time" if sensor_name == TIME else "sensor" if sensor_name else "value"
    return Finding("shows", f"shows/{key}", values)


def _expected_value(
    shown_value: ShownValue, sensor_name: str, expected_number: float, run: Run
) -> float | None:
    """Return the thousandths that a value should be, or None for any."""
    if sensor_name == TIME:  # the time is that of any moment since it stopped
        return float(min(max(shown_value.value, _stopped_ms(shown_value, run)), shown_value.ms))
    if sensor_name:
        names = [device.name for device in run.robot.profile.kit.sensors]
        return run.robot.sensing.peek(names.index(sensor_name), shown_value.pose)
    return None if expected_number == ANY_VALUE else expected_number * ONE


def _stopped_ms(shown_value: ShownValue, run: Run) -> int:
    """Return when the robot stopped before it showed a value, or that moment if it drove."""
    since_ms = shown_value.ms
    for ms, *powers in run.motors:
        if ms > shown_value.ms:
            break
        since_ms = shown_value.ms if any(powers) else ms
    return since_ms


def _judge_beeps(criterion: Criterion, task: Task) -> Finding | None:
    beeps = task.run.beeps
    times, pitches = int(criterion.number_by_key["times"]), int(criterion.number_by_key["pitches"])
    pitch_count = len({beep.hertz for beep in beeps})
    values = {"times": str(times), "found": str(len(beeps)), "pitches": str(pitches),
              "different": str(pitch_count)}  # fmt: skip
    if not beeps:
        return Finding("beeps", "beeps/none", values)
    if len(beeps) < times:
        return Finding("beeps", "beeps/few", values)
    if pitch_count < pitches:
        return Finding("beeps", "beeps/pitches", values)
    seconds = [in_seconds(beep.ms) for beep in beeps]
    return _first_missed_place(criterion, task, [beep.pose for beep in beeps], values, seconds)


def _judge_blinks(criterion: Criterion, task: Task) -> Finding | None:
    run, (actuator_name,), times = task.run, criterion.words, int(criterion.number_by_key["times"])
    names = [device.name for device in run.robot.profile.kit.actuators]
    switches = [switch for switch in run.switched_on if names[switch.actuator] == actuator_name]
    moving_count = sum(switch.is_moving for switch in switches)
    values = {"what": actuator_name, "times": str(times), "found": str(moving_count)}
    if moving_count >= times:
        return None
    return Finding("blinks", "blinks/few" if switches else "blinks/none", values)


JUDGES: dict[str, Callable[[Criterion, Task], Finding | None]] = {
    **place_judging.JUDGES,
    "never_touches": _judge_collisions,
    "follows": _judge_line,
    "drives": _judge_distance,
    "pauses": _judge_pauses,
    "shows": _judge_shown,
    "beeps": _judge_beeps,
    "blinks": _judge_blinks,
    "obeys": _judge_keys,
    "order": _judge_order,
    "ends": _judge_end,
}
