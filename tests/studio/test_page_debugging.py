"""Breakpoints, steps and values in the page: by mouse and keys, in the text and in blocks."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest

from tests.support.page_breakpoints import COUNTING_PROGRAM, press_margin
from tests.support.page_robot import running, value, wait_for_running
from tests.support.studio import (
    colors_of,
    wait_for_blocks,
    wait_for_note,
    wait_for_phase,
    wait_until_checked,
    write,
)
from tiniscript import run

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = pytest.mark.sampled(files="sides of the page", keep=3)
sampled = pytest.mark.sampled(of="breakpoints of the page", keep=3)


@pytest.fixture
def page(page: Page) -> Page:
    page.select_option("#speed", "20")
    return page


def points(page: Page) -> int:
    return page.locator(".cm-breakpoints").get_by_text("●").count()


def wait_until_stopped(page: Page, line: int) -> None:
    page.locator("#doing").filter(has_text=f"Stopped before line {line}.").wait_for()


def test_a_run_halts_at_a_breakpoint_each_time_and_shows_values(page: Page) -> None:
    write(page, COUNTING_PROGRAM)
    press_margin(page, 5)
    page.click("#run")
    for x in (1, 2, 3):
        row = page.locator("#values div").filter(has=page.get_by_text("X", exact=True))
        row.get_by_text(str(x), exact=True).wait_for()
        wait_until_stopped(page, 5)
        assert running(page) == "SHOW(X * X)"
        page.click("#pause")
    wait_for_phase(page, "ended")
    assert value(page, "X") == "3"
    expected_texts = [f"{event.ms} {event.text}" for event in run(COUNTING_PROGRAM).events]
    assert (page.locator("#trace").text_content() or "").split("\n") == expected_texts


@sampled
def test_a_breakpoint_on_an_empty_line_moves_to_the_next_part(page: Page) -> None:
    """Only the left button sets one."""
    write(page, COUNTING_PROGRAM)
    numbers = page.locator(".cm-lineNumbers .cm-gutterElement")
    numbers.filter(has_text="5").last.click(button="right")
    numbers.filter(has_text="3").last.click(button="middle")
    numbers.filter(has_text="5").last.click(modifiers=["Control"])  # a Mac has its menu by that
    assert points(page) == 0
    press_margin(page, 4)
    assert page.locator(".cm-breakpoint").all_inner_texts() == ["S"]  # the line of SHOW
    press_margin(page, 5)
    assert points(page) == 0
    press_margin(page, 6)
    wait_for_note(page, "There is nothing to stop at on line 6 or after it.")
    assert points(page) == 0


@sampled
def test_a_breakpoint_moves_and_disappears_with_its_text(page: Page) -> None:
    write(page, "F(0.1, 80);\nSHOW(7);\nB(0.1, 80)")
    page.keyboard.press("Control+Home")
    page.keyboard.press("ArrowDown")
    page.keyboard.press("F9")
    assert points(page) == 1
    page.keyboard.insert_text("W(0.1);\n")
    wait_until_checked(page)
    page.click("#run")
    wait_until_stopped(page, 3)
    page.locator(".cm-content").focus()
    page.keyboard.press("Control+a")
    page.keyboard.press("Delete")
    wait_until_checked(page)
    assert points(page) == 0


@sampled
def test_one_line_may_have_several_breakpoints(page: Page) -> None:
    write(page, "SI|SHOW(1);SHOW(2);SHOW(3)")
    for _ in range(2):
        page.keyboard.press("F9")  # no part begins after the last one, so that one gets it
        for _ in range(9):
            page.keyboard.press("ArrowLeft")
    assert page.locator(".cm-breakpoint").count() == 2
    page.click("#run")
    for part in ("SHOW(2)", "SHOW(3)"):
        wait_for_running(page, part)
        wait_for_phase(page, "paused")
        page.click("#pause")
    wait_for_phase(page, "ended")


@sampled
def test_breakpoints_are_shown_and_set_at_blocks(page: Page) -> None:
    write(page, COUNTING_PROGRAM)
    press_margin(page, 3)
    page.click("#view_blocks")
    wait_for_blocks(page)
    page.locator("#blocks .breakpoint").filter(has_text="+").wait_for()
    show = page.locator("#blocks .blocklyDraggable", has_text="SHOW").last
    show.click(button="right", position={"x": 6, "y": 6})
    page.get_by_role("menuitem", name="Breakpoint on or off (F9)").click()
    page.locator("#blocks .show.breakpoint").wait_for()
    page.click("#run")
    for words in (r"\+", "show", r"\+"):
        message_element = page.locator(
            "#doing", has_text=re.compile(f"Stopped before “.*{words}.*”")
        )
        message_element.wait_for()
        page.locator("#blocks .running.breakpoint").wait_for()
        page.click("#pause")
    page.locator("#blocks .show .blocklyText", has_text="SHOW").click()
    page.keyboard.press("F9")
    page.locator("#blocks .show.breakpoint").wait_for(state="detached")


@sampled
def test_a_breakpoint_can_be_set_and_removed_while_running(page: Page) -> None:
    write(page, "LOOP(FOREVER);\n  F(0.2, 80);\n  SHOW(1);\nEND_LOOP")
    page.click("#run")
    wait_for_running(page)
    press_margin(page, 3)
    wait_until_stopped(page, 3)
    press_margin(page, 3)
    page.click("#pause")
    wait_for_phase(page, "running")
    page.wait_for_timeout(200)
    wait_for_phase(page, "running")


@sampled
def test_breakpoints_of_a_running_program_are_unaffected_by_edits(
    page: Page,
) -> None:
    """Its lines are others then; and one that is taken away no longer stops it."""
    write(page, "W(0.3);\nSHOW(1);\nSHOW(2);\nLOOP(FOREVER);\n  SHOW(3);\n  W(0.1);\nEND_LOOP")
    press_margin(page, 1)
    press_margin(page, 3)
    page.click("#run")
    wait_until_stopped(page, 1)
    page.locator(".cm-content").focus()
    page.keyboard.press("Control+Home")
    page.keyboard.insert_text("SHOW(9);\n")
    wait_until_checked(page)
    page.click("#pause")
    wait_for_phase(page, "paused")
    page.locator("#trace").filter(has_text="SHOW 1").wait_for(state="attached")
    assert "SHOW 2" not in (page.locator("#trace").text_content() or "")
    assert points(page) == 2
    press_margin(page, 4)  # the next one, that the loop never reaches again
    press_margin(page, 6)
    page.click("#pause")
    page.locator("#trace").filter(has_text="SHOW 3").wait_for(state="attached")
    wait_for_phase(page, "running")
    page.keyboard.press("Escape")


@sampled
def test_a_breakpoint_can_be_removed_after_an_edit(page: Page) -> None:
    write(page, "LOOP(FOREVER);\n  W(0.1);\n  SHOW(3);\nEND_LOOP")
    press_margin(page, 3)
    page.click("#run")
    wait_until_stopped(page, 3)
    page.locator(".cm-content").focus()
    page.keyboard.press("Control+End")
    page.keyboard.insert_text(";\nSHOW(9)")
    wait_until_checked(page)
    press_margin(page, 3)
    assert points(page) == 0
    page.click("#pause")
    page.locator("#trace").filter(has_text=re.compile("(SHOW 3.*){4}", re.S)).wait_for(
        state="attached"
    )
    page.keyboard.press("Escape")


@sampled
def test_breakpoints_on_every_line_work(page: Page) -> None:
    """In a program of the largest size, and after its end; the first ones work."""
    write(page, "\n".join(f"W({k + 1})" for k in range(150)) + "\n// a note" * 50)
    press_ms = page.locator(".cm-content").evaluate(
        "(content) => { const key = (key, keyCode) => content.dispatchEvent(new KeyboardEvent("
        "'keydown', {key, keyCode, bubbles: true, cancelable: true}));"
        " const began = performance.now();"
        " for (let k = 0; k < 200; k += 1) { key('F9', 120); key('ArrowUp', 38); }"
        " return performance.now() - began; }"
    )
    assert press_ms < 10_000
    page.click("#run")
    wait_until_stopped(page, 1)
    page.click("#pause")
    wait_until_stopped(page, 2)


@sampled
def test_curves_of_sensors_variables_and_values_are_drawn(page: Page) -> None:
    write(page, COUNTING_PROGRAM)
    page.click("#seen_plot")
    page.click("#run")
    wait_for_phase(page, "ended")
    rows = {"11,79,158", "168,32,15", "13,96,64", "122,75,0", "91,42,134"}
    assert rows <= colors_of(page, "#plot")
