"""A world is drawn and changed by hand in the page: with a mouse, a finger and keys alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from tests.support.page_worlds import (
    Place,
    drag,
    open_world_file,
    read_start,
    save_world,
    screen_position,
    wait_for_status,
)
from tests.support.studio import (
    SETTLED_SCRIPT,
    Pages,
    finger,
    speak,
    turn,
    wait_for_phase,
    wait_until_checked,
    write,
)
from tiniscript import compile
from tiniscript.studio.simulation import Simulation
from tiniscript.virtual import worlds
from tiniscript.virtual.worlds import read

if TYPE_CHECKING:
    from collections.abc import Sequence

    from playwright.sync_api import Page

pytestmark = pytest.mark.sampled(files="sides of the page", keep=3)
sampled = pytest.mark.sampled(of="details of worlds", keep=2)


STORED_WORLD_SCRIPT = "() => localStorage.getItem('tiniscript.world')"


def number(page: Page, key: str) -> float:
    return float(page.input_value(f"#world_{key}"))


def read_chosen_world(page: Page) -> str:
    return page.locator("#world_part option:checked").inner_text()


@pytest.fixture
def floor(page: Page) -> Page:
    """A page on which the shipped obstacles can be changed."""
    page.click("#world_draw")
    return page


def test_world_parts_are_added_moved_and_deleted_by_mouse(floor: Page) -> None:
    shipped_world = worlds.load("obstacles")
    floor.click("#world_add_boxes")
    assert floor.locator("#world_add_boxes").get_attribute("aria-pressed") == "true"
    drag(floor, [(140, 60), (170, 80)])
    assert read_chosen_world(floor) == "Box 7"
    drag(floor, [(155, 70), (155, 110), (145, 120)])
    world = save_world(floor)
    corners = sorted((round(x), round(y)) for x, y in world.boxes[-1])
    assert all(abs(a - b) <= 1 for (a, _), b in zip(corners, (130, 130, 160, 160), strict=True))
    assert world.boxes[:-1] == shipped_world.boxes
    assert set(world.labels.values()) == {world.name}  # the name in its file
    floor.click("#world_delete")
    assert save_world(floor).boxes == shipped_world.boxes
    floor.click("#world_undo")
    floor.click("#world_undo")  # the drag, too
    corners = sorted((round(x), round(y)) for x, y in save_world(floor).boxes[-1])
    assert all(abs(a - b) <= 1 for (a, _), b in zip(corners, (140, 140, 170, 170), strict=True))
    floor.click("#world_redo")
    floor.select_option("#world_part", label="Box 7")
    assert abs(number(floor, "x_cm") - 145) <= 1 and abs(number(floor, "y_cm") - 120) <= 1


@sampled
def test_an_undo_during_a_drag_puts_the_part_back(floor: Page) -> None:
    shipped_world = worlds.load("obstacles")
    floor.click("#world_add_boxes")
    drag(floor, [(140, 60), (170, 80)])
    expected_world = save_world(floor)
    for undo in ("key", "button"):
        floor.mouse.move(*screen_position(floor, (155, 70)))
        floor.mouse.down()
        floor.mouse.move(*screen_position(floor, (155, 110)), steps=4)
        floor.keyboard.press("Delete")  # the object being dragged is not deleted
        if undo == "key":
            floor.keyboard.press("Control+z")
        else:
            # Touched by a second finger.
            floor.evaluate("document.querySelector('#world_undo').click()")
        floor.mouse.move(*screen_position(floor, (155, 120)), steps=2)
        floor.mouse.up()
        assert save_world(floor).boxes == expected_world.boxes
    floor.click("#world_undo")
    assert save_world(floor).boxes == shipped_world.boxes


def picture(page: Page) -> str:
    """Return the floor's picture once it is drawn."""
    page.evaluate(SETTLED_SCRIPT)
    url: str = page.evaluate("document.querySelector('#arena').toDataURL()")
    return url


