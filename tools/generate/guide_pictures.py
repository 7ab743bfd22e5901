"""The pictures of the guides: programs that drive, a phone that talks to a robot, wires, a room.

What a picture shows is taken from where it is said: a program from its guide or its lesson, a
conversation from its guide. A picture without words is one for all languages.
"""

from __future__ import annotations

import math
import re
from functools import partial
from html import escape
from pathlib import Path

from tiniscript.lessons import catalogue
from tiniscript.lessons.variation import varied
from tiniscript.virtual import worlds
from tiniscript.virtual.world import World
from tools.generate.arena import BODY, BOX, FLOOR, LAMP, WALL, WAY, arena, driven
from tools.site.documents import sources

DOCS = Path(__file__).resolve().parent.parent.parent / "docs"
GUIDES = {each: Path(file).name for each, file in sources(DOCS.parent, "docs/monday.en.md").items()}
SANS = "'DejaVu Sans', Verdana, Arial, sans-serif"
PAD, PAPER, GROUND, SKY = 10, "#ffffff", "#e9edf0", "#dcebfb"


def floor(width: int, height: int, x: int, y: int, heading: int) -> World:
    """Return a floor with a wall around it, lengths in cm, and where the robot begins."""
    text = f"""
        floor = {{ width_cm = {width}, height_cm = {height}, border = true }}
        start = {{ x_cm = {x}, y_cm = {y}, heading = {heading} }}"""
    return worlds.read(text, "floor")


def before(wall: int) -> World:
    """Return a floor with a robot so many cm before its right wall."""
    return floor(110, 50, 110 - wall - FRONT, 25, 0)


FRONT = 9  # cm from the middle of a robot to its distance sensor
OBSTACLES = worlds.load("obstacles")
LANE = floor(125, 30, 15, 15, 0)
Drives = tuple[tuple[World, int], ...]  # worlds, each for so many milliseconds
DRIVES: dict[str, tuple[str, str, Drives]] = {  # the guide, how its program begins
    "moves.svg": ("language.en.md", "SPEED = 90", ((floor(110, 110, 80, 25, 0), 4000),)),
    "until.svg": ("language.en.md", "F(3, 80) UNTIL", ((floor(120, 40, 20, 20, 0), 4000),)),
    "faster.svg": ("language.en.md", "SPEED = 40", ((LANE, 1000), (LANE, 2000), (LANE, 3000))),
    "if.svg": ("language.en.md", "SI|IF(DISTANCE < 10)",
               ((before(8), 2000), (before(20), 2000), (before(60), 2000))),
    "def.svg": ("language.en.md", "SIZE = 0", ((floor(75, 85, 18, 68, 0), 5000),)),
    "dice.svg": ("language.en.md", "SB|LOOP(FOREVER)\n  F(FOREVER, 70)", ((OBSTACLES, 20_000),)),
    "course.svg": ("monday.en.md", "SB|LOOP(FOREVER)", ((OBSTACLES, 20_000),)),
}  # fmt: skip


def guide_pictures(command: str) -> dict[str, partial[str]]:
    """Return how the pictures are made, by their names in `docs/`. `command` makes them."""
    made = {name: partial(drive, command, *row) for name, row in DRIVES.items()}
    made |= {f"phone.{each}.svg": partial(phone, command, each) for each in GUIDES}
    wired = {"cable.svg": cable, "adapter.svg": adapter, "room.svg": room, "lesson.svg": lesson,
             "blinks.svg": blinks, "hand.svg": hand, "port.svg": port,
             "measure.svg": measure}  # fmt: skip
    return made | {name: partial(picture, command) for name, picture in wired.items()}


def drive(command: str, guide: str, begin: str, drives: Drives) -> str:
    """Return the way of a guide's program in each world."""
    fences = re.findall(r"^```tiniscript\n(.*?)^```", _text(guide), re.M | re.S)
    [program] = [each for each in fences if each.startswith(begin)]
    runs = ((world, program.replace("SB|", "SI|"), lasts_ms) for world, lasts_ms in drives)
    return _ways(command, "tinibot", *runs)


def lesson(command: str) -> str:
    """Return three worlds of lesson 7, with the way of a right program in each."""
    folder = catalogue.folders()[6]
    found, program = catalogue.load(folder), catalogue.answers(folder)[0][0].program
    runs = ((varied(found, k), program, 8000) for k in (1, 2, 3))
    return _ways(command, found.robot, *runs)


def _ways(command: str, robot: str, *runs: tuple[World, str, int]) -> str:
    """Return the ways in some worlds of one size, side by side: each a program and milliseconds."""
    side, parts = 330 if len(runs) == 1 else 240, []
    scale = side / max(runs[0][0].width_cm, runs[0][0].height_cm)
    for k, (world, program, lasts_ms) in enumerate(runs):
        way = driven(program, robot, world, lasts_ms)
        parts += arena(world, way, PAD + k * (side + PAD), PAD, scale)
    width = (len(runs) - 1) * (side + PAD) + world.width_cm * scale
    return _svg(command, width, world.height_cm * scale, parts)


