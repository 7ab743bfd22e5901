"""A world that was drawn is not lost: not by another one, by a page that begins, nor by a run."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from tests.support.page_worlds import (
    NO_BORDER,
    drag,
    draw_wall,
    open_world_file,
    read_start,
    save_world,
    screen_position,
    wait_for_status,
)
from tests.support.studio import Pages, speak, wait_for_phase, wait_until_checked, write
from tiniscript.virtual import worlds

if TYPE_CHECKING:
    from playwright.sync_api import Page, Route

sampled = pytest.mark.sampled(of="kept worlds", keep=2)

OBSTACLES_START = (56, 82.5)


def list_own_worlds(page: Page) -> list[str]:
    shipped = len(worlds.names())
    return page.locator("#world option").all_inner_texts()[shipped:]


def walls_of(page: Page, label: str) -> int:
    """Choose a world of the list; return how many walls it has."""
    page.select_option("#world", label=label)
    page.click("#world_draw")
    count = len(save_world(page).walls)
    page.click("#world_done")
    return count


def test_a_world_is_not_overwritten_by_the_next(pages: Pages) -> None:
    page = pages.open()
    draw_wall(page)
    page.select_option("#world", "obstacles")
    drag(page, [OBSTACLES_START, (56, 90)])  # no pencil, and another world of one's own
    assert list_own_worlds(page) == ["my world", "my world (before)"]
    assert walls_of(page, "my world") == 0
    assert walls_of(page, "my world (before)") == 1
    # The worlds have changed places.
    assert list_own_worlds(page) == ["my world", "my world (before)"]
    assert page.locator("#world option:checked").inner_text() == "my world"
    page.reload()
    wait_until_checked(page)
    assert list_own_worlds(page) == ["my world", "my world (before)"]
    assert walls_of(page, "my world (before)") == 0
    assert walls_of(page, "my world (before)") == 1
    page.click("#world_draw")
    open_world_file(page, NO_BORDER, "aula.toml")  # nor to a file that is opened
    wait_for_status(page, "Opened: aula.toml")
    page.click("#world_done")
    assert list_own_worlds(page) == ["aula", "my world (before)", "my world (before 2)"]
    assert walls_of(page, "my world (before)") == 1
    assert list_own_worlds(page) == ["my world", "aula (before)", "my world (before 2)"]
    speak(page, "es")
    assert "mi mundo (de antes 2)" in list_own_worlds(page)


@sampled
def test_changes_of_one_world_create_no_other(page: Page) -> None:
    draw_wall(page)
    count = len(list_own_worlds(page))
    drag(page, [OBSTACLES_START, (56, 90)])
    page.click("#world_draw")
    page.click("#world_undo")
    page.click("#world_redo")
    assert abs(save_world(page).start.y_cm - 90) <= 1
    assert len(list_own_worlds(page)) == count


def test_five_previous_worlds_are_kept(page: Page) -> None:
    page.click("#world_draw")
    for k in range(8):
        open_world_file(page, NO_BORDER, f"w{k}.toml")
        wait_for_status(page, f"Opened: w{k}.toml")
    numbers = ["", " 2", " 3", " 4", " 5"]
    names = ["w7", *(f"w{6 - k} (before{number})" for k, number in enumerate(numbers))]
    assert list_own_worlds(page) == names
    page.click("#world_done")
    page.reload()
    wait_until_checked(page)
    assert list_own_worlds(page) == names


@sampled
def test_damaged_previous_worlds_do_no_harm(page: Page) -> None:
    draw_wall(page)
    page.click("#world_draw")
    save_world(page)
    page.click("#world_done")
    page.evaluate(
        """() => {
          sessionStorage.setItem('tiniscript.worlds_before', '7');
          localStorage.setItem('tiniscript.worlds_before', '[1, "no TOML", null, {}]');
        }"""
    )
    page.reload()
    wait_until_checked(page)
    assert list_own_worlds(page) == ["my world"]
    assert walls_of(page, "my world") == 1


@sampled
def test_nothing_is_drawn_before_the_kept_world_is_loaded(page: Page) -> None:
    draw_wall(page)
    page.select_option("#world", "obstacles")
    own_worlds = list_own_worlds(page)
    held_routes: list[Route] = []
    page.route("**/python.zip", lambda route: held_routes.append(route))
    page.reload()
    try:
        assert page.locator("#world_draw").is_disabled()
        page.locator("#arena").wait_for()
        drag(page, [OBSTACLES_START, (56, 120)])
        assert page.input_value("#world") == "obstacles"
        assert held_routes
    finally:
        for route in held_routes:
            route.continue_()
        page.unroute("**/python.zip")
    wait_until_checked(page)
    page.locator("#world_draw:not([disabled])").wait_for()
    assert list_own_worlds(page) == own_worlds
    assert walls_of(page, "my world") == 1


@sampled
def test_a_drag_ends_when_another_world_is_opened(page: Page) -> None:
    page.mouse.move(*screen_position(page, OBSTACLES_START))
    page.mouse.down()
    page.mouse.move(*screen_position(page, (56, 100)), steps=3)
    page.select_option("#world", "light")
    page.mouse.up()
    assert page.input_value("#world") == "light"
    light = worlds.load("light").start
    assert read_start(page) == (light.x_cm, light.y_cm)


@sampled
def test_an_abandoned_run_moves_nothing(page: Page) -> None:
    write(page, "F(30, 80)")
    page.select_option("#speed", "20")
    page.click("#run")
    wait_for_phase(page, "running")
    page.locator("#values dd").first.filter(has_text="s").wait_for()
    page.click("#world_draw")
    save_world(page)  # after the question about stopping is answered
    assert page.locator("#values dd").first.inner_text() == "–"
    page.click("#world_done")
    page.click("#run")
    wait_for_phase(page, "running")
    page.locator("#values dd").nth(1).filter(has_text="80").wait_for()
    page.select_option("#world", "light")
    assert read_start(page) == (40, 40)
    assert page.locator("#values dd").first.inner_text() == "–"
    wait_for_status(page, "Collect the flags in order (1)")


@sampled
def test_the_robot_stays_on_the_floor_at_any_size(page: Page) -> None:
    page.click("#world_draw")
    open_world_file(page, NO_BORDER)
    wait_for_status(page, "Opened")
    page.select_option("#world_part", label="Robot")
    page.locator("#arena").focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowUp")
    assert save_world(page).start[:2] == (120.06, 80)


def test_an_unwritable_world_is_reported(page: Page) -> None:
    """A mistake of ours: the page asks for the text of a world whose robot is off its floor."""
    page.click("#world_draw")
    page.evaluate(
        """() => {
          window.posted = Worker.prototype.postMessage;
          Worker.prototype.postMessage = function (message, ...rest) {
            const request = JSON.parse(message.request);
            if (request.do === 'write_world') request.form.start.x_cm = 999;
            window.posted.call(this, { ...message, request: JSON.stringify(request) }, ...rest);
          };
        }"""
    )
    try:
        page.click("#world_save")
        wait_for_status(page, "starts outside the floor")
        page.select_option("#world_part", label="Robot")
        page.locator("#arena").focus()
        page.keyboard.press("ArrowRight")
        wait_for_status(page, "starts outside the floor")
    finally:
        page.evaluate("() => { Worker.prototype.postMessage = window.posted; }")
