"""A world as the page draws and changes it, in the form of JSON, and the TOML text of that form.

The form has the keys of a world's file. Lengths are centimetres, headings degrees. Knows no page.
"""

from __future__ import annotations

import json
import math
from typing import Any

from tiniscript.base.fixed_point import ONE
from tiniscript.base.languages import SOURCE_LANGUAGE, ByLanguage, languages
from tiniscript.virtual.geometry import Point
from tiniscript.virtual.world import World
from tiniscript.virtual.worlds import LARGEST_CM, MAX_PARTS, MAX_POINTS, MAX_RIVALS, MAX_SECONDS

KINDS = ("walls", "boxes", "lines", "lamps", "flags", "rings", "rivals")
DECIMALS = 3  # most decimals in a world's file
Form = dict[str, Any]


def limits() -> dict[str, int]:
    """Return the limits of a world: parts of each kind, points of a part, and numbers."""
    return {
        "parts": MAX_PARTS,
        "rivals": MAX_RIVALS,
        "points": MAX_POINTS,
        "cm": LARGEST_CM // ONE,
        "seconds": MAX_SECONDS // ONE,
    }


def form_of(world: World) -> Form:
    """Return the form of a world."""
    x_cm, y_cm, heading = world.start
    return {
        "name": world.name,
        "labels": {language: world.labels[language] for language in languages()},
        "width_cm": world.width_cm,
        "height_cm": world.height_cm,
        "has_border": world.has_border,
        "ambient_percent": round(world.ambient_light * 100, DECIMALS),
        "start": {"x_cm": x_cm, "y_cm": y_cm, "heading": heading},
        "walls": [{"points": _pairs(wall)} for wall in world.walls],
        "boxes": [_box(corners) for corners in world.boxes],
        "lines": [{"points": _pairs(line.points), "width_cm": line.width_cm}
                  for line in world.lines],
        "lamps": [{"x_cm": lamp.place.x, "y_cm": lamp.place.y, "reach_cm": lamp.reach_cm}
                  for lamp in world.lamps],
        "flags": [{"x_cm": flag.place.x, "y_cm": flag.place.y, "reach_cm": flag.reach_cm,
                   "rests": flag.needs_rest} for flag in world.flags],
        "seconds": world.seconds,
        "rings": [{"x_cm": ring.place.x, "y_cm": ring.place.y, "radius_cm": ring.radius_cm,
                   "edge_cm": ring.edge_cm} for ring in world.rings],
        "rivals": [{"x_cm": rival.start.x_cm, "y_cm": rival.start.y_cm,
                    "heading": rival.start.heading, "length_cm": rival.length_cm,
                    "width_cm": rival.width_cm, "speed_cm_s": rival.speed_cm_s,
                    "power_percent": rival.power_percent} for rival in world.rivals],
    }  # fmt: skip


def toml_of(form: Form) -> str:
    """Return the text that `worlds` reads as the world of a form."""
    floor = {"width_cm": form["width_cm"], "height_cm": form["height_cm"],
             "border": form["has_border"]}  # fmt: skip
    labels = form["labels"]
    if set(labels.values()) == {form["name"]}:
        labels = {}  # the name of a file, which the next one may have differently
    elif SOURCE_LANGUAGE in labels:  # leaves out what the catalogue of names provides
        labels_by_language = ByLanguage({SOURCE_LANGUAGE: labels[SOURCE_LANGUAGE]})
        labels = {
            **labels_by_language,
            **{
                language: name
                for language, name in labels.items()
                if name != labels_by_language[language]
            },
        }
    tables = [
        _table("[floor]", floor),
        _table("[start]", form["start"]),
        _table("[light]", {"ambient_percent": form["ambient_percent"]}),
        *([_table("[task]", {"seconds": form["seconds"]})] if form["seconds"] else []),
        *(_table(f"[[{kind}]]", part) for kind in KINDS for part in form[kind]),
        _table("[labels]", labels),
    ]
    return "\n".join(tables)


def _pairs(points: tuple[Point, ...]) -> list[list[float]]:
    return [[point.x, point.y] for point in points]


def _box(corners: tuple[Point, ...]) -> Form:
    """Return middle, size and heading of a box; its first two corners lie along its heading."""
    front, back, other, _ = corners
    along, across = (front.x - back.x, front.y - back.y), (back.x - other.x, back.y - other.y)
    values = {
        "x_cm": (front.x + other.x) / 2,
        "y_cm": (front.y + other.y) / 2,
        "length_cm": math.hypot(*along),
        "width_cm": math.hypot(*across),
        "heading": math.degrees(math.atan2(along[1], along[0])),
    }
    return {key: round(value, DECIMALS) for key, value in values.items()}


def _table(head: str, values: Form) -> str:
    return "".join([f"{head}\n", *(f"{key} = {_value(value)}\n" for key, value in values.items())])


def _value(value: Any) -> str:
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, bool | str):
        return json.dumps(value, ensure_ascii=False)
    number = round(float(value), DECIMALS)
    return f"{number:.{DECIMALS}f}".rstrip("0").rstrip(".") if number else "0"