def phone(command: str, language: str) -> str:
    """Return a guide's conversation with a robot on a phone."""
    [said] = re.findall(r"^```terminal\n(.*?)^```", _text(GUIDES[language]), re.M | re.S)
    rows = said.splitlines()
    parts = [f'<rect x="{PAD}" y="{PAD}" width="460" height="{34 * len(rows) + 40}" rx="24"'
             f' fill="{FLOOR}" stroke="{WALL}" stroke-width="6"/>']  # fmt: skip
    for k, row in enumerate(rows):
        is_robots, width = row.startswith("//"), 8.4 * len(row) + 20
        left, top = 30 if is_robots else 450 - width, 30 + 34 * k
        parts.append(_box(left, top, width, 28, PAPER if is_robots else SKY))
        parts.append(_words(left + 10, top + 19, row))
    return _svg(command, 460, 34 * len(rows) + 40, parts)


def cable(command: str) -> str:
    """Return which wires of an HC-05 are plugged in with a cable, and which without one."""
    return _svg(command, 760, 190, _module(0, "USB", is_cut=True) + _module(400, "", is_cut=False))


def _module(left: float, port: str, *, is_cut: bool) -> list[str]:
    parts = [_box(left + 10, 30, 110, 150, SKY), _words(left + 30, 20, "Arduino"),
             _box(left + 280, 30, 80, 150, GROUND), _words(left + 290, 20, "HC-05")]  # fmt: skip
    for k, (name, other) in enumerate((("5V", "VCC"), ("GND", "GND"), ("0", "TXD"), ("1", "RXD"))):
        y = 55 + 34 * k
        parts += [_words(left + 80, y + 5, name), _words(left + 290, y + 5, other)]
        is_off = is_cut and k > 1
        parts += _wire(left + 120, y, left + (170 if is_off else 280), y)
        parts += _wire(left + 230, y, left + 280, y) if is_off else []
        parts += [_words(left + 193, y + 6, "✕")] if is_off else []
    if port:
        parts += [*_wire(left + 10, 105, left - 10, 105), _words(left + 16, 110, port)]
    return parts


def adapter(command: str) -> str:
    """Return how a module is wired to a USB adapter."""
    parts = [_box(10, 20, 110, 170, SKY), _words(20, 110, "USB"),
             _box(460, 20, 90, 170, GROUND), _words(485, 14, "HC-05")]  # fmt: skip
    for k, (name, other) in enumerate(
        (("5V", "VCC"), ("RX", "TXD"), ("GND", "GND"), ("TX", "RXD"))
    ):
        y = 45 + 40 * k
        parts += [_words(80, y + 5, name), _words(470, y + 5, other), *_wire(120, y, 460, y)]
    parts += [_box(200, 155, 50, 20, PAPER), _words(204, 170, "1 kΩ"), *_wire(390, 165, 390, 125)]
    parts += [_box(365, 135, 50, 20, PAPER), _words(369, 150, "2 kΩ")]
    return _svg(command, 550, 190, parts)


def blinks(command: str) -> str:
    """Return how the lamp of an HC-05 blinks alone, and while a computer is connected."""
    parts = []
    for k, lit in enumerate((range(0, 24, 2), (0, 2, 12, 14))):
        y = 20 + 70 * k
        parts += [_box(150, y, 80, 40, GROUND), _words(163, y + 26, "HC-05")]
        parts += [_box(10, y, 80, 40, SKY), _words(38, y + 25, "tsc"),
                  *_wire(95, y + 20, 145, y + 20)] if k else []  # fmt: skip
        parts += [f'<rect x="{270 + 20 * j}" y="{y + 8}" width="20" height="24" fill="{LAMP}"/>'
                  for j in lit]  # fmt: skip
        parts += _wire(270, y + 32, 750, y + 32)
    return _svg(command, 760, 140, parts)


def hand(command: str) -> str:
    """Return what a robot before something shows when a guide asks it for the distance."""
    [line, said] = re.findall(r'tsc live "(SHOW\(.*?\))"\n(SHOW \d+)', _text(GUIDES["en"]))[0]
    world, scale = before(int(said.split()[1])), 4.0
    way = driven(f"SI|{line}", "tinibot", world, 200)
    front, wall = (PAD + x * scale for x in (way.points[0][0] + FRONT, world.width_cm))
    y = PAD + world.height_cm / 2 * scale
    parts = [*arena(world, way, PAD, PAD, scale), *_wire(front, y, wall, y)]
    parts.append(_words((front + wall) / 2 - 32, y - 10, said))
    return _svg(command, world.width_cm * scale, world.height_cm * scale, parts)