@sampled
def test_a_cancelled_stroke_disappears(floor: Page) -> None:
    start = save_world(floor).start
    floor.keyboard.down("Control")
    drag(floor, [(56, 82.5), (56, 90)])  # a press with Ctrl is the menu of a Mac
    floor.keyboard.up("Control")
    assert save_world(floor).start == start
    drag(floor, [(56, 82.5), (56, 90)])  # creates a step to undo
    for stroke_end in ("cancel", "undo"):
        if floor.get_attribute("#world_add_walls", "aria-pressed") == "false":
            floor.click("#world_add_walls")
        expected_text = picture(floor)
        floor.mouse.move(*screen_position(floor, (60, 30)))
        floor.mouse.down()
        floor.mouse.move(*screen_position(floor, (100, 60)), steps=4)
        assert picture(floor) != expected_text
        if stroke_end == "undo":
            # Touched by a second finger.
            floor.evaluate("document.querySelector('#world_undo').click()")
        else:
            floor.locator("#arena").dispatch_event("pointercancel")
        shown_text = picture(floor)
        floor.mouse.up()
        assert shown_text == expected_text, stroke_end
        assert save_world(floor).walls == ()


@sampled
def test_each_kind_of_part_is_drawn_and_selectable(floor: Page) -> None:
    floor.click("#world_add_walls")
    drag(floor, [(60, 30), (100, 60)])
    floor.click("#world_add_lines")
    drag(floor, [(150, 60), (150, 90), (120, 140), (60, 140)])
    floor.click("#world_add_lamps")
    floor.mouse.click(*screen_position(floor, (200, 180)))
    world = save_world(floor)
    assert [(round(x), round(y)) for x, y in world.walls[0]] == [(60, 30), (100, 60)]
    line = [(round(x), round(y)) for x, y in world.lines[0].points]
    assert (line[0], line[-1]) == ((150, 60), (60, 140)) and 3 <= len(line) <= 9
    assert [round(coordinate) for coordinate in world.lamps[0].place] == [200, 180]
    name_at = {(80, 45): "Wall 1", (100, 140): "Line 1", (200, 180): "Lamp 1", (56, 82.5): "Robot",
               (110, 100): "Box 1", (10, 190): "Floor"}  # fmt: skip
    for place, name in name_at.items():
        floor.mouse.click(*screen_position(floor, place))
        assert read_chosen_world(floor) == name
    floor.mouse.click(*screen_position(floor, (80, 45)))
    drag(floor, [(60, 30), (60, 50)])  # an end of the wall, by its handle
    assert [(round(x), round(y)) for x, y in save_world(floor).walls[0]] == [(60, 50), (100, 60)]


def test_the_world_editor_works_by_keyboard(floor: Page) -> None:
    press = floor.keyboard.press
    floor.click("#world_done")
    floor.locator("#world_draw").focus()
    press("Enter")
    assert floor.evaluate("document.activeElement.id") == "world_part"
    floor.locator("#world_add_walls").focus()
    press("Enter")  # pressed at the centre, without a finger
    assert read_chosen_world(floor) == "Wall 1"
    floor.locator("#arena").focus()
    for key in ("ArrowUp", "Shift+ArrowLeft", "p", "p", "Shift+ArrowDown", "+", "Shift+ArrowUp"):
        press(key)
    walls = save_world(floor).walls
    assert walls == (((89, 105), (129, 104), (149, 104.5)),)
    floor.locator("#arena").focus()
    press("Control+z")
    press("Control+z")
    assert save_world(floor).walls == (((89, 105), (129, 104)),)
    floor.locator("#arena").focus()
    press("Delete")
    wait_for_status(floor, "Deleted: Wall 1")
    assert save_world(floor).walls == ()
    floor.select_option("#world_part", label="Robot")
    floor.locator("#arena").focus()
    press("r")
    press("ArrowRight")
    assert save_world(floor).start == (61, 82.5, 15)
    floor.locator("#world_heading").fill("-90")
    press("Enter")
    assert save_world(floor).start.heading == -90
    for wrong_number in ("", "1e9"):
        floor.locator("#world_x_cm").fill(wrong_number)
        press("Enter")
        assert 0 <= save_world(floor).start.x_cm <= 220
    floor.select_option("#world_part", label="Floor")
    floor.locator("#world_width_cm").fill("100")
    press("Enter")
    floor.uncheck("#world_has_border")
    world = save_world(floor)  # the robot is still on the floor
    assert (world.width_cm, world.start.x_cm, world.has_border) == (100, 100, False)


