"""Wiring pages: every driver is drawn, every pin is there, and no profile can break a page."""

from __future__ import annotations

import os
import re
import xml.etree.ElementTree as Tree
from html.parser import HTMLParser
from itertools import combinations
from pathlib import Path

import pytest

from tests.support.command import Tsc
from tests.support.texts import LANGUAGES
from tests.support.wired_robots import (
    DEVICES,
    DISCS,
    MOTORS,
    pins_of,
    robot_with,
    wire_driver,
    with_discs,
)
from tiniscript import robots
from tiniscript.base.fixed_point import ONE
from tiniscript.base.kit import Device
from tiniscript.cli.commands import firmware_wiring
from tiniscript.robots.boards import CHIPS
from tiniscript.robots.driver import Driver
from tiniscript.robots.drivers import DRIVERS
from tiniscript.robots.profile import Place, Robot
from tiniscript.robots.reader import read
from tiniscript.robots.wiring import parts
from tiniscript.robots.wiring.drawing import _width, drawing_of
from tiniscript.robots.wiring.finished import _FinishedDrawing, finished_of
from tiniscript.robots.wiring.headers import SIDES
from tiniscript.robots.wiring.html import html_of
from tiniscript.robots.wiring.layout import BOARD_WIDTH, PART_WIDTH, Layout, layout_of
from tiniscript.robots.wiring.page import page_of, wire_rows
from tiniscript.robots.wiring.parts import BOARD_RAILS, ICONS
from tiniscript.robots.wiring.plan import Plan, plan_of
from tiniscript.robots.wiring.texts import has_text

DRIVER_IDS = [f"{used_by} {name}" for used_by, name in DRIVERS]
SVG = "{http://www.w3.org/2000/svg}"


ROBOTS = {
    **{name: robots.load(name) for name in robots.names()},
    **{f"mega {motors}": robot_with(motors, DEVICES) for motors in MOTORS},
    **{f"nano {motors}": robot_with(motors, DEVICES[:3], "nano", False) for motors in MOTORS},
    "mega, many": robot_with("two_wire", DEVICES * 4),
    **{
        f"{chip} {discs}": with_discs(chip, discs)
        for chip in ("uno", "mega", "esp32dev")
        for discs in DISCS
    },
}
each_robot = pytest.mark.parametrize("robot", ROBOTS.values(), ids=list(ROBOTS))


# -- every driver


@pytest.mark.parametrize("driver", DRIVERS.values(), ids=DRIVER_IDS)
def test_every_driver_is_drawn_with_all_its_pins(driver: Driver) -> None:
    where = f"the driver {driver.name} of {driver.used_by}"
    connected_wiring = wire_driver(driver, CHIPS["mega"], set())
    for yes_no in ("pull_up", "yes_is_low"):
        for setting in (0, 1):
            settings = {**connected_wiring.settings, yes_no: setting}
            device = Device("X", "", "V", 0, 10 * ONE)
            for sees in ("light", "touch"):
                shape = parts.shape_of(
                    driver.used_by,
                    connected_wiring._replace(settings=settings),
                    device,
                    Place(0, 0, 0, sees),
                )
                keys = [terminal.pin_key for terminal in shape.terminals if terminal.pin_key]
                assert sorted(keys) == sorted(connected_wiring.pins), (
                    f"{where} has pins that are not drawn"
                )
                assert shape.icon in ICONS
                assert all(has_text(note) for note in (*shape.note_keys, shape.need_key) if note)


def test_every_board_that_has_firmware_is_drawn_with_all_its_pins() -> None:
    for name, sides in SIDES.items():
        chip = CHIPS[name]
        drawn_pins = {slot for slot in (*sides.left, *sides.right) if isinstance(slot, int)}
        drawn_pins |= set(range(22, 54)) if name == "mega" else set()
        assert drawn_pins == chip.digital_pins | chip.analog_pins | chip.link_pins


# -- every pin, in both languages


