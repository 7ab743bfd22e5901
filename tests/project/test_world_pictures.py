"""The picture of the worlds shows each of them, with a robot that has driven in it."""

from __future__ import annotations

from xml.etree import ElementTree

import pytest

from tests.machines.wasm import missing
from tests.support.platformio import need
from tiniscript.robots.profile import LANGUAGES
from tiniscript.virtual import worlds
from tools.generate import arena
from tools.generate.world_pictures import DRIVES, world_picture

SVG = "{http://www.w3.org/2000/svg}"


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_world_and_its_way_are_inside_of_the_picture(language: str) -> None:
    need(missing())
    drawing = ElementTree.fromstring(world_picture(language, "a test"))
    _, _, width, height = map(int, drawing.get("viewBox", "").split())
    assert {name for name, *_ in DRIVES} == set(worlds.names())
    shown = "".join(drawing.itertext())
    for name, example, *_ in DRIVES:
        assert f"{name}: examples/{example}" in shown
    lines = [each for each in drawing.iter(f"{SVG}polyline") if each.get("stroke") == arena.WAY]
    assert len(lines) == len(DRIVES)
    for line in lines:
        way = [tuple(map(float, each.split(","))) for each in line.get("points", "").split()]
        assert len(set(way)) > 100
        assert all(0 < x < width and 0 < y < height for x, y in way)
