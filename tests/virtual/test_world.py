"""World files: those that are shipped, and those that people write."""

from __future__ import annotations

import re
from io import BytesIO
from pathlib import Path

import pytest
from PIL import Image

from tests.support.casefile import ROOT
from tests.support.command import Tsc
from tests.support.rows import each_row
from tests.support.texts import LANGUAGES
from tests.support.virtual_robot import floor, robot_in
from tiniscript import robots
from tiniscript.robots.refusals import describe
from tiniscript.virtual import worlds
from tiniscript.virtual.driving import Hull
from tiniscript.virtual.geometry import Point, Segment
from tiniscript.virtual.picture import LONGEST_SIDE, png
from tiniscript.virtual.world import WorldRefused
from tiniscript.virtual.worlds import read

RIGHT = "[floor]\nwidth_cm = 200\nheight_cm = 100\n[start]\nx_cm = 50\ny_cm = 50\n"


def refusals_of(text: str) -> list[str]:
    """Return the English messages about a world; there are Spanish ones as well."""
    with pytest.raises(WorldRefused) as exception_info:
        read(text, "some")
    lines = {language: describe(exception_info.value, language) for language in ("en", "es")}
    assert len(lines["es"]) == len(lines["en"]) > 0
    assert not set(lines["es"]) & set(lines["en"])
    return lines["en"]


def test_twelve_worlds_are_shipped_and_have_names_in_both_languages() -> None:
    assert worlds.names() == [
        "obstacles", "corridor", "dance", "delivery", "free", "gaps", "light", "line", "maze",
        "parking", "ring", "sumo",
    ]  # fmt: skip
    for name in worlds.names():
        world = worlds.load(name.upper())
        assert world.name == name
        assert set(world.labels) == {"en"}
        assert world.labels["en"] != world.labels["es"]


@pytest.mark.parametrize("world", worlds.names())
@pytest.mark.parametrize("robot", robots.names())
def test_every_robot_fits_into_every_world(world: str, robot: str) -> None:
    robot_in(worlds.load(world), robot)


def test_a_world_is_read() -> None:
    world = read(
        RIGHT + "heading = 90\n"
        "[light]\nambient_percent = 12.5\n"
        "[[walls]]\npoints = [[10, 20], [30.5, 20], [30.5, 0]]\n"
        "[[boxes]]\nx_cm = 100\ny_cm = 50\nlength_cm = 20\nwidth_cm = 10\nheading = 90\n"
        "[[lines]]\npoints = [[0, 0], [9, 9]]\nwidth_cm = 1.5\n"
        "[[lamps]]\nx_cm = 7\ny_cm = 8\n[labels]\nen = 'mine'\n",
        "some",
    )
    assert (world.width_cm, world.height_cm, world.has_border) == (200, 100, True)
    assert world.start == (50, 50, 90)
    assert world.ambient_light == 0.125
    assert world.walls == (((10, 20), (30.5, 20), (30.5, 0)),)
    [box] = world.boxes
    corners = [(round(x, 9), round(y, 9)) for x, y in box]
    assert corners == [(95, 60), (95, 40), (105, 40), (105, 60)]
    assert world.lines == ((((0, 0), (9, 9)), 1.5),)
    assert world.lamps == (((7, 8), 100),)
    assert {world.labels[language] for language in LANGUAGES} == {"mine"}
    obstacles = world.obstacles()
    assert len(obstacles) == 2 + 4 + 4
    assert Segment(Point(200, 0), Point(200, 100)) in obstacles
    without = read(RIGHT.replace("[start]", "border = false\n[start]"), "some")
    assert without.obstacles() == []


@pytest.mark.parametrize("language", ["en", "es"])
def test_the_world_of_the_documents_is_valid(language: str) -> None:
    text = (ROOT / "docs" / language / "worlds.md").read_text(encoding="utf-8")
    _, fence, _ = re.split(r"```toml\n|```\n", text)
    world = read(fence, "mine")
    assert dict(world.labels) == {"en": "my classroom", "es": "mi aula"}
    parts = (world.walls, world.boxes, world.lines, world.lamps)
    assert [len(part) for part in parts] == [1, 1, 1, 1]
    for shipped_text in worlds.names():
        assert f"| `{shipped_text}` |" in text
    for command in re.findall(r"`tsc (upload examples/[^`]*)`", text):
        options = command.split()
        assert (ROOT / options[1]).exists()
        assert "--world" not in options or options[options.index("--world") + 1] in worlds.names()


