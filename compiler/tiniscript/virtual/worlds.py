"""The shipped worlds, how a world is found by name or by file, and how its text is read."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from tiniscript import robots
from tiniscript.base.fixed_point import ONE
from tiniscript.base.languages import ByLanguage, languages
from tiniscript.base.spelling import nearest
from tiniscript.robots.kinematics import Pose
from tiniscript.robots.profile import ProfileRefused, Reason
from tiniscript.robots.refusals import printable_value
from tiniscript.robots.toml_table import Table, root_of
from tiniscript.virtual.geometry import Point
from tiniscript.virtual.world import Flag, Lamp, Line, Ring, Rival, World, WorldRefused

LARGEST_CM = 2000 * ONE
MAX_PARTS = 100  # walls, and as many boxes, lines, lamps, flags and rings
MAX_RIVALS = 3
MAX_SECONDS = 600 * ONE  # most seconds for its flags
MAX_POINTS = 200  # most points of a wall or a line
MAX_LABEL_CHARACTERS = 60
T = TypeVar("T")


def read(text: str, name: str, refusal_type: type[ProfileRefused] = WorldRefused) -> World:
    """Return the world that a text describes, under `name`. Raises `refusal_type`."""
    with root_of(text, refusal_type) as root:
        world = _read(root, printable_value(name))
    reasons: list[Reason] = []
    x_cm, y_cm, _ = world.start
    for key, at_cm, most_cm in (("x_cm", x_cm, world.width_cm), ("y_cm", y_cm, world.height_cm)):
        if not 0 <= at_cm <= most_cm:
            values = {"path": f"start.{key}", "found": f"{at_cm:g}", "most": f"{most_cm:g}"}
            reasons.append(("start_outside", {**values, "line": str(_line_of(text, "start", key))}))
    if reasons:
        raise refusal_type(*reasons)
    return world


def _line_of(text: str, table: str, key: str) -> int:
    """Return the line of a key in a table of a TOML text, or that of the table."""
    table_line, is_inside = 1, False
    for number, line in enumerate(text.splitlines(), 1):
        row = line.replace(" ", "").replace("\t", "")
        if row.startswith("["):
            is_inside = row.startswith(f"[{table}]")
        if row.startswith((f"[{table}]", f"{table}=")):
            table_line = number
        is_key = row.startswith((f"{key}=", f'"{key}"=', f"'{key}'="))
        if row.startswith(f"{table}.{key}=") or (is_inside and is_key):
            return number
    return table_line


def _read(root: Table, name: str) -> World:
    floor = root.table("floor", "[floor]")
    width_cm, height_cm = (
        _number(floor, key, ONE, LARGEST_CM, f"{key} = 200") for key in ("width_cm", "height_cm")
    )
    has_border = floor.yes_no("border", True)
    floor.finish()
    start = root.table("start", "[start]")
    pose = Pose(*_place(start), _number(start, "heading", -360 * ONE, 360 * ONE))
    start.finish()
    light = root.table("light")
    ambient = _number(light, "ambient_percent", 0, 100 * ONE, default=10) / 100
    light.finish()
    task = root.table("task")
    seconds = _number(task, "seconds", 0, MAX_SECONDS)
    task.finish()
    return World(
        name,
        _labels(root.table("labels"), name),
        width_cm,
        height_cm,
        has_border,
        pose,
        _parts(root, "walls", _row),
        _parts(root, "boxes", _box),
        _parts(root, "lines", _line),
        _parts(root, "lamps", _lamp),
        ambient,
        _parts(root, "flags", _flag),
        seconds,
        _parts(root, "rings", _ring),
        _parts(root, "rivals", _rival, MAX_RIVALS),
    )


def _parts(
    root: Table, key: str, read: Callable[[Table], T], most_count: int = MAX_PARTS
) -> tuple[T, ...]:
    tables = root.tables(key)
    if len(tables) > most_count:
        root.complain("too_many_parts", key, found=str(len(tables)), most=str(most_count))
    parts = []
    for table in tables[:most_count]:
        parts.append(read(table))
        table.finish()
    return tuple(parts)


def _number(
    table: Table, key: str, low: int, high: int, example: str = "", default: float = 0
) -> float:
    return table.number(key, low, high, example, int(default * ONE)) / ONE


def _place(table: Table) -> Point:
    return Point(
        *(_number(table, key, -LARGEST_CM, LARGEST_CM, f"{key} = 50") for key in ("x_cm", "y_cm"))
    )


def _row(table: Table) -> tuple[Point, ...]:
    example = "points = [[20, 50], [80, 50]]"
    pairs = table.pairs("points", -LARGEST_CM, LARGEST_CM, example)
    if pairs is not None and not 2 <= len(pairs) <= MAX_POINTS:
        table.complain("points_count", "points", found=str(len(pairs)), most=str(MAX_POINTS))
    return tuple(Point(x / ONE, y / ONE) for x, y in (pairs or ())[:MAX_POINTS])


def _line(table: Table) -> Line:
    return Line(_row(table), _number(table, "width_cm", ONE // 10, 100 * ONE, default=2))


def _box(table: Table) -> tuple[Point, ...]:
    """Return the corners of a box that lies around its middle, turned by `heading`."""
    center = _place(table)
    length, width = (
        _number(table, key, ONE // 10, LARGEST_CM, f"{key} = 20")
        for key in ("length_cm", "width_cm")
    )
    angle = math.radians(_number(table, "heading", -360 * ONE, 360 * ONE))
    cos, sin = math.cos(angle), math.sin(angle)
    corners = ((1, 1), (-1, 1), (-1, -1), (1, -1))
    return tuple(
        Point(
            center.x + along * length / 2 * cos - across * width / 2 * sin,
            center.y + along * length / 2 * sin + across * width / 2 * cos,
        )
        for along, across in corners
    )


def _lamp(table: Table) -> Lamp:
    return Lamp(_place(table), _number(table, "reach_cm", ONE, LARGEST_CM, default=100))


def _flag(table: Table) -> Flag:
    reach_cm = _number(table, "reach_cm", ONE, LARGEST_CM, default=12)
    return Flag(_place(table), reach_cm, table.yes_no("rests", False))


def _ring(table: Table) -> Ring:
    """Return a ring; an edge has its room in the disc."""
    radius_cm = _number(table, "radius_cm", 5 * ONE, LARGEST_CM, "radius_cm = 60")
    edge_cm = _number(table, "edge_cm", 0, 100 * ONE, default=5)
    return Ring(_place(table), radius_cm, min(edge_cm, radius_cm))


def _rival(table: Table) -> Rival:
    place = _place(table)
    heading = _number(table, "heading", -360 * ONE, 360 * ONE)
    length_cm, width_cm = (
        _number(table, key, 5 * ONE, 50 * ONE, default=11) for key in ("length_cm", "width_cm")
    )
    speed_cm_s = _number(table, "speed_cm_s", ONE, 200 * ONE, default=40)
    power_percent = _number(table, "power_percent", 0, 100 * ONE, default=60)
    return Rival(Pose(*place, heading), length_cm, width_cm, speed_cm_s, power_percent)


def _labels(table: Table, name: str) -> dict[str, str]:
    """Return the world's name by language, or `name` in each if it has none."""
    label_of_language: ByLanguage[str] = ByLanguage()
    for language in languages():
        label = table.label(language, MAX_LABEL_CHARACTERS)
        if label is not None:
            label_of_language[language] = label
    table.finish()
    return label_of_language or ByLanguage.fromkeys(languages(), name)


DEFAULT = "obstacles"
FOLDER = Path(__file__).with_name("worlds")


def names() -> list[str]:
    """Return the names of the shipped worlds, the default first."""
    world_names = [path.stem for path in FOLDER.glob("*.toml")]
    return sorted(world_names, key=lambda name: (name != DEFAULT, name))


def load(name_or_path: str) -> World:
    """Return a shipped world (upper or lower case), or the one that a TOML file describes.

    `robots.load` says which names are files. Raises only WorldRefused.
    """
    if name_or_path.lower() in names():
        name = name_or_path.lower()
        return read((FOLDER / f"{name}.toml").read_text(encoding="utf-8"), name)
    if robots.is_path(name_or_path):
        return read(robots.text_of(name_or_path, WorldRefused), Path(name_or_path).stem)
    values = {"name": printable_value(name_or_path), "known": ", ".join(names())}
    suggestion = nearest(name_or_path.lower(), names()) or ""
    raise WorldRefused(("no_such_world", {**values, "near": suggestion}))