@each_robot
@pytest.mark.parametrize("language", LANGUAGES)
def test_every_pin_is_in_the_table_and_in_the_drawing_and_every_wire_has_a_row(
    robot: Robot, language: str
) -> None:
    plan = plan_of(robot, language)
    chip = plan.chip
    link = set(chip.link_pins) if plan.has_radio else set()
    names = {chip.pin_name(pin) for pin in pins_of(robot) | link}
    assert {row[1] for row in wire_rows(plan)[1:]} == names
    shown_texts = [text.split(" ")[0] for text in texts_of(drawing_of(plan))]
    assert names <= set(shown_texts)
    numbers = [wire.number for wire in plan.wires]
    assert numbers == list(range(1, len(names) + (not plan.has_lamp)))
    for number in numbers:
        assert shown_texts.count(str(number)) >= 2, "a wire has its number at both ends"
    page = page_of(plan)
    # Ends at pins, power and GND: each joined end has a row to tick.
    wires, rails = (block.rows[1:] for block in page if block.kind == "ticks")
    assert len(wires) == len(plan.wires) + plan.has_lamp
    joined_names = [row[2] for row in rails]
    assert len(joined_names) == len(set(zip((row[0] for row in rails), joined_names, strict=True)))
    for part in plan.parts:
        for end in part.ends:
            if end.rail:
                assert (end.rail, f"{part.title}: {end.name}") in {(r[0], r[2]) for r in rails}
    assert html_of(plan).count('<td data-head="') == sum(len(row) for row in (*wires, *rails))
    (checks,) = (block for block in page if block.kind == "checks")
    assert "tsc set trim" in checks.rows[-1][0], "it mends a wheel that turns the wrong way"


@each_robot
def test_each_rail_has_one_tag_at_the_board(robot: Robot) -> None:
    """The tag is next to the first of its pins; other tags are at parts, some of which have
    several.
    """
    plan = plan_of(robot, "en")
    left, _, width, _ = layout_of(plan).board
    tag_positions = (f"{left - 29}", f"{left + width + 29}")
    words = Tree.fromstring(drawing_of(plan)).iter(f"{SVG}text")
    tags = [word.text or "" for word in words if word.get("x") in tag_positions]
    assert sorted(tags) == sorted(set(BOARD_RAILS) & set(plan.rails))


@each_robot
def test_both_languages_have_the_same_rows(robot: Robot) -> None:
    english, spanish = (page_of(plan_of(robot, language)) for language in ("en", "es"))
    assert [(block.kind, len(block.rows)) for block in english] == [
        (block.kind, len(block.rows)) for block in spanish
    ]
    tables = [(block.rows, other.rows) for block, other in zip(english, spanish, strict=True)
              if block.kind == "ticks"]  # fmt: skip
    for english_rows, spanish_rows in tables:
        for row, other in zip(english_rows, spanish_rows, strict=True):
            assert re.findall(r"\d+ k?Ω", " ".join(row)) == re.findall(r"\d+ k?Ω", " ".join(other))
    (wires, same), (rails, _) = tables
    assert [row[1] for row in wires[1:]] == [row[1] for row in same[1:]]
    assert [row[0].split(" ")[0] for row in wires[1:]] == [row[0].split(" ")[0] for row in same[1:]]
    assert {"5V", "GND"} <= {row[0] for row in rails}


def test_absent_parts_of_a_robot_are_not_mentioned() -> None:
    texts_by_robot = {name: " ".join(_sentences(name)) for name in robots.names()}
    assert "jumpers on ENA" in texts_by_robot["tinibot"]
    assert "jumpers on ENA" not in texts_by_robot["liner"]
    assert "S+" not in texts_by_robot["tinibot"]
    assert "S+" in texts_by_robot["grabber"]
    assert "tsc doctor --module --port P --baud 57600" in texts_by_robot["grabber"]
    assert "tsc doctor --module" not in texts_by_robot["tinibot"]
    assert "STATE tells" in texts_by_robot["tinibot"]
    assert "STATE stays unconnected" in texts_by_robot["liner"]
    assert "10 kΩ from STBY to GND" in texts_by_robot["liner"]
    assert "Unplug the HC-05" in texts_by_robot["liner"]


def _sentences(name: str) -> list[str]:
    blocks = page_of(plan_of(robots.load(name), "en"))
    return [" ".join([block.text, *(" ".join(row) for row in block.rows)]) for block in blocks]


def test_a_battery_has_resistors_for_its_range() -> None:
    text = (Path(robots.__file__).parent / "liner.toml").read_text(encoding="utf-8")
    for full, ohms in (("10", "10 kΩ"), ("15", "20 kΩ"), ("12.5", "15 kΩ")):
        plan = plan_of(read(text.replace("full = 10", f"full = {full}"), "x"), "en")
        (row,) = [row for row in wire_rows(plan) if row[2] == "BATTERY"]
        assert row[3:] == ("M+", f"{ohms} in series; 10 kΩ from the pin to GND")


