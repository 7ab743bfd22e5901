"""The page and a robot by Web Serial: the browser's own, and the robot's firmware on a pty."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests.support import studio, studio_serial
from tests.support.page_link import wait_for_message
from tests.support.pty_robot import PtyRobot
from tests.support.studio import LONGEST_HANG_MS, enter, hang, start_drive, write
from tiniscript import robots

if TYPE_CHECKING:
    from playwright.sync_api import BrowserContext, Page, Playwright

pytestmark = pytest.mark.root


@pytest.fixture(scope="module")
def robot() -> Iterator[PtyRobot]:
    with PtyRobot(robots.load("tinibot").kit) as pty_robot:
        yield pty_robot


@pytest.fixture(scope="module")
def context(
    playwright: Playwright, robot: PtyRobot, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[BrowserContext]:
    """A browser of its own: a page that no `tsc studio` has given, as on any static host."""
    reason = studio_serial.missing()
    if reason:  # skipped in CI too, without root or a serial port
        pytest.skip(reason)
    folder: Path = tmp_path_factory.mktemp("serial")
    with (
        studio.serve_page() as server,
        studio_serial.context(
            playwright, folder, robot.port, server.address
        ) as opened_browser_context,
    ):
        first_page = opened_browser_context.pages[0]
        enter(first_page, server.address)
        yield opened_browser_context


@pytest.fixture
def page(context: BrowserContext) -> Page:
    """A page that has met its robot."""
    current_page = context.pages[0]
    current_page.click("#side_real")
    if current_page.locator("html[data-robot=connected]").count() == 0:
        current_page.click("#link_look")
        current_page.locator("#link_port option").first.wait_for(state="attached")
        current_page.click("#link_connect")
        current_page.locator("html[data-robot=connected]").wait_for(state="attached")
    return current_page


def test_a_program_is_sent_and_runs(page: Page, robot: PtyRobot) -> None:
    write(page, "SHOW(2.5);\nF(0.2, 80);\nX = 0;\nSHOW(1 / X)")
    page.click("#link_upload")
    wait_for_message(page, "the program divided by 0.")
    assert page.locator("#link_shown").inner_text() == "2.5"
    assert "MOTORS 80 80" in robot.actions


def test_stop_stops(page: Page, robot: PtyRobot) -> None:
    start_drive(page, robot)
    page.keyboard.press("Escape")
    wait_for_message(page, "Stopped: the robot has confirmed the stop.")
    assert not robot.moves


def test_a_page_that_hangs_stops_its_robot(page: Page, robot: PtyRobot) -> None:
    start_drive(page, robot)
    start_ms = robot.robot_ms
    hang(page, LONGEST_HANG_MS)
    assert robot.standstill_after_ms(start_ms) < LONGEST_HANG_MS  # the dead-man timer stops it


def test_two_tabs_do_not_compete_for_a_robot(
    context: BrowserContext, page: Page, robot: PtyRobot
) -> None:
    other_page = context.new_page()
    enter(other_page, page.url)
    other_page.click("#side_real")
    other_page.locator("#link_port option").first.wait_for(state="attached")
    other_page.click("#link_connect")
    wait_for_message(other_page, "Another tab of this browser is driving this robot.")
    other_page.close()
    assert page.locator("html[data-robot=connected]").count() == 1


def test_a_page_that_is_closed_stops_its_robot(
    context: BrowserContext, page: Page, robot: PtyRobot
) -> None:
    start_drive(page, robot)
    address = page.url
    page.goto("about:blank")
    robot.until(lambda: not robot.moves, "it stands")
    enter(page, address)


def test_a_reload_reconnects_to_the_previous_port(page: Page) -> None:
    page.click("#link_leave")
    wait_for_message(page, "Disconnected.")
    page.click("#link_connect")
    wait_for_message(page, "Connected: ")


def test_a_pulled_cable_is_shown(page: Page, robot: PtyRobot) -> None:
    robot.pull()
    wait_for_message(page, "The cable is unplugged. The")