def measure(command: str) -> str:
    """Return a robot beside a tape measure that begins at a mark, and one across a protractor."""
    left, right, y, per_cm = 40, 370, 60, 8
    parts = [_box(left - 6, 30, 6, 60, BOX), _box(left, 100, right - left, 26, SKY)]
    for cm in range((right - left) // per_cm):
        height = 14 if cm % 10 == 0 else 6
        parts.append(_line(left + cm * per_cm, 100, left + cm * per_cm, 100 + height))
    parts += [_words(left + cm * per_cm + 3, 122, str(cm)) for cm in (10, 20, 30)]
    parts += _wire(left, y, left + 33 * per_cm, y)
    parts.append(_robot(left + 33 * per_cm, y, 0))
    middle, floor_y, radius = 560, 150, 110
    begin, end = middle - radius, middle + radius
    half = f"M{begin},{floor_y} A{radius},{radius} 0 0 1 {end},{floor_y} Z"
    parts.append(f'<path d="{half}" fill="{SKY}" stroke="{WALL}"/>')
    for angle in range(0, 181, 15):
        along, across = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        inner = radius - (14 if angle % 45 == 0 else 7)
        parts.append(_line(*(each for size in (inner, radius) for each in
                             (middle + size * along, floor_y - size * across))))  # fmt: skip
    degrees = ((end + 6, floor_y, "0"), (middle - 8, 34, "90"), (begin - 36, floor_y, "180"))
    parts += [*(_words(*each) for each in degrees), _robot(middle, floor_y, 135)]
    return _svg(command, 720, 190, parts)


def _robot(x: float, y: float, heading: int) -> str:
    """Return a robot from above, whose front is at a place, or whose middle is when it turned."""
    back, front = (-70, 0) if heading == 0 else (-35, 35)
    outline = f"M{back},-22 H{front - 14} L{front},0 L{front - 14},22 H{back} Z"
    return (f'<path transform="translate({x:g},{y:g}) rotate({-heading})" d="{outline}"'
            f' fill="{BODY}" stroke="{WALL}"/>')  # fmt: skip


def _line(x: float, y: float, to_x: float, to_y: float) -> str:
    return f'<path d="M{x:.1f},{y:.1f} L{to_x:.1f},{to_y:.1f}" stroke="{WALL}"/>'


def port(command: str) -> str:
    """Return two commands on one computer that reach one robot through one port."""
    parts = [_box(10, 10, 330, 160, PAPER)]
    for k, typed in enumerate(("$ tsc upload prog.ts", "$ tsc stop")):
        y = 25 + 70 * k
        parts += [_box(25, y, 200, 60, SKY), _words(37, y + 35, typed)]
        parts += _wire(225, y + 30, 265, 90)
    parts += [_box(265, 70, 65, 40, GROUND), _words(272, 95, "COM5"), *_wire(330, 90, 440, 90)]
    return _svg(command, 560, 170, [*parts, _box(440, 60, 90, 60, BODY)])


def room(command: str) -> str:
    """Return a room with eight robots, each on 2 m² of floor, and their groups."""
    parts = [_box(10, 10, 780, 420, PAPER)]
    for k in range(8):
        left, top = 40 + k % 4 * 190, 90 + k // 4 * 180
        parts += [_box(left, top, 140, 140, FLOOR), _words(left + 4, top + 134, "2 m²"),
                  _box(left + 55, top + 50, 30, 34, BODY)]  # fmt: skip
        parts += [f'<circle cx="{left + 25 + 30 * j}" cy="{top - 16}" r="10" fill="{WAY}"/>'
                  for j in range(4)]  # fmt: skip
    return _svg(command, 780, 420, [*parts, _box(340, 18, 120, 34, BOX)])


def _text(guide: str) -> str:
    return (DOCS / guide).read_text(encoding="utf-8")


def _box(x: float, y: float, width: float, height: float, colour: str) -> str:
    return (f'<rect x="{x:g}" y="{y:g}" width="{width:g}" height="{height:g}" rx="6"'
            f' fill="{colour}" stroke="{WALL}"/>')  # fmt: skip


def _words(x: float, y: float, words: str) -> str:
    return (f'<text x="{x:g}" y="{y:g}" font-family="{SANS}" font-size="15" fill="{WALL}">'
            f"{escape(words)}</text>")  # fmt: skip


def _wire(x: float, y: float, to_x: float, to_y: float) -> list[str]:
    return [f'<path d="M{x:g},{y:g} L{to_x:g},{to_y:g}" stroke="{WAY}" stroke-width="3"/>']


def _svg(command: str, width: float, height: float, parts: list[str]) -> str:
    """Return a picture in a few lines; `width` and `height` are those inside its edge."""
    width, height = round(width + 2 * PAD), round(height + 2 * PAD)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" role="img">'
        f"<!-- Generated by {command}. Do not edit. -->\n"
        f'<rect width="{width}" height="{height}" fill="{PAPER}"/>{"".join(parts)}</svg>\n'
    )