@pytest.mark.parametrize("name", robots.names())
def test_no_pin_gets_more_than_its_allowed_voltage(name: str) -> None:
    """The voltage from a 5 V part to the pin, through its resistors.

    From the pin there is `series_resistor`, then `ground_resistor`, then `far_resistor`: no current
    flows through `series_resistor`, so the pin has the voltage of the middle.
    """
    plan = plan_of(robots.load(name), "en")
    is_3v3 = robots.load(name).board.chip.startswith("esp32")
    for echo in [end for part in plan.parts for end in part.ends if end.name == "ECHO"]:
        ohms = [
            float(resistor.removesuffix(" kΩ") or 0)
            for resistor in (echo.ground_resistor, echo.far_resistor)
        ]
        volts = 5.0 * ohms[0] / sum(ohms) if all(ohms) else 5.0
        assert volts <= (3.4 if is_3v3 else 5.0)
        assert volts >= (2.5 if is_3v3 else 5.0), "a yes is above three quarters of the supply"
    if is_3v3:
        rows = [row[4] for row in wire_rows(plan) if row[3] == "ECHO"]
        assert rows == ["1 kΩ in series; 2 kΩ from the pin to GND"]


# -- the drawing


def texts_of(svg: str) -> list[str]:
    return [element.text or "" for element in Tree.fromstring(svg).iter(f"{SVG}text")]


@each_robot
def test_wires_never_overlap_each_other_or_parts(robot: Robot) -> None:
    layout = layout_of(plan_of(robot, "en"))
    assert layout.board[2] == BOARD_WIDTH
    for box, other_box in combinations(_solid(layout), 2):
        is_apart = (
            box[2] <= other_box[0]
            or other_box[2] <= box[0]
            or box[3] <= other_box[1]
            or other_box[3] <= box[1]
        )
        assert is_apart, "parts have room"
    lines = [
        (route.wire.number, *start, *end)
        for route in layout.routes
        for start, end in zip(route.points, route.points[1:], strict=False)
        if start != end
    ]
    for one, other in combinations(lines, 2):
        if one[0] != other[0]:
            assert not _lie_upon_each_other(one[1:], other[1:]), f"wires {one[0]} and {other[0]}"
    for left, top, right, bottom in _solid(layout):
        assert min(left, top) >= 0 and right <= layout.width and bottom <= layout.height
        for number, x1, y1, x2, y2 in lines:
            is_outside = (
                max(x1, x2) <= left or min(x1, x2) >= right or max(y1, y2) <= top
                or min(y1, y2) >= bottom
            )  # fmt: skip
            assert is_outside, f"wire {number} runs through something"


def _lie_upon_each_other(one: tuple[int, ...], other: tuple[int, ...]) -> bool:
    for across in (0, 1):  # both upright, or both level
        along = 1 - across
        if len({one[across], one[across + 2], other[across], other[across + 2]}) == 1:
            low = max(min(one[along], one[along + 2]), min(other[along], other[along + 2]))
            high = min(max(one[along], one[along + 2]), max(other[along], other[along + 2]))
            return low <= high
    return False


def _solid(layout: Layout) -> list[tuple[int, int, int, int]]:
    left, top, width, height = layout.board
    boxes = [(box.x, box.y, box.x + PART_WIDTH, box.y + box.height) for box in layout.boxes]
    return [(left, top, left + width, top + height), *boxes]


# -- hostile profiles


