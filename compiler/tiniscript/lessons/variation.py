"""Makes the world of a seed: chance moves its parts, and may exchange left and right.

The same lesson and seed give the same world on every computer. The seed 1 of a lesson without
variations is the world as written.
"""

from __future__ import annotations

import math
from random import Random
from typing import TypeVar

from tiniscript.lessons.lesson import Lesson, Place, Press, Variation
from tiniscript.robots.kinematics import Pose
from tiniscript.virtual.geometry import Point, Segment, join_points
from tiniscript.virtual.world import World

T = TypeVar("T")


def vary(lesson: Lesson, seed: int) -> World:
    """Return the world of a seed."""
    random = Random(seed)
    world = lesson.world
    for variation in lesson.variations:
        dx, dy, turn = (
            random.uniform(*span) for span in (variation.x_cm, variation.y_cm, variation.heading)
        )
        world = _move_part(world, variation, dx, dy, turn)
    return _mirror(world) if is_mirrored(lesson, seed) else world


MIRRORED_KEYS = {"KEY_LEFT": "KEY_RIGHT", "KEY_RIGHT": "KEY_LEFT"}


def presses_of(lesson: Lesson, seed: int) -> tuple[Press, ...]:
    """Return the key presses in the world of a seed."""
    if not is_mirrored(lesson, seed):
        return lesson.presses
    return tuple(
        press._replace(key=MIRRORED_KEYS.get(press.key, press.key)) for press in lesson.presses
    )


def is_mirrored(lesson: Lesson, seed: int) -> bool:
    """Return whether left and right are exchanged: in every other world, beginning with the
    second.
    """
    return lesson.is_mirrored and seed % 2 == 0


def point_of(place: Place, world: World, is_flipped: bool) -> Point:
    """Return the point of a place: itself, the start, a lamp, or the middle of another part."""
    if not place.part:
        return Point(place.x_cm, world.height_cm - place.y_cm if is_flipped else place.y_cm)
    if place.part == "start":
        return Point(*world.start[:2])
    k = place.number - 1
    if place.part == "lamps":
        return world.lamps[k].place
    if place.part == "lines":
        return _center(world.lines[k].points)
    return _center(world.walls[k] if place.part == "walls" else world.boxes[k])


def shape_of(place: Place, world: World, is_flipped: bool) -> list[Segment]:
    """Return the outline of a part of a world; for anything else, its point."""
    k = place.number - 1
    if place.part == "walls":
        return join_points(list(world.walls[k]))
    if place.part == "boxes":
        return join_points([*world.boxes[k], world.boxes[k][0]])
    if place.part == "lines":
        return join_points(list(world.lines[k].points))
    point = point_of(place, world, is_flipped)
    return [Segment(point, point)]


def _move_part(world: World, variation: Variation, dx: float, dy: float, turn: float) -> World:
    part, k = variation.place.part, variation.place.number - 1

    def shift(points: tuple[Point, ...]) -> tuple[Point, ...]:
        center = _center(points)
        cos, sin = math.cos(math.radians(turn)), math.sin(math.radians(turn))
        return tuple(
            Point(
                center.x + dx + (x - center.x) * cos - (y - center.y) * sin,
                center.y + dy + (x - center.x) * sin + (y - center.y) * cos,
            )
            for x, y in points
        )

    if part == "start":
        x_cm, y_cm, heading = world.start
        return world._replace(start=Pose(x_cm + dx, y_cm + dy, heading + turn))
    if part == "walls":
        return world._replace(walls=_replace_part(world.walls, k, shift(world.walls[k])))
    if part == "boxes":
        return world._replace(boxes=_replace_part(world.boxes, k, shift(world.boxes[k])))
    if part == "lines":
        line = world.lines[k]
        line = line._replace(points=shift(line.points))
        return world._replace(lines=_replace_part(world.lines, k, line))
    x, y = world.lamps[k].place
    lamp = world.lamps[k]._replace(place=Point(x + dx, y + dy))
    return world._replace(lamps=_replace_part(world.lamps, k, lamp))


def _replace_part(parts: tuple[T, ...], k: int, part: T) -> tuple[T, ...]:
    return (*parts[:k], part, *parts[k + 1 :])


def _mirror(world: World) -> World:
    def mirror(point: Point) -> Point:
        return Point(point.x, world.height_cm - point.y)

    x_cm, y_cm, heading = world.start
    return world._replace(
        start=Pose(x_cm, world.height_cm - y_cm, -heading),
        walls=tuple(tuple(map(mirror, wall)) for wall in world.walls),
        boxes=tuple(tuple(map(mirror, box)) for box in world.boxes),
        lines=tuple(line._replace(points=tuple(map(mirror, line.points))) for line in world.lines),
        lamps=tuple(lamp._replace(place=mirror(lamp.place)) for lamp in world.lamps),
        rings=tuple(ring._replace(place=mirror(ring.place)) for ring in world.rings),
        rivals=tuple(
            rival._replace(start=Pose(*mirror(Point(*rival.start[:2])), -rival.start.heading))
            for rival in world.rivals
        ),
    )


def _center(points: tuple[Point, ...]) -> Point:
    return Point(
        sum(point.x for point in points) / len(points),
        sum(point.y for point in points) / len(points),
    )
