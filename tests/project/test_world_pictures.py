"""The pictures of worlds and guides: robots have driven in them, and nothing is outside."""

from __future__ import annotations

from xml.etree import ElementTree

import pytest

from tests.machines.wasm import missing
from tests.support.platformio import need
from tiniscript.virtual import worlds
from tools.generate import arena
from tools.generate.guide_pictures import DRIVES as DRIVES_OF_GUIDES
from tools.generate.guide_pictures import guide_pictures
from tools.generate.world_pictures import DRIVES, world_picture

SVG = "{http://www.w3.org/2000/svg}"


def test_every_world_and_its_way_are_inside_of_the_picture() -> None:
    need(missing())
    drawing = ElementTree.fromstring(world_picture("a test"))
    _, _, width, height = map(int, drawing.get("viewBox", "").split())
    assert {name for name, *_ in DRIVES} == set(worlds.names())
    shown = "".join(drawing.itertext())
    for name, example, *_ in DRIVES:
        assert f"{name}: examples/{example}" in shown
    lines = [each for each in drawing.iter(f"{SVG}polyline") if each.get("stroke") == arena.WAY]
    assert len(lines) == len(DRIVES)
    for line in lines:
        way = [tuple(map(float, each.split(","))) for each in line.get("points", "").split()]
        assert len(set(way)) > 5
        assert all(0 < x < width and 0 < y < height for x, y in way)


@pytest.mark.parametrize("name", guide_pictures(""))
def test_a_picture_of_a_guide_has_all_of_its_parts_inside(name: str) -> None:
    need(missing())
    drawing = ElementTree.fromstring(guide_pictures("a test")[name]())
    _, _, width, height = map(int, drawing.get("viewBox", "").split())
    for each in drawing.iter():
        x, y = float(each.get("x", 0)), float(each.get("y", 0))
        assert 0 <= x <= width - float(each.get("width", 0))
        assert 0 <= y <= height - float(each.get("height", 0))
    ways = [each for each in drawing.iter(f"{SVG}polyline") if each.get("stroke") == arena.WAY]
    assert len(ways) == {"lesson.svg": 3}.get(name, int(name in DRIVES_OF_GUIDES))


def test_a_way_keeps_its_bends_and_its_returns() -> None:
    way = [(0.0, 0.0), (5.0, 0.1), (10.0, 0.0), (10.0, 5.0), (10.0, 9.0), (10.0, 3.0)]
    assert arena.bends(way) == [(0.0, 0.0), (10.0, 0.0), (10.0, 9.0), (10.0, 3.0)]
