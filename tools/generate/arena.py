"""Draws worlds from above with the way that the virtual robot drives in them, as SVG.

Knows the world and how to drive in it, not where on a picture it is. The virtual robot runs the
firmware of a real one.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import tiniscript
from tiniscript.robots.wiring.drawing import FONT
from tiniscript.studio.simulation import Simulation
from tiniscript.virtual import worlds
from tiniscript.virtual.driving import Hull
from tiniscript.virtual.geometry import Point, Segment, distance
from tiniscript.virtual.world import World
from tools import ROOT

SAMPLE_MS = 50
FLOOR_COLOUR, WALL_COLOUR, BOX_COLOUR, WAY_COLOUR, BODY_COLOUR = (
    "#f5f2ea",
    "#37414b",
    "#8a97a3",
    "#1273de",
    "#e8590c",
)
LINE_COLOUR, LAMP_COLOUR, GLOW_COLOUR = "#202020", "#f5b400", "#fdf3c8"
Points = Sequence[tuple[float, ...]]


class Way(NamedTuple):
    """The path of a robot, and its outline at the beginning and at the end; in cm."""

    points: list[tuple[float, float]]
    begin: list[tuple[float, float]]
    end: list[tuple[float, float]]


def drive_way(program: str, robot: str, world: World, duration_ms: int) -> Way:
    """Drive for so many milliseconds of the robot's clock, and return the way."""
    compilation = tiniscript.compile(program, robot=robot)
    simulation = Simulation(robot, world, compilation.image)
    hull = Hull(simulation.robot.profile.body)
    poses = [simulation.robot.pose]
    for _ in range(0, duration_ms, SAMPLE_MS):
        simulation.advance(SAMPLE_MS)
        poses.append(simulation.robot.pose)
    points = [(pose.x_cm, pose.y_cm) for pose in poses]
    start, end = ([(point.x, point.y) for point in hull.outline(poses[k])] for k in (0, -1))
    simulation.close()
    return Way(simplified_path(points), start, end)


def simplified_path(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return the points between which the others are on a straight way, to 2 mm."""
    if len(points) < 3:
        return points
    chord = Segment(Point(*points[0]), Point(*points[-1]))
    distances_cm = [distance(chord, *point) for point in points[1:-1]]
    k = distances_cm.index(max(distances_cm)) + 1
    if distances_cm[k - 1] < 0.2:
        return [points[0], points[-1]]
    return [*simplified_path(points[: k + 1])[:-1], *simplified_path(points[k:])]


def arena(world: World, way: Way, left: float, top: float, scale: float) -> list[str]:
    """Return the parts of a picture: its upper left corner is there, a cm is `scale` wide."""

    def to_pixels(x: float, y: float) -> tuple[float, float]:
        return left + x * scale, top + (world.height_cm - y) * scale

    def points_text(points: Points) -> str:
        return " ".join("{:.1f},{:.1f}".format(*to_pixels(*point[:2])) for point in points)

    def line(points: Points, colour: str, width: float) -> str:
        return (
            f'<polyline points="{points_text(points)}" fill="none" stroke="{colour}"'
            f' stroke-width="{width:.3g}" stroke-linejoin="round"/>'
        )

    def disc(x: float, y: float, radius_cm: float, colour: str) -> str:
        x, y = to_pixels(x, y)
        return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius_cm * scale:.1f}" fill="{colour}"/>'

    corners = [(0.0, 0.0), (world.width_cm, 0.0), (world.width_cm, world.height_cm),
               (0.0, world.height_cm)]  # fmt: skip
    return [
        f'<polygon points="{points_text(corners)}" fill="{FLOOR_COLOUR}" stroke="{WALL_COLOUR}"'
        ' stroke-width="4"/>',
        *(disc(*lamp.place[:2], lamp.reach_cm / 4, GLOW_COLOUR) for lamp in world.lamps),
        *(
            line(floor_line.points, LINE_COLOUR, floor_line.width_cm * scale)
            for floor_line in world.lines
        ),
        *(f'<polygon points="{points_text(box)}" fill="{BOX_COLOUR}"/>' for box in world.boxes),
        *(line(wall, WALL_COLOUR, 4) for wall in world.walls),
        *(disc(*lamp.place[:2], 2.5, LAMP_COLOUR) for lamp in world.lamps),
        f'<polygon points="{points_text(way.begin)}" fill="none" stroke="{BODY_COLOUR}"'
        ' stroke-dasharray="4"/>',
        line(way.points, WAY_COLOUR, 3),
        f'<polygon points="{points_text(way.end)}" fill="{BODY_COLOUR}"/>',
    ]


EXAMPLES = ROOT / "examples"
DRIVES = (  # the world, the example, the robot, the seconds
    ("obstacles", "obstacle_until.ts", "tinibot", 20),
    ("light", "light.ts", "tinibot", 8),
    ("line", "line.ts", "liner", 20),
)
COLUMN_WIDTH, PADDING = 400, 12


def world_picture(command: str) -> str:
    """Return the picture, as SVG: one for both languages. `command` makes it."""
    parts: list[str] = []
    bottom = 0.0
    for column, (name, example, robot, seconds) in enumerate(DRIVES):
        world = worlds.load(name)
        left = PADDING + column * COLUMN_WIDTH
        scale = (COLUMN_WIDTH - 2 * PADDING) / world.width_cm
        caption_y = PADDING + world.height_cm * scale + 24
        bottom = max(bottom, caption_y)
        way = drive_way((EXAMPLES / example).read_text("utf-8"), robot, world, 1000 * seconds)
        parts += arena(world, way, left, PADDING, scale)
        parts.append(
            f'<text x="{left}" y="{caption_y:.0f}" font-family="{FONT}" font-size="15"'
            ' fill="#37414b">'
            f"{name}: examples/{example}, {seconds} s</text>"
        )
    width, height = len(DRIVES) * COLUMN_WIDTH, round(bottom) + PADDING
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" role="img">\n'
        f"<!-- Generated by {command}. Do not edit. -->\n"
        f'<rect width="{width}" height="{height}" fill="#ffffff"/>\n'
        + "\n".join(parts)
        + "\n</svg>\n"
    )
