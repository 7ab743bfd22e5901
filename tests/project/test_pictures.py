"""Pictures of README's front, of worlds and of guides: robots drive, and nothing is cut off."""

from __future__ import annotations

from xml.etree import ElementTree

import pytest

from tests.support.casefile import ROOT
from tests.support.rows import each_row
from tiniscript.virtual import worlds
from tools.generate import arena, front
from tools.generate.arena import DRIVES, world_picture
from tools.generate.guide_pictures import DRIVES as DRIVES_OF_GUIDES
from tools.generate.guide_pictures import guide_pictures
from tools.site.documents import sources

SVG = "{http://www.w3.org/2000/svg}"
SIGN = 0.602  # the width of a sign, of its size


@pytest.fixture(scope="module", params=sources(ROOT, "README.md"))
def drawing(request: pytest.FixtureRequest) -> ElementTree.Element:
    return ElementTree.fromstring(front.front_picture(request.param, "a test"))


def test_no_picture_is_cut_off(drawing: ElementTree.Element) -> None:
    right_edge = front.PADDING + front.LEFT_WIDTH - 16
    for text in drawing.iter(f"{SVG}text"):
        if "Mono" in text.get("font-family", ""):
            shown_text = "".join(text.itertext())
            end = float(text.get("x", "")) + len(shown_text) * SIGN * float(
                text.get("font-size", "")
            )
            assert end <= right_edge, shown_text
        assert float(text.get("y", "")) <= front.HEIGHT - 16
    for shape in (*drawing.iter(f"{SVG}polygon"), *drawing.iter(f"{SVG}polyline")):
        for point in shape.get("points", "").split():
            x, y = (float(part) for part in point.split(","))
            assert right_edge < x < front.WIDTH
            assert 0 < y < front.HEIGHT


def test_the_pictured_robot_drives_around_the_obstacles(drawing: ElementTree.Element) -> None:
    way = next(drawing.iter(f"{SVG}polyline")).get("points", "").split()
    assert len(set(way)) > 10
    shapes = list(drawing.iter(f"{SVG}polygon"))
    assert len(shapes) == 9  # the arena, six boxes, the robot at its beginning and end


def test_the_actions_of_a_program_are_printed(drawing: ElementTree.Element) -> None:
    shown_texts = ["".join(text.itertext()) for text in drawing.iter(f"{SVG}text")]
    assert "1000 MOTORS 0 0" in shown_texts
    assert any("[TS102]" in row for row in shown_texts)
    assert any("[TS012]" in row for row in shown_texts)


def test_every_world_and_path_are_inside_the_picture() -> None:
    drawing = ElementTree.fromstring(world_picture("a test"))
    _, _, width, height = map(int, drawing.get("viewBox", "").split())
    assert {name for name, *_ in DRIVES} < set(worlds.names())
    shown_text = "".join(drawing.itertext())
    for name, example, *_ in DRIVES:
        assert f"{name}: examples/{example}" in shown_text
    lines = [
        element
        for element in drawing.iter(f"{SVG}polyline")
        if element.get("stroke") == arena.WAY_COLOUR
    ]
    assert len(lines) == len(DRIVES)
    for line in lines:
        way = [tuple(map(float, word.split(","))) for word in line.get("points", "").split()]
        assert len(set(way)) > 5
        assert all(0 < x < width and 0 < y < height for x, y in way)


@each_row("name", guide_pictures(""))
def test_a_picture_of_a_guide_contains_all_its_parts(name: str) -> None:
    drawing = ElementTree.fromstring(guide_pictures("a test")[name]())
    _, _, width, height = map(int, drawing.get("viewBox", "").split())
    for element in drawing.iter():
        x, y = float(element.get("x", 0)), float(element.get("y", 0))
        assert 0 <= x <= width - float(element.get("width", 0))
        assert 0 <= y <= height - float(element.get("height", 0))
    ways = [
        element
        for element in drawing.iter(f"{SVG}polyline")
        if element.get("stroke") == arena.WAY_COLOUR
    ]
    drives = {"lesson.svg": 3, "hand.svg": 1} | {
        key: len(row[2]) for key, row in DRIVES_OF_GUIDES.items()
    }
    assert len(ways) == drives.get(name, 0)


def test_a_path_keeps_its_bends_and_reversals() -> None:
    way = [(0.0, 0.0), (5.0, 0.1), (10.0, 0.0), (10.0, 5.0), (10.0, 9.0), (10.0, 3.0)]
    assert arena.simplified_path(way) == [(0.0, 0.0), (10.0, 0.0), (10.0, 9.0), (10.0, 3.0)]