@sampled
def test_a_handle_turns_the_robot_and_flags_can_be_placed(floor: Page) -> None:
    floor.click("#world_add_boxes")
    drag(floor, [(140, 60), (200, 80)])
    drag(floor, [(210, 70), (205, 105), (170, 110)])  # the handle of a part that is long
    assert read_chosen_world(floor) == "Box 7" and abs(number(floor, "heading") - 90) <= 5
    floor.select_option("#world_part", label="Floor")
    floor.mouse.click(*screen_position(floor, (56, 82.5)))
    drag(floor, [(75, 82.5), (75, 98), (56, 103)])  # the handle in front of it
    assert save_world(floor).start == (56, 82.5, 90)
    floor.click("#world_undo")
    assert save_world(floor).start == (56, 82.5, 0)
    floor.click("#world_add_flags")
    floor.mouse.click(*screen_position(floor, (150, 100)))
    assert read_chosen_world(floor) == "Flag 1"
    floor.check("#world_rests")
    flag = save_world(floor).flags[0]
    assert (round(flag.place.x), round(flag.place.y), flag.reach_cm, flag.needs_rest) == (
        150, 100, 12, True,
    )  # fmt: skip
    floor.select_option("#world_part", label="Floor")
    floor.locator("#world_seconds").fill("30")
    floor.keyboard.press("Enter")
    assert save_world(floor).seconds == 30


@sampled
@pytest.mark.parametrize("step", ["world_undo", "world_redo"])
def test_undo_steps_of_a_world_do_not_affect_another(floor: Page, step: str) -> None:
    drag(floor, [(56, 82.5), (56, 90)])
    floor.click("#world_undo")
    if step == "world_undo":
        floor.click("#world_redo")
    assert floor.locator(f"#{step}").is_enabled()
    floor.click("#world_done")
    floor.select_option("#world", "maze")
    floor.click("#world_draw")
    assert floor.locator(f"#{step}").is_disabled()


@sampled
def test_no_part_leaves_the_floor(floor: Page) -> None:
    drag(floor, [(56, 82.5), (-60, 300)])
    assert save_world(floor).start[:2] == (0, 200)
    wait_for_status(floor, "does not fit there")
    floor.click("#world_undo")
    assert save_world(floor).start[:2] == (56, 82.5)


def draw(page: Page, places: Sequence[Place]) -> None:
    """Go along a way on the floor with a finger."""
    page.evaluate(SETTLED_SCRIPT)  # earlier taps may have changed the floor's size
    finger(page, [screen_position(page, place) for place in places])


@sampled
def test_a_finger_draws_and_drags_on_a_small_screen(pages: Pages) -> None:
    page = pages.open(viewport={"width": 390, "height": 844}, has_touch=True, locale="es-ES")
    turn(page, "robot")
    page.tap("#world_draw")
    page.tap("#world_add_lines")
    draw(page, [(60, 40), (100, 40), (150, 60), (160, 80)])
    assert read_chosen_world(page) == "Línea 1"
    draw(page, [(56, 82.5), (56, 97.5), (60, 110)])
    assert read_chosen_world(page) == "Robot"
    world = save_world(page)
    assert abs(world.start.x_cm - 60) <= 1 and abs(world.start.y_cm - 110) <= 1
    assert len(world.lines) == 1 and abs(world.lines[0].points[-1].x - 160) < 1
    page.tap("#world_done")
    assert page.locator("#world option:checked").inner_text() == "mi mundo"
    kept_state = page.evaluate(STORED_WORLD_SCRIPT)
    draw(page, [(60, 110), (60, 100)])  # outside of the drawing, too
    page.wait_for_function(f"before => ({STORED_WORLD_SCRIPT})() !== before", arg=kept_state)
    page.reload()
    wait_until_checked(page)
    assert page.locator("#world option:checked").inner_text() == "mi mundo"
    turn(page, "robot")
    page.tap("#world_draw")
    redrawn = save_world(page)
    assert abs(redrawn.start.y_cm - 100) <= 1 and redrawn.lines == world.lines


