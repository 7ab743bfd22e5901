"""A world as the page draws it, in the form of JSON."""

from __future__ import annotations

from typing import Any

from tiniscript.virtual.geometry import Point
from tiniscript.virtual.world import World


def drawn(world: World) -> dict[str, Any]:
    """Return the shapes of a world; lengths are centimetres, the heading is degrees."""

    def corners(points: tuple[Point, ...]) -> list[list[float]]:
        return [[point.x, point.y] for point in points]

    return {
        "name": world.name,
        "labels": dict(world.labels),
        "width_cm": world.width_cm,
        "height_cm": world.height_cm,
        "has_border": world.has_border,
        "start": list(world.start),
        "walls": [corners(wall) for wall in world.walls],
        "boxes": [corners(box) for box in world.boxes],
        "lines": [{"points": corners(each.points), "width_cm": each.width_cm}
                  for each in world.lines],
        "lamps": [[lamp.place.x, lamp.place.y] for lamp in world.lamps],
    }  # fmt: skip
