"""The picture at README's front shows what happens, and nothing of it is cut off."""

from __future__ import annotations

from xml.etree import ElementTree

import pytest

from tests.machines.wasm import missing
from tests.support.platformio import need
from tiniscript.robots.profile import LANGUAGES
from tools.generate import front

SVG = "{http://www.w3.org/2000/svg}"
SIGN = 0.602  # the width of a sign, of its size


@pytest.fixture(params=LANGUAGES)
def drawing(request: pytest.FixtureRequest) -> ElementTree.Element:
    need(missing())
    return ElementTree.fromstring(front.front(request.param, "a test"))


def test_nothing_is_cut_off(drawing: ElementTree.Element) -> None:
    right = front.PAD + front.LEFT_WIDTH - 16
    for text in drawing.iter(f"{SVG}text"):
        if "Mono" in text.get("font-family", ""):
            shown = "".join(text.itertext())
            end = float(text.get("x", "")) + len(shown) * SIGN * float(text.get("font-size", ""))
            assert end <= right, shown
        assert float(text.get("y", "")) <= front.HEIGHT - 16
    for shape in (*drawing.iter(f"{SVG}polygon"), *drawing.iter(f"{SVG}polyline")):
        for point in shape.get("points", "").split():
            x, y = (float(each) for each in point.split(","))
            assert right < x < front.WIDTH
            assert 0 < y < front.HEIGHT


def test_the_robot_drives_around(drawing: ElementTree.Element) -> None:
    way = next(drawing.iter(f"{SVG}polyline")).get("points", "").split()
    assert len(set(way)) > 10
    assert len(list(drawing.iter(f"{SVG}polygon"))) == 14  # the arena, twelve boxes, the robot


def test_what_a_program_does_is_printed(drawing: ElementTree.Element) -> None:
    shown = ["".join(text.itertext()) for text in drawing.iter(f"{SVG}text")]
    assert "1000 MOTORS 0 0" in shown
    assert any("[TS102]" in row for row in shown)
    assert any("[TS012]" in row for row in shown)
