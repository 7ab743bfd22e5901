"""The pictures of the guides that show what robots do: programs that drive, a talk on a phone.

The content of a picture comes from its source: a program from its guide or its lesson, a
conversation from its guide. A picture without words is one for all languages.
"""

from __future__ import annotations

import re
from functools import partial
from html import escape

from tiniscript.lessons import catalogue
from tiniscript.lessons.variation import vary
from tiniscript.robots.wiring.drawing import FONT
from tiniscript.virtual import worlds
from tiniscript.virtual.world import World
from tools import ROOT
from tools.generate.arena import FLOOR_COLOUR, WALL_COLOUR, WAY_COLOUR, arena, drive_way
from tools.site.documents import sources

REFERENCE, GUIDE = "docs/en/language.md", "docs/en/monday.md"
GUIDE_OF_LANGUAGE = sources(ROOT, GUIDE)
PADDING, PAPER_COLOUR, SKY_COLOUR = 10, "#ffffff", "#dcebfb"


def floor_world(width: int, height: int, x: int, y: int, heading: int) -> World:
    """Return a floor with a wall around it, lengths in cm, and where the robot begins."""
    text = f"""
        floor = {{ width_cm = {width}, height_cm = {height}, border = true }}
        start = {{ x_cm = {x}, y_cm = {y}, heading = {heading} }}"""
    return worlds.read(text, "floor")


def wall_world(distance_cm: int) -> World:
    """Return a floor with a robot so many cm before its right wall."""
    return floor_world(110, 50, 110 - distance_cm - SENSOR_OFFSET_CM, 25, 0)


SENSOR_OFFSET_CM = 9  # cm from the middle of a robot to its distance sensor
OBSTACLES = worlds.load("obstacles")
LANE = floor_world(125, 30, 15, 15, 0)
Drives = tuple[tuple[World, int], ...]  # worlds, each for so many milliseconds
DRIVES: dict[str, tuple[str, str, Drives]] = {  # the guide, how its program begins
    "moves.svg": (REFERENCE, "SPEED = 90", ((floor_world(110, 110, 80, 25, 0), 4000),)),
    "until.svg": (REFERENCE, "F(3, 80) UNTIL", ((floor_world(120, 40, 20, 20, 0), 4000),)),
    "faster.svg": (REFERENCE, "SPEED = 40", ((LANE, 1000), (LANE, 2000), (LANE, 3000))),
    "if.svg": (REFERENCE, "SI|IF(DISTANCE < 10)",
               ((wall_world(8), 2000), (wall_world(20), 2000), (wall_world(60), 2000))),
    "def.svg": (REFERENCE, "DEF SIDE(SIZE)", ((floor_world(75, 85, 18, 68, 0), 5000),)),
    "dice.svg": (REFERENCE, "SB|LOOP(FOREVER)\n  F(FOREVER, 70)", ((OBSTACLES, 20_000),)),
    "course.svg": (GUIDE, "SB|LOOP(FOREVER)", ((OBSTACLES, 20_000),)),
}  # fmt: skip


def guide_pictures(command: str) -> dict[str, partial[str]]:
    """Return the makers of the pictures in `docs/pictures/`, by name. `command` runs them."""
    makers = {name: partial(drive, command, *row) for name, row in DRIVES.items()}
    makers |= {
        f"phone.{guide}.svg": partial(phone_picture, command, guide) for guide in GUIDE_OF_LANGUAGE
    }
    return makers | {
        "lesson.svg": partial(lesson_picture, command),
        "hand.svg": partial(hand_picture, command),
    }


def drive(command: str, guide: str, begin: str, drives: Drives) -> str:
    """Return the way of a guide's program in each world."""
    fences = re.findall(r"^```tiniscript\n(.*?)^```", _text(guide), re.M | re.S)
    [program] = [fence for fence in fences if fence.startswith(begin)]
    runs = ((world, program.replace("SB|", "SI|"), duration_ms) for world, duration_ms in drives)
    return _path_pictures(command, "tinibot", *runs)


