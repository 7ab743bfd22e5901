"""A world that was drawn is not lost: not by another one, by a page that begins, nor by a run."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from tests.studio.test_page_robot import in_phase
from tests.studio.test_page_worlds import put, read_start, said, saved
from tests.support.studio import write

if TYPE_CHECKING:
    from playwright.sync_api import Page

OBSTACLES_START = (56, 75)
NO_BORDER = b"""[floor]
width_cm = 120.06
height_cm = 80.04
border = false
[start]
x_cm = 118
y_cm = 78
"""


@pytest.fixture(autouse=True)
def at_rest(page: Page) -> None:
    page.set_viewport_size({"width": 1366, "height": 768})
    if page.locator("#world_done").is_visible():
        page.click("#world_done")
    page.select_option("#world", "obstacles")


def test_a_run_that_was_left_moves_nothing(page: Page) -> None:
    write(page, "F(30, 80)")
    page.select_option("#speed", "20")
    page.click("#run")
    in_phase(page, "running")
    page.locator("#values dd").first.filter(has_text="s").wait_for()
    page.click("#world_draw")
    saved(page)  # behind the answer to stop
    assert page.locator("#values dd").first.inner_text() == "–"
    page.click("#world_done")
    page.click("#run")
    in_phase(page, "running")
    page.locator("#values dd").nth(1).filter(has_text="80").wait_for()
    page.select_option("#world", "light")
    assert read_start(page) == (40, 40)
    assert page.locator("#values dd").first.inner_text() == "–"
    said(page, "Press Run")


def test_the_robot_stays_on_a_floor_of_any_size(page: Page) -> None:
    page.click("#world_draw")
    put(page, NO_BORDER)
    said(page, "Opened")
    page.select_option("#world_part", label="Robot")
    page.locator("#arena").focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowUp")
    assert saved(page).start[:2] == (120.06, 80)