class Elements(HTMLParser):
    """The elements of a page, and their references."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.referred: list[str] = []
        self.feed(page)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.referred += [value or "" for name, value in attrs
                          if name in ("src", "href", "xlink:href", "style", "onload")]  # fmt: skip


HOSTILE = "</text></svg><script src=//x>&amp;\"'**|`](http://x) \u202e{robot}"


def test_a_hostile_label_is_only_text() -> None:
    page = (Path(robots.__file__).parent / "grabber.toml").read_text(encoding="utf-8")
    quoted_text = HOSTILE[:60].replace("\\", "\\\\").replace('"', '\\"').replace("\u202e", "")
    robot = read(
        page.replace('"thermometer"', f'"{quoted_text}"').replace('"Grabber"', f'"{quoted_text}"'),
        "x",
    )
    assert "<script" in robot.labels["en"]["TEMPERATURE"]
    plain = plan_of(robots.load("grabber"), "en")
    for language in LANGUAGES:
        plan = plan_of(robot, language)
        whole = html_of(plan)
        elements = Elements(whole)
        assert "script" not in elements.tags
        assert elements.tags.count("svg") == 2
        assert elements.referred == []
        assert Elements(html_of(plain)).tags.count("tr") == elements.tags.count("tr")
        assert Tree.fromstring(drawing_of(plan)).tag == f"{SVG}svg"
    assert "http" not in html_of(plain).replace("http://www.w3.org/2000/svg", "")


@pytest.mark.parametrize("label", ["W" * 60, "漢" * 60, "i" * 60, "a\u0301" * 30, "\u200f" * 60])
def test_a_long_label_is_made_to_fit(label: str) -> None:
    robot = robot_with("l298n", DEVICES, label=label)
    svg = drawing_of(plan_of(robot, "es"))
    sizes = [float(size) for size in re.findall(r'font-size="([\d.]+)"', svg)]
    assert min(sizes) >= 8
    longest = max(
        len(element.text or "") for element in Tree.fromstring(svg).iter(f"{SVG}text")
        if (element.text or "").startswith(label[:3])
    ) if label[0] in "W漢" else 0  # fmt: skip
    assert longest <= 30


def test_a_profile_full_of_devices_is_drawn() -> None:
    plan: Plan = plan_of(ROBOTS["mega, many"], "en")
    assert len(plan.wires) >= 40
    assert len(layout_of(plan).routes) == len(plan.wires)


# -- the command


def test_the_command_lists_the_wires(tsc: Tsc) -> None:
    result = tsc("firmware", "--wiring", "--robot", "liner", "--lang", "es")
    assert (result.code, result.err) == (0, "")
    rows = result.out.splitlines()
    assert " ".join(rows[0].split()) == "cable pin de la placa pieza su terminal en el camino"
    assert " ".join(rows[4].split()) == "4 violeta 4 TB6612 STBY 10 kΩ del terminal a GND"
    assert rows[-1] == "Como página con un dibujo:  tsc firmware --wiring -o conexiones.html"
    (ground,) = [row for row in rows if row.startswith("GND ")]
    for end in ("placa: GND", "TB6612: GND", "botón de inicio: pata 2", "HC-05: GND"):
        assert end in ground


def test_on_a_narrow_terminal_the_last_column_is_broken(
    tsc: Tsc, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = tsc("firmware", "--wiring").out
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    monkeypatch.setattr(firmware_wiring, "get_terminal_size", lambda: os.terminal_size((80, 24)))
    narrow = tsc("firmware", "--wiring").out
    assert max(len(row) for row in whole.splitlines()) > 80
    assert max(len(row) for row in narrow.splitlines()) < 80
    assert sorted(narrow.split()) == sorted(whole.split())


def test_the_command_writes_a_page(tsc: Tsc, tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    result = tsc("firmware", "--wiring", "-o", page)
    assert (result.code, result.err) == (0, "")
    assert result.out == f"{page}: the wiring of TiniBot. Open it in a browser, or print it.\n"
    assert page.read_text(encoding="utf-8") == html_of(plan_of(robots.load("tinibot"), "en"))
    assert tsc("firmware", "--wiring", "-o", "-").out == page.read_text(encoding="utf-8")


def test_failed_writes_are_reported(tsc: Tsc, tmp_path: Path) -> None:
    for arguments, sentence in (
        (("-o", tmp_path / "no" / "page.html"), "cannot be written"),
        (("--robot", "tinybot"), "Did you mean tinibot?"),
        (("--robot", tmp_path / "missing.toml"), "There is no file"),
    ):
        result = tsc("firmware", "--wiring", *arguments)
        assert result.code == 2
        assert sentence in result.err


# -- the finished robot


@each_robot
def test_the_finished_robot_has_each_sensor_at_its_place(robot: Robot) -> None:
    for language in LANGUAGES:
        plan = plan_of(robot, language)
        svg = finished_of(plan)
        tree = Tree.fromstring(svg)
        _, _, width, height = map(float, tree.attrib["viewBox"].split())
        shown_texts = texts_of(svg)
        for name, place in robot.body.places.items():
            assert name in shown_texts
            x, y = places_of(plan, place)
            assert f'<circle cx="{x:g}" cy="{y:g}" r="9"' in svg
        for element in tree.iter(f"{SVG}circle"):
            assert 0 < float(element.attrib["cx"]) < width
            assert 0 < float(element.attrib["cy"]) < height
        assert f"{robot.body.length_cm:g} × {robot.body.width_cm:g} cm" in shown_texts


@pytest.mark.parametrize(("size_cm", "wheel_cm"), [(40, (6.5, 2.6)), (10, (4, 2))])
def test_a_small_plate_is_drawn_with_small_wheels(
    size_cm: float, wheel_cm: tuple[float, float]
) -> None:
    tinibot = robots.load("tinibot")
    body = tinibot.body._replace(length_cm=size_cm, width_cm=size_cm, wheel_base_cm=size_cm)
    svg = finished_of(plan_of(tinibot._replace(body=body), "en"))
    wheels = [
        element
        for element in Tree.fromstring(svg).iter(f"{SVG}rect")
        if element.get("fill") == "#333333"
    ]
    drawn_cm = [float(wheels[0].attrib[side]) / (520 / size_cm) for side in ("height", "width")]
    assert len(wheels) == 2 and drawn_cm == pytest.approx(wheel_cm)
    left, right = (float(wheel.attrib["x"]) for wheel in wheels)
    assert right - left == pytest.approx(520)  # length of the axle, which is the plate's width


def test_a_gripper_is_drawn_around_its_button_and_another_servo_has_an_arm() -> None:
    grabber = robots.load("grabber")
    for language, label in (("en", "gripper"), ("es", "pinza")):
        plan = plan_of(grabber, language)
        svg = finished_of(plan)
        assert {"GRIPPER", label} <= set(texts_of(svg))
        jaws = [
            [tuple(map(float, point.split(","))) for point in re.findall(r"[\d.]+,[\d.]+", path)]
            for path in re.findall(r'<path d="([^"]*)"', svg)
        ]
        assert len(jaws) == 2
        x, y = places_of(plan, grabber.body.places["BUTTON"])
        for side, points in zip((-1, 1), jaws, strict=True):
            assert all((point[0] - x) * side > 9 for point in points)  # next to the button's circle
            assert points[-1][1] < y < points[0][1]  # between a point behind it and one in front
    bare = grabber._replace(body=grabber.body._replace(places={}))
    svg = finished_of(plan_of(bare, "en"))
    assert "GRIPPER" in texts_of(svg) and "<path" not in svg and 'stroke-width="7"' in svg
    assert "GRIPPER" not in texts_of(finished_of(plan_of(robots.load("tinibot"), "en")))


def test_two_servos_share_the_front_edge() -> None:
    plan = plan_of(robots.load("grabber"), "en")
    servo = next(part for part in plan.parts if part.is_device and part.shape.icon == "servo")
    bare = plan._replace(body=plan.body._replace(places={}), parts=(*plan.parts, servo))
    middle, half = _FinishedDrawing(bare).x, _FinishedDrawing(bare).breadth / 2
    boxes = [element.attrib for element in Tree.fromstring(finished_of(bare)).iter(f"{SVG}rect")]
    centers = [
        float(box["x"]) + 26 - middle
        for box in boxes
        if (box["width"], box["height"]) == ("52", "30")
    ]
    assert centers == pytest.approx([-half / 2, half / 2], abs=0.1)


def test_the_longest_names_stay_in_the_finished_drawing() -> None:
    plan = plan_of(robots.load("grabber"), "en")
    long = "W" * 24
    parts = tuple(part._replace(title=long, label=long) for part in plan.parts)
    svg = finished_of(plan._replace(parts=parts))
    tree = Tree.fromstring(svg)
    right_edge = float(tree.attrib["viewBox"].split()[2])
    for element in tree.iter(f"{SVG}text"):
        x, anchor = float(element.attrib["x"]), element.attrib["text-anchor"]
        wide = _width(element.text or "", float(element.get("font-size", 14)))
        text_start = x - wide * {"start": 0, "middle": 0.5, "end": 1}[anchor]
        assert text_start >= 0 and text_start + wide <= right_edge, element.text


def places_of(plan: Plan, place: Place) -> tuple[float, float]:
    return _FinishedDrawing(plan).position(place.x_cm, place.y_cm)


def test_left_is_left_and_ahead_is_up() -> None:
    plan = plan_of(robots.load("tinibot"), "en")
    left, right, ahead = (
        places_of(plan, robots.load("tinibot").body.places[name])
        for name in ("LIGHT_L", "LIGHT_R", "DISTANCE")
    )
    assert left[0] < ahead[0] < right[0]
    assert ahead[1] < left[1] == right[1]


def test_a_page_has_both_drawings_and_fits_a_phone() -> None:
    page = html_of(plan_of(robots.load("tinibot"), "es"))
    assert page.count("<svg") == 2
    assert '<div class="drawing">' in page and '<div class="finished">' in page
    assert ".drawing { overflow-x: auto; }" in page  # the page explains the scrolling
    assert '<p class="slide">Desliza el dibujo' in page


def test_parts_have_quantities() -> None:
    for language in LANGUAGES:
        plan = plan_of(robots.load("tinibot"), language)
        needs = next(block for block in page_of(plan) if block.kind == "list").rows
        assert all(re.search(r"\d+ × ", row[0]) for row in needs)
        wires = next(int(match[1]) for row in needs if (match := re.search(
            r"(\d+) (?:jumper wires|cables de puente|fios jumper)", row[0])))  # fmt: skip
        joins = sum(len(block.rows) - 1 for block in page_of(plan) if block.kind == "ticks")
        assert joins < wires < 2 * joins