def lesson_picture(command: str) -> str:
    """Return three worlds of lesson 7, with the way of a right program in each."""
    folder = catalogue.folders()[6]
    shown_lesson, program = catalogue.load(folder), catalogue.answers(folder)[0][0].program
    runs = ((vary(shown_lesson, k), program, 8000) for k in (1, 2, 3))
    return _path_pictures(command, shown_lesson.robot, *runs)


def _path_pictures(command: str, robot: str, *runs: tuple[World, str, int]) -> str:
    """Return the ways in some worlds of one size, side by side: each a program and milliseconds."""
    side_px, parts = 330 if len(runs) == 1 else 240, []
    scale = side_px / max(runs[0][0].width_cm, runs[0][0].height_cm)
    for k, (world, program, duration_ms) in enumerate(runs):
        way = drive_way(program, robot, world, duration_ms)
        parts += arena(world, way, PADDING + k * (side_px + PADDING), PADDING, scale)
    width = (len(runs) - 1) * (side_px + PADDING) + world.width_cm * scale
    return _svg(command, width, world.height_cm * scale, parts)


def phone_picture(command: str, language: str) -> str:
    """Return a guide's conversation with a robot on a phone."""
    [conversation] = re.findall(
        r"^```terminal\n(.*?)^```", _text(GUIDE_OF_LANGUAGE[language]), re.M | re.S
    )
    rows = conversation.splitlines()
    parts = [f'<rect x="{PADDING}" y="{PADDING}" width="460" height="{34 * len(rows) + 40}" rx="24"'
             f' fill="{FLOOR_COLOUR}" stroke="{WALL_COLOUR}" stroke-width="6"/>']  # fmt: skip
    for k, row in enumerate(rows):
        is_from_robot, width = row.startswith("//"), 8.4 * len(row) + 20
        left, top = 30 if is_from_robot else 450 - width, 30 + 34 * k
        parts.append(_box(left, top, width, 28, PAPER_COLOUR if is_from_robot else SKY_COLOUR))
        parts.append(_words(left + 10, top + 19, row))
    return _svg(command, 460, 34 * len(rows) + 40, parts)


def hand_picture(command: str) -> str:
    """Return the output of a robot in front of an obstacle when a guide asks for the distance."""
    [line, answer] = re.findall(
        r'tsc live "(SHOW\(.*?\))"\n(\w+ \d+)', _text(GUIDE_OF_LANGUAGE["en"])
    )[0]
    world, scale = wall_world(int(answer.split()[1])), 4.0
    way = drive_way(f"SI|{line}", "tinibot", world, 200)
    front_x, wall_x = (
        PADDING + x * scale for x in (way.points[0][0] + SENSOR_OFFSET_CM, world.width_cm)
    )
    y = PADDING + world.height_cm / 2 * scale
    parts = arena(world, way, PADDING, PADDING, scale)
    parts.append(
        f'<path d="M{front_x:g},{y:g} L{wall_x:g},{y:g}" stroke="{WAY_COLOUR}" stroke-width="3"/>'
    )
    parts.append(_words((front_x + wall_x) / 2 - 32, y - 10, answer))
    return _svg(command, world.width_cm * scale, world.height_cm * scale, parts)


def _text(guide: str) -> str:
    return (ROOT / guide).read_text(encoding="utf-8")


def _box(x: float, y: float, width: float, height: float, colour: str) -> str:
    return (f'<rect x="{x:g}" y="{y:g}" width="{width:g}" height="{height:g}" rx="6"'
            f' fill="{colour}" stroke="{WALL_COLOUR}"/>')  # fmt: skip


def _words(x: float, y: float, words: str) -> str:
    return (f'<text x="{x:g}" y="{y:g}" font-family="{FONT}" font-size="15" fill="{WALL_COLOUR}">'
            f"{escape(words)}</text>")  # fmt: skip


def _svg(command: str, width: float, height: float, parts: list[str]) -> str:
    """Return a picture in a few lines; `width` and `height` are those inside its edge."""
    width, height = round(width + 2 * PADDING), round(height + 2 * PADDING)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" role="img">'
        f"<!-- Generated by {command}. Do not edit. -->\n"
        f'<rect width="{width}" height="{height}" fill="{PAPER_COLOUR}"/>{"".join(parts)}</svg>\n'
    )
