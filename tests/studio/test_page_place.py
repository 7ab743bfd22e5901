"""The line and the block that a real robot runs now, marked in the page through `tsc studio`."""

from __future__ import annotations

from time import monotonic
from typing import TYPE_CHECKING

from tests.studio.test_page_link import first, first_robot, page, robot, said, server  # noqa: F401
from tests.support.studio import checked, shown, write
from tests.support.waiting import HANGS_S

if TYPE_CHECKING:
    from playwright.sync_api import Page, Route

DRIVE = "F(3, 80);\nR(3, 60)"  # parts that differ, and longer than a busy page is late


def marked(page: Page, part: str) -> None:  # noqa: F811
    page.locator(".cm-running", has_text=part).wait_for(state="attached")


def unmarked(page: Page) -> None:  # noqa: F811
    page.locator(".cm-running").wait_for(state="detached")
    assert page.locator("#blocks .running").count() == 0


def test_the_line_that_runs_is_marked_until_the_end(page: Page) -> None:  # noqa: F811
    write(page, DRIVE)
    page.click("#view_blocks")
    shown(page)
    page.click("#link_upload")
    for part in DRIVE.split(";\n"):
        marked(page, part)
        assert page.locator("#blocks .blocklyDraggable.running").count() == 1
    page.click("#view_text")
    said(page, "Done.")
    unmarked(page)


def test_an_edit_takes_the_mark_away_and_its_undo_brings_it_back(page: Page) -> None:  # noqa: F811
    write(page, "F(60, 80)")
    page.click("#link_upload")
    page.locator(".cm-running").wait_for()
    page.locator(".cm-content").focus()
    page.keyboard.press("Control+End")
    page.keyboard.insert_text(";\nW(1)")
    unmarked(page)
    checked(page)
    unmarked(page)
    page.keyboard.press("Control+z")
    page.locator(".cm-running").wait_for()
    page.click("#link_leave")
    unmarked(page)


def upload_until_told(page: Page, at: int | None = None) -> None:  # noqa: F811
    """Upload, and wait until the page was told a place of the robot, or `at` in its stead."""
    told: list[int] = []

    def changed(route: Route) -> None:
        response = route.fetch()
        answer = response.json()
        for each in answer.get("news", []):
            if each.get("event") == "PLACE":
                each["at"] = each["at"] if at is None else at
                told.append(each["at"])
        route.fulfill(response=response, json=answer)

    page.route("**/robots", changed)
    page.click("#link_upload")
    end_s = monotonic() + HANGS_S
    while not told:
        assert monotonic() < end_s, "no place was told"
        page.wait_for_timeout(20)
    page.unroute_all(behavior="wait")
    page.wait_for_timeout(200)


def test_a_place_outside_of_the_program_marks_nothing(page: Page) -> None:  # noqa: F811
    write(page, "F(60, 80)")
    upload_until_told(page, 60_000)
    assert page.locator(".cm-running").count() == 0


def test_a_breakpoint_keeps_its_mark_while_the_robot_runs(page: Page) -> None:  # noqa: F811
    """The virtual robot waits at the first line; the real one is at the second one."""
    write(page, "W(0.1);\nF(60, 80)")
    page.click("#side_virtual")
    page.locator(".cm-lineNumbers .cm-gutterElement").filter(has_text="1").last.click()
    page.click("#run")
    marked(page, "W(0.1)")
    page.locator("#doing").filter(has_text="Stopped before line 1.").wait_for()
    page.click("#side_real")
    upload_until_told(page)
    assert page.locator(".cm-running").all_inner_texts() == ["W(0.1)"]
    page.click("#side_virtual")
    page.click("#pause")  # goes on
    marked(page, "F(60, 80)")
