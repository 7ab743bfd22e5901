"""The parts of judging a run: findings, the task they belong to, and the path.

Knows no criteria and no languages.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple

from tiniscript.lessons.lesson import Criterion
from tiniscript.lessons.variation import point_of
from tiniscript.virtual.geometry import Point

if TYPE_CHECKING:
    from tiniscript.lessons.running import Run, Sample

STILL_CM = 1.0  # less is no move


class Finding(NamedTuple):
    """A missing result. `kind` is that of the criterion, or "" for the whole run.

    `key` names a sentence. `labels` has the name of its place in each language. `ms`: when it
    happened; None if it is known only at the end of the run.
    """

    kind: str
    key: str
    values: Mapping[str, str] = {}
    labels: Mapping[str, str] = {}
    ms: int | None = None


class Task(NamedTuple):
    """The reference for a criterion: a run, and whether its world is mirrored."""

    run: Run
    is_flipped: bool

    def point(self, criterion: Criterion, number: int = 0) -> Point:
        return point_of(criterion.places[number], self.run.world, self.is_flipped)


class TrackPoint(NamedTuple):
    """A point on the way: when, where, and how far the robot had driven."""

    ms: float
    x_cm: float
    y_cm: float
    driven_cm: float
    heading: float


def points_between(track: tuple[Sample, ...]) -> list[TrackPoint]:
    """Return points of the way, at most a centimetre from each other."""
    points = [TrackPoint(float(track[0].ms), *track[0].pose[:2], 0.0, track[0].pose.heading)]
    for sample in track[1:]:
        ms, x, y, driven_cm, _ = points[-1]
        step_cm = math.dist((x, y), sample.pose[:2])
        steps = max(1, math.ceil(step_cm))
        for k in range(1, steps + 1):
            fraction = k / steps
            points.append(
                TrackPoint(
                    ms + (sample.ms - ms) * fraction,
                    x + (sample.pose.x_cm - x) * fraction,
                    y + (sample.pose.y_cm - y) * fraction,
                    driven_cm + step_cm * fraction,
                    sample.pose.heading,
                )
            )
    return points


def in_seconds(ms: float) -> str:
    return f"{ms / 1000:.1f}"


def in_cm(length_cm: float, limit_cm: float = math.inf) -> str:
    """Return a length in words. One that misses a limit does not look like the limit."""
    is_less = length_cm < limit_cm
    if round(length_cm) != limit_cm and (round(length_cm) < limit_cm) == is_less:
        return f"{length_cm:.0f}"
    return f"{(math.floor if is_less else math.ceil)(length_cm * 10) / 10:g}"