def test_the_floor_replaces_the_curves(page: Page) -> None:
    page.click("#seen_plot")
    page.click("#world_draw")
    assert page.locator("#arena").is_visible() and not page.locator("#plot").is_visible()
    page.click("#world_done")
    assert page.get_attribute("#seen_arena", "aria-pressed") == "true"


@sampled
def test_the_robot_begins_where_it_was_put(page: Page) -> None:
    """In a shipped world, without drawing, and again after a run."""
    page.select_option("#world", "light")
    write(page, "SHOW(DISTANCE);\nF(1, 80)")
    page.select_option("#speed", "20")
    page.mouse.move(*screen_position(page, (40, 40), (240, 180)))
    page.mouse.down()
    page.mouse.move(*screen_position(page, (80, 60), (240, 180)), steps=3)
    page.mouse.up()
    assert page.locator("#world option:checked").inner_text() == "my world"
    page.click("#run")
    wait_for_phase(page, "ended")
    shown_text = (page.locator("#trace").text_content() or "").partition("SHOW ")[2].split()[0]
    page.click("#world_draw")
    world = save_world(page)
    page.click("#world_done")
    assert abs(world.start.x_cm - 80) <= 1 and world.lamps == worlds.load("light").lamps
    simulation = Simulation("tinibot", world, compile("SHOW(DISTANCE);\nF(1, 80)").image)
    simulation.advance(2000)
    events = [event.text for event in simulation.robot.take_events()]
    assert f"SHOW {shown_text}" in events
    page.select_option("#world", "light")
    assert read_start(page) == (40, 40)


OWN_WORLD = b"""[floor]
width_cm = 90
height_cm = 70
[start]
x_cm = 30
y_cm = 30
[[boxes]]
x_cm = 70
y_cm = 50
length_cm = 10
width_cm = 10
heading = 270
[labels]
en = "<img src=x onerror=alert(1)>"
es = "aula"
"""


@sampled
def test_a_file_is_opened_or_refused_with_a_reason(floor: Page) -> None:
    open_world_file(floor, OWN_WORLD)
    wait_for_status(floor, "Opened: own.toml")
    expected_world = read(OWN_WORLD.decode(), "own")
    world = save_world(floor)
    assert (world.start, world.width_cm, world.labels) == (
        expected_world.start,
        90,
        expected_world.labels,
    )
    rounded_box = [(round(x, 2), round(y, 2)) for x, y in world.boxes[0]]
    assert rounded_box == [(round(x, 2), round(y, 2)) for x, y in expected_world.boxes[0]]
    assert floor.locator("img").count() == 0
    for data, message in (
        (b"\xff", "UTF-8"),
        (b"[floor]\nwidth_cm = 1\n", "own.toml was not opened. "),
        (OWN_WORLD.replace(b"x_cm = 30", b"x_cm = 900"), "starts outside the floor"),
        (b"#" * 3_000_000, "has more than"),
    ):
        open_world_file(floor, data)
        wait_for_status(floor, message)
        assert floor.input_value("#world_width_cm") == "90"
    speak(floor, "es")
    open_world_file(floor, b"\xff")
    wait_for_status(floor, "no se abrió")


def test_a_damaged_world_does_no_harm(page: Page) -> None:
    write(page, "SI|F(1, 80)")
    page.evaluate(
        """() => { for (const each of [sessionStorage, localStorage]) {
          each.setItem('tiniscript.world', 'no TOML');
          const work = JSON.parse(each.getItem('tiniscript.work'));
          each.setItem('tiniscript.work', JSON.stringify({...work, world: ':own'}));
        } }"""
    )
    page.reload()
    wait_until_checked(page)
    assert page.input_value("#world") == "obstacles"
    wait_for_status(page, "drew can no longer be read.")
    page.click("#run")
    wait_for_phase(page, "running")
    page.keyboard.press("Escape")
