"""The start screen: one click to a robot that moves, earlier programs, and ways onward."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

import pytest

from tests.studio.test_page_programs import GOOD
from tests.support.studio import Pages, checked, image, noted, shown, write
from tiniscript import compile

if TYPE_CHECKING:
    from playwright.sync_api import Page, Route

PICTURES = ("dance", "square", "obstacle", "line", "light", "music")
START = "html[data-screen=start]"


@pytest.fixture
def start(pages: Pages) -> Page:
    """The page as somebody finds it who has never been here."""
    page = pages.open("start")
    checked(page)
    return page


@pytest.fixture
def again(page: Page) -> Iterator[Page]:
    """The same screen of a page that was here before; no earlier program is kept."""
    page.set_viewport_size({"width": 1366, "height": 768})
    page.click("#home")
    page.click("[data-begin=dance]")  # what the page has brought is not kept
    page.locator("html[data-phase=running]").wait_for(state="attached")
    page.evaluate("localStorage.clear()")
    page.click("#home")
    page.locator(START).wait_for(state="attached")
    yield page
    if screen(page) == "start":
        page.click("#start_write")
    page.click("#view_text")


def screen(page: Page) -> str:
    return str(page.evaluate("document.documentElement.dataset.screen"))


def test_one_click_moves_the_robot(again: Page) -> None:
    assert again.locator("[data-begin]").count() == len(PICTURES)
    for name in PICTURES:
        again.click(f"[data-begin={name}]")
        again.locator("html[data-phase=running]").wait_for(state="attached")
        motors = again.locator("#values div").filter(has_text="Motors")
        motors.filter(has_text=re.compile("[1-9]")).wait_for()
        assert again.inner_text("#status").startswith("The program is correct"), name
        assert again.locator("#arena").is_visible()
        again.click("#home")
        again.locator("html[data-phase=ended]").wait_for(state="attached")
    assert again.locator("#start_programs li").count() == 0  # the page has brought all of them


def test_the_robot_moves_before_the_blocks_are_fetched(pages: Pages) -> None:
    page = pages.open("start", is_alone=True).context.new_page()
    pages.watch(page)
    fetched: list[str] = []
    page.on("request", lambda request: fetched.append(request.url))
    held = []
    page.route("**/tiniscript.zip", lambda route: held.append(route))
    page.goto(pages.address)
    page.click("[data-begin=dance]")
    page.locator("#doing", has_text="The compiler is still working").wait_for()
    while not held:
        page.wait_for_timeout(20)
    assert not any("/blocks-" in each for each in fetched)
    held[0].continue_()
    page.locator("html[data-phase=running]").wait_for(state="attached")
    shown(page)
    assert any("/blocks-" in each for each in fetched)


def test_lessons_that_come_late_leave_a_run_alone(pages: Pages) -> None:
    page = pages.open("start")
    held: list[Route] = []
    page.route("**/lessons.zip", lambda route: held.append(route))
    page.click("#start_lessons")
    while not held:
        page.wait_for_timeout(20)
    assert not page.locator("#lesson_hint").is_visible()
    page.click("#home")
    page.click("[data-begin=obstacle]")
    page.locator("html[data-phase=running]").wait_for(state="attached")
    held[0].continue_()
    page.locator("#lesson_page[data-lesson]").wait_for(state="attached")
    assert page.get_attribute("html", "data-phase") == "running"
    assert page.input_value("#world") == "obstacles"
    page.click("#side_lessons")
    page.locator("#world option:checked", has_text="Lesson 1").wait_for(state="attached")


def test_who_gets_no_compiler_is_told_so_beside_the_robot(pages: Pages) -> None:
    page = pages.open("start", is_alone=True).context.new_page()
    page.route("**/tiniscript.zip", lambda route: route.abort())
    page.goto(pages.address)
    page.click("[data-begin=dance]")
    page.locator("#doing", has_text="The compiler did not start. Reload the page").wait_for()
    page.click("#side_lessons")
    page.locator("#lesson_said", has_text="The compiler did not start.").wait_for()


def test_nothing_empty_is_seen_before_the_texts_come(pages: Pages) -> None:
    page = pages.open("start", is_alone=True).context.new_page()
    held: list[Route] = []
    page.route("**/texts.*.json", lambda route: held.append(route))
    page.goto(pages.address, wait_until="domcontentloaded")
    while not held:
        page.wait_for_timeout(20)
    seen = page.locator("header :is(button, select):visible")
    assert seen.all_inner_texts() == ["STOP"]
    held[0].continue_()
    page.locator(START).wait_for(state="attached")
    assert seen.count() > 3


def test_the_address_says_which_screen_is_seen(again: Page) -> None:
    again.click("#start_write")
    assert (screen(again), again.evaluate("location.hash")) == ("program", "#editor")
    again.reload()
    again.locator("html[data-screen=program]").wait_for(state="attached")
    again.go_back()
    again.locator(START).wait_for(state="attached")
    again.go_forward()
    again.locator("html[data-screen=program]").wait_for(state="attached")
    again.click("#home")
    assert screen(again) == "start"
    again.click("#start_lessons")
    assert again.locator("#lessons").is_visible()
    again.click("#home")
    again.click("#start_robot")
    assert again.locator("#link").is_visible()


def test_a_link_opens_its_program_and_not_the_start(pages: Pages, start: Page) -> None:
    start.goto(f"{pages.address}#program={GOOD}")
    noted(start, "This program came with a link")
    assert screen(start) == "program"
    checked(start)
    assert image(start) == compile("SI|F(9, 90)").image
    other = pages.visit(f"{pages.address}#program={GOOD[:-8]}")
    noted(other, "The link is incomplete")
    assert screen(other) == "program"


def test_a_class_has_no_start(page: Page) -> None:
    assert page.locator("#home").is_visible()
    page.evaluate("document.documentElement.dataset.class = 'pupil'")
    assert not page.locator("#home").is_visible()
    page.evaluate("delete document.documentElement.dataset.class")


def test_earlier_programs_are_there_with_a_picture(start: Page) -> None:
    start.click("[data-begin=dance]")
    start.click("#view_text")
    write(start, "SI|LOOP(2)\n  F(1, 80)\n  BEEP(0.1, 440)\nEND_LOOP")
    start.click("#home")
    rows = start.locator("#start_programs button")
    assert rows.locator("strong").all_inner_texts() == ["dance"]
    bars = rows.locator("rect").evaluate_all(
        "all => all.map(e => [e.getAttribute('fill'), +e.getAttribute('x')])"
    )
    assert bars == [["#8a3c00", 3], ["#0b4f9e", 10], ["#00607a", 10]]
    start.click("[data-begin=square]")
    start.click("#home")
    rows.click()
    checked(start)
    assert screen(start) == "program"
    assert start.evaluate("document.documentElement.dataset.phase") != "running"
    assert image(start) == compile("SI|LOOP(2)\nF(1, 80)\nBEEP(0.1, 440)\nEND_LOOP").image


def test_a_second_press_is_not_for_what_comes_to_the_place_of_the_first(start: Page) -> None:
    start.dblclick("#start_write")
    assert start.get_attribute("#side_real", "aria-pressed") == "false"
    shown(start)
    start.click("#home")
    start.dblclick("[data-begin=dance]", position={"x": 40, "y": 100})
    assert screen(start) == "program"
    assert start.locator(".blocklyToolboxSelected").count() == 0
    start.locator("html[data-phase=running]").wait_for(state="attached")
    start.click("#home")
    start.dblclick("#start_write")  # and STOP is heard at once
    start.dblclick("#run")
    start.locator("html[data-phase=running]").wait_for(state="attached")
    start.click("#stop")
    start.locator("html[data-phase=ended]").wait_for(state="attached")


def test_nor_is_a_second_tap(pages: Pages) -> None:
    page = pages.open("start", has_touch=True)
    box = page.locator("#start_write").bounding_box()
    assert box
    for _ in range(2):
        page.touchscreen.tap(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    shown(page)
    assert page.get_attribute("#side_real", "aria-pressed") == "false"


def test_the_keyboard_alone_is_enough(again: Page) -> None:
    again.locator("#language").focus()
    visited = []
    for _ in range(6 + len(PICTURES)):
        again.keyboard.press("Tab")
        visited.append(again.evaluate("(e => e.dataset.begin ?? e.id)(document.activeElement)"))
    assert visited == [
        "theme", "open", "stop", *PICTURES, "start_write", "start_lessons", "start_robot",
    ]  # fmt: skip
    again.locator("[data-begin=square]").focus()
    again.keyboard.press("Enter")
    again.locator("html[data-phase=running]").wait_for(state="attached")
    assert again.evaluate("document.activeElement.id") == "stop"
    again.keyboard.press("Space")
    again.locator("html[data-phase=ended]").wait_for(state="attached")
