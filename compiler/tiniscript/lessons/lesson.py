"""The types of a lesson: its robot, its world, how that varies, and the criteria of its task.

Knows no TOML (`reader`), no files (`catalogue`) and no sentences (`refusals`, `sentences`).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from tiniscript.robots.profile import ProfileRefused
from tiniscript.virtual.world import World

PARTS = ("start", "walls", "boxes", "lines", "lamps")  # of a world


class LessonRefused(ProfileRefused):
    """A lesson that cannot be used; its reasons are like those of a profile."""


class Place(NamedTuple):
    """A place in a world: a part of it, counted from 1, or a point where `part` is empty."""

    part: str
    number: int
    x_cm: float = 0.0
    y_cm: float = 0.0


class Criterion(NamedTuple):
    """What a run or a program must be like. `kind` is a row of `criteria.KINDS`.

    `numbers` has the numbers of that row by their keys, `words` its words, `places` its places.
    `labels[language]` is what a place is called in sentences. `area` is around a place: from and
    to, along x and y, in centimetres.
    """

    kind: str
    numbers: Mapping[str, float]
    words: tuple[str, ...]
    places: tuple[Place, ...]
    labels: Mapping[str, str]
    area: tuple[tuple[float, float], tuple[float, float]] | None = None


class Variation(NamedTuple):
    """How far chance moves a part of the world: from and to, in centimetres and degrees."""

    place: Place
    x_cm: tuple[float, float]
    y_cm: tuple[float, float]
    heading: tuple[float, float]


class Lesson(NamedTuple):
    """A lesson. `name` is that of its folder.

    A program has `seconds` of the robot's time in each world, and passes where it meets all
    criteria in the worlds of the seeds 1 to `worlds`. Sensors and motors are off by about
    `noise`, a fraction. `is_mirrored`: in half of the worlds left and right are exchanged.
    """

    name: str
    robot: str
    titles: Mapping[str, str]
    seconds: float
    worlds: int
    noise: float
    is_mirrored: bool
    world: World
    variations: tuple[Variation, ...]
    criteria: tuple[Criterion, ...]


class Answer(NamedTuple):
    """A program for a task, and what there is to say of it in each language.

    `said[language]` is the first sentence of the checker where the program is wrong; a right one
    has none.
    """

    program: str
    labels: Mapping[str, str]
    said: Mapping[str, str]
