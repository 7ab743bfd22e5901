"""The types of a world: a floor with walls, boxes, lines, lamps, flags, rings and rivals; and why
one is refused.

Lengths are centimetres: x goes to the right and y up, from the lower left corner of the floor.
Knows the shapes. Knows no TOML and no files (`worlds`) and no robots.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

from tiniscript.robots.kinematics import Pose
from tiniscript.robots.profile import ProfileRefused
from tiniscript.virtual.geometry import Point, Segment, join_points


class WorldRefused(ProfileRefused):
    """A world that cannot be used; its reasons are like those of a profile."""

    kinds = ("world",)


class Line(NamedTuple):
    """A black line on the floor."""

    points: tuple[Point, ...]
    width_cm: float


class Lamp(NamedTuple):
    """A lamp. At the distance `reach_cm` a sensor facing it reads half of its range."""

    place: Point
    reach_cm: float


class Flag(NamedTuple):
    """A flag. A robot takes it within `reach_cm`; if it `needs_rest`, only by standing there."""

    place: Point
    reach_cm: float
    needs_rest: bool


class Ring(NamedTuple):
    """A dark disc with a white edge, `edge_cm` of its radius; whose middle leaves it falls out."""

    place: Point
    radius_cm: float
    edge_cm: float

    def is_dark(self, x_cm: float, y_cm: float) -> bool:
        return self._distance(x_cm, y_cm) < self.radius_cm - self.edge_cm

    def holds(self, x_cm: float, y_cm: float) -> bool:
        return self._distance(x_cm, y_cm) <= self.radius_cm

    def outline(self, corners: int) -> list[Point]:
        """Return points around it; the last is the first."""
        angles = [2 * math.pi * k / corners for k in (*range(corners), 0)]
        x, y = self.place
        return [
            Point(x + self.radius_cm * math.cos(angle), y + self.radius_cm * math.sin(angle))
            for angle in angles
        ]

    def _distance(self, x_cm: float, y_cm: float) -> float:
        return math.hypot(x_cm - self.place.x, y_cm - self.place.y)


class Rival(NamedTuple):
    """Another body, which drives at `power_percent` of its speed, and pushes and is pushed."""

    start: Pose
    length_cm: float
    width_cm: float
    speed_cm_s: float
    power_percent: float


class World(NamedTuple):
    """A world. `walls` are rows of points, `boxes` corners; the robot begins at `start`.

    `ambient_light` is the light without lamps, 0 to 1. `labels` has the name in each language.
    `flags` are to be taken in their order, and `rivals` pushed out of the `rings`, within
    `seconds`, if that is not 0.
    """

    name: str
    labels: Mapping[str, str]
    width_cm: float
    height_cm: float
    has_border: bool
    start: Pose
    walls: tuple[tuple[Point, ...], ...]
    boxes: tuple[tuple[Point, ...], ...]
    lines: tuple[Line, ...]
    lamps: tuple[Lamp, ...]
    ambient_light: float
    flags: tuple[Flag, ...] = ()
    seconds: float = 0
    rings: tuple[Ring, ...] = ()
    rivals: tuple[Rival, ...] = ()

    def obstacles(self) -> list[Segment]:
        """Return everything that a robot cannot drive through."""
        obstacles = [segment for wall in self.walls for segment in join_points(list(wall))]
        for box in self.boxes:
            obstacles += join_points([*box, box[0]])
        if self.has_border:
            right, top = self.width_cm, self.height_cm
            corners = [Point(0, 0), Point(right, 0), Point(right, top), Point(0, top)]
            obstacles += join_points([*corners, corners[0]])
        return obstacles
