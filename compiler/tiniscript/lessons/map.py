"""A plan of a lesson's world, from above, as SVG for a page to print.

Knows shapes and greys. Parts that move from world to world are drawn where `world.toml` has them,
with a dashed outline. Goals are circles with a flag.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

from tiniscript import robots
from tiniscript.lessons.lesson import Criterion, Lesson
from tiniscript.lessons.variation import point_of
from tiniscript.virtual.driving import Hull
from tiniscript.virtual.geometry import Point

GOALS = ("ends_in", "reaches")
MARGIN_CM = 6.0
GRID_CM = 20
# `html.escape` would bring all names of HTML's characters into the page: 25 kB of it.
ESCAPED = str.maketrans({"&": "&amp;", "<": "&lt;", ">": "&gt;"})
DASHES = ' stroke-dasharray="4 2.5"'


def plan(lesson: Lesson, title: str) -> str:
    """Return the drawing, in units of centimetres. `title` is for people who cannot see it."""
    world = lesson.world
    width, height = world.width_cm, world.height_cm
    varied_parts = {
        (variation.place.part, variation.place.number) for variation in lesson.variations
    }
    parts = [_grid(width, height)]

    def dash(part: str, number: int) -> str:
        return DASHES if (part, number) in varied_parts else ""

    def draw(kind: str, points: Iterable[Point], attributes: str, part: str, number: int) -> None:
        coordinates = " ".join(f"{x:.1f},{height - y:.1f}" for x, y in points)
        parts.append(f'<{kind} points="{coordinates}" {attributes}{dash(part, number)}/>')

    for number, line in enumerate(world.lines, 1):
        attributes = (
            f'fill="none" stroke="#000" stroke-width="{line.width_cm:g}" stroke-linejoin="round"'
        )
        draw("polyline", line.points, attributes, "lines", number)
    for number, box in enumerate(world.boxes, 1):
        draw("polygon", box, 'fill="#bbb" stroke="#333"', "boxes", number)
    for number, wall in enumerate(world.walls, 1):
        draw("polyline", wall, 'fill="none" stroke="#333" stroke-width="3"', "walls", number)
    for number, lamp in enumerate(world.lamps, 1):
        x, y = lamp.place.x, height - lamp.place.y
        parts.append(
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="6" fill="#ffd84d" stroke="#333"'
            f"{dash('lamps', number)}/>"
        )
    parts += _goals(lesson)
    parts.append(_robot(lesson, DASHES if any(part == "start" for part, _ in varied_parts) else ""))
    if world.has_border:
        parts.append(
            f'<rect width="{width:g}" height="{height:g}" fill="none" stroke="#333"'
            ' stroke-width="3"/>'
        )
    view = f"{-MARGIN_CM:g} {-MARGIN_CM:g} {width + 2 * MARGIN_CM:g} {height + 2 * MARGIN_CM:g}"
    body = "\n".join(parts)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{view}" role="img">\n'
        f"<title>{title.translate(ESCAPED)}</title>\n{body}\n</svg>"
    )


def _grid(width: float, height: float) -> str:
    """Return lines every 20 cm, so that a pupil can measure."""
    path_steps = []
    for x in range(GRID_CM, math.ceil(width), GRID_CM):
        path_steps.append(f"M{x} 0V{height:g}")
    for y in range(GRID_CM, math.ceil(height), GRID_CM):
        path_steps.append(f"M0 {height - y:g}H{width:g}")
    return f'<path d="{"".join(path_steps)}" stroke="#ddd" stroke-width="0.6"/>'


def _goals(lesson: Lesson) -> list[str]:
    goals = []
    for criterion in lesson.criteria:
        if criterion.area and criterion.places[0].part == "start":
            goals.append(_area(criterion, lesson))
        if criterion.kind not in GOALS or criterion.words:
            continue
        for number, place in enumerate(criterion.places, 1):
            x, y = point_of(place, lesson.world, False)
            y = lesson.world.height_cm - y
            within_cm = criterion.number_by_key["within_cm"]
            goals.append(
                f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{within_cm:g}" fill="none" stroke="#777"/>'
            )
            if len(criterion.places) > 1:
                goals.append(
                    f'<text x="{x:.1f}" y="{y + 3:.1f}" font-size="9" text-anchor="middle"'
                    f' font-family="sans-serif">{number}</text>'
                )
            elif place.part != "start":
                goals.append(
                    f'<path d="M{x:.1f} {y:.1f}v-12l9 3.5l-9 3.5" fill="#fff" stroke="#333"/>'
                )
    return goals


def _area(criterion: Criterion, lesson: Lesson) -> str:
    assert criterion.area is not None
    (left, right), (low, high) = criterion.area
    x, y = point_of(criterion.places[0], lesson.world, False)
    return (
        f'<rect x="{x + left:.1f}" y="{lesson.world.height_cm - y - high:.1f}"'
        f' width="{right - left:g}" height="{high - low:g}" fill="none" stroke="#777"/>'
    )


def _robot(lesson: Lesson, dash: str) -> str:
    """Return the robot where it begins, with an arrow to where it looks."""
    hull = Hull(robots.load(lesson.robot).body)
    start = lesson.world.start
    height = lesson.world.height_cm
    outline = " ".join(f"{x:.1f},{height - y:.1f}" for x, y in hull.outline(start))
    heading_radians = math.radians(start.heading)
    x, y = start.x_cm, height - start.y_cm
    tip_x, tip_y = x + 26 * math.cos(heading_radians), y - 26 * math.sin(heading_radians)
    barb_angles = [heading_radians + turn for turn in (0.5, -0.5)]
    barbs = [(tip_x - 6 * math.cos(angle), tip_y + 6 * math.sin(angle)) for angle in barb_angles]
    arrow_head = " ".join(f"L{px:.1f} {py:.1f}" for px, py in [barbs[0], (tip_x, tip_y), barbs[1]])
    return (
        f'<polygon points="{outline}" fill="#eee" stroke="#333" stroke-width="1.5"{dash}/>'
        f'<path d="M{x:.1f} {y:.1f}L{tip_x:.1f} {tip_y:.1f}M{barbs[0][0]:.1f} {barbs[0][1]:.1f}'
        f'{arrow_head}" fill="none" stroke="#333" stroke-width="1.5"/>'
    )