@each_row(
    "text, message",
    [
        ("", "floor is missing. Add it, for example: [floor]"),
        (RIGHT + "[[wall]]\n", "A world file has no key wall. Did you mean walls?"),
        (RIGHT + "[[walls]]\n", "walls[1].points is missing. Add it, for example: points ="),
        (RIGHT + "[[walls]]\npoints = 7\n", "walls[1].points is a number. Write a list of points"),
        (RIGHT + "[[walls]]\npoints = [[1, 2], 3]\n", "walls[1].points is a list. Write a list of"),
        (RIGHT + "[[walls]]\npoints = [[1, 2]]\n", "walls[1].points has 1 points. Write 2 to 200"),
        (
            RIGHT + "[[walls]]\npoints = [[1, 2], ['a', 3]]\n",
            "walls[1].points[2] is text in quotes. Write a number there.",
        ),
        (
            RIGHT + "[[lines]]\npoints = [[1, 2], [1, 9e9]]\n",
            "lines[1].points[2] is 9e9. Write the number with digits",
        ),
        (
            RIGHT + "[[lamps]]\nx_cm = 1\ny_cm = 99999\n",
            "lamps[1].y_cm is 99999. Write a number from -2000 to 2000.",
        ),
        (RIGHT + "[[boxes]]\nx_cm = nan\ny_cm = 1\nlength_cm = 1\nwidth_cm = 1\n", "digits"),
        (RIGHT.replace("200", "0"), "floor.width_cm is 0. Write a number from 1 to 2000."),
        (RIGHT + "[[walls]]\npoints = [[0, 0], [1, 1]]\n" * 101, "walls has 101 parts. Keep"),
        (
            RIGHT + f"[[walls]]\npoints = {[[k, k] for k in range(201)]}",
            "walls[1].points has 201 points",
        ),
        (RIGHT + "[[walls", "Line 7 is not valid TOML."),
        (RIGHT + "a = " + "[" * 5000, "is not valid TOML."),
        (RIGHT + "[labels]\nen = '\t'\n", "labels.en is empty or cannot be printed."),
        (
            RIGHT.replace("y_cm = 50", "y_cm = 200.5"),
            "Line 6: the robot starts outside the floor. start.y_cm is 200.5; write a number"
            " from 0 to 100.",
        ),
        (
            RIGHT.replace("x_cm = 50", " x_cm=-0.5 # left"),
            "Line 5: the robot starts outside the floor. start.x_cm is -0.5;",
        ),
        (
            "start = {x_cm = 300, y_cm = 1}\n[floor]\nwidth_cm = 9\nheight_cm = 9",
            "Line 1: the robot starts outside the floor. start.x_cm is 300;",
        ),
    ],
)
def test_a_fault_in_a_world_is_reported_with_its_place(text: str, message: str) -> None:
    assert any(message in line for line in refusals_of(text)), refusals_of(text)


def test_all_faults_of_a_world_are_reported_at_once() -> None:
    text = RIGHT.replace("x_cm = 50", "x_cm = true") + "[[lamps]]\nz_cm = 1\n"
    assert (
        len(refusals_of(text)) == 3
    )  # the start, y of the lamp, and z, which is meant to be its x


def test_a_robot_that_does_not_fit_is_refused() -> None:
    with pytest.raises(WorldRefused) as exception_info:
        robot_in(floor(start="x_cm = 5\ny_cm = 50"))
    [sentence] = describe(exception_info.value, "en")
    assert sentence.startswith(
        "The robot does not fit at its starting point, x_cm = 5, y_cm = 50. Move"
    )


@pytest.mark.parametrize("verb", [["robot"], ["upload", "--virtual", "-e", "SI|S"]])
def test_files_that_are_not_worlds_are_refused(tsc: Tsc, tmp_path: Path, verb: list[str]) -> None:
    binary_file, large_file, wrong_file = (
        tmp_path / "b.toml",
        tmp_path / "l.toml",
        tmp_path / "w.toml",
    )
    binary_file.write_bytes(bytes(range(256)))
    large_file.write_bytes(b"#" * 70_000)
    wrong_file.write_text(RIGHT + "[[lamps]]\n", encoding="utf-8")
    for name, expected in (
        ("obstacle", "Did you mean obstacles?"),
        ("nowhere", f"Choose one of these, or give a .toml file: {', '.join(worlds.names())}"),
        ("", "There is no world"),
        (str(tmp_path), "is a folder"),
        (str(tmp_path / "missing.toml"), "There is no file"),
        (str(binary_file), "is not UTF-8"),
        (str(large_file), "Check that it is a world"),
        (str(wrong_file), "w.toml has mistakes:\n  lamps[1].x_cm is missing"),
        ("a\0b.toml", "cannot be read"),
    ):
        for language in ("en", "es"):
            result = tsc(*verb, "--world", name, "--lang", language).gives(2)
            assert (expected in result.err) == (language == "en"), result.err


def test_the_longer_side_of_a_picture_has_the_allowed_size() -> None:
    text = """
        floor = { width_cm = 130, height_cm = 70, border = true }
        start = { x_cm = 20, y_cm = 20, heading = 0 }"""
    room, hull = read(text, "room"), Hull(robots.load("tinibot").body)
    image_file = Image.open(BytesIO(png(room, hull, [room.start], room.start, "a room")))
    assert image_file.size == (LONGEST_SIDE, 716)
