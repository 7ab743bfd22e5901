"""The page and its robot: the connection, and its messages."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

import pytest

from tests.support.pty_robot import PtyRobot
from tests.support.studio import UPLOADS, Pages, speak
from tiniscript import robots
from tiniscript.link import known_ports
from tiniscript.studio import serving
from tiniscript.studio.recordings import decode

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page


KIT = robots.load("tinibot").kit
PATIENCE_MS = 90_000


@pytest.fixture
def pages(hosted_pages: Pages) -> Pages:
    return hosted_pages


@pytest.fixture(scope="module")
def first_robot() -> Iterator[PtyRobot]:
    with PtyRobot(KIT) as pty_robot:
        yield pty_robot


@pytest.fixture
def robot(first_robot: PtyRobot) -> PtyRobot:
    """A robot that many tests share: each has it as new."""
    first_robot.begin_anew()
    known_ports.remember(first_robot.port, "TINI")  # makes the robot listed, and listed first
    return first_robot


@pytest.fixture(scope="module")
def first(browser: Browser, server: serving.Server) -> Iterator[tuple[Pages, Page]]:
    opened_pages = Pages(browser, server.address, entrance=server.entrance)
    yield opened_pages, opened_pages.open()
    opened_pages.close()


def wait_for_message(page: Page, text: str | re.Pattern[str]) -> None:
    from playwright.sync_api import expect

    expect(page.locator("#link_said")).to_contain_text(text, ignore_case=True, timeout=PATIENCE_MS)


def connect(page: Page, robot: PtyRobot) -> None:
    page.click("#side_real")
    page.click("#link_look")  # the list from before the robot was known has other ports first
    page.locator("#link_port option:first-of-type", has_text=robot.port).wait_for(state="attached")
    # A closed page may not have reported that, but counts as gone after a while.
    for _ in range(10):
        page.click("#link_connect")
        wait_for_message(page, re.compile("Connected: |Another tab"))
        if "Connected" in page.locator("#link_said").inner_text():
            return
        page.wait_for_timeout(500)
    wait_for_message(page, "Connected: ")


@pytest.fixture
def page(first: tuple[Pages, Page], robot: PtyRobot) -> Iterator[Page]:
    """A page that has met its robot; many tests share it, and each connects."""
    pages, current_page = first
    current_page.set_viewport_size({"width": 1366, "height": 768})
    speak(current_page, "en")
    current_page.evaluate(
        "for (const each of document.querySelectorAll('details')) each.open = false"
    )
    connect(current_page, robot)
    yield current_page
    current_page.click("#side_real")
    current_page.locator("#link_leave").dispatch_event(
        "click"
    )  # seen or not: it may just have left
    current_page.locator("html:not([data-robot=connected])").wait_for(state="attached")
    errors, pages.errors[:] = pages.errors[:], []
    assert not errors


def upload_until_it_runs(page: Page) -> None:
    """Send it, again where a busy computer kept the page silent until its robot was stopped.

    A short run may be over at once: the page then reports that instead of the upload.
    """
    word = page.locator("#link_said")
    for _ in range(UPLOADS):
        page.click("#link_upload")
        word.filter(has_text=re.compile(r"The robot has the program|Done\.|Stopped: ")).wait_for()
        if "Stopped: " not in word.inner_text():
            return
    raise AssertionError(f"stopped {UPLOADS} times")


def events(page: Page) -> list[str]:
    """Return the events in the page's file of the last run."""
    page.click("#side_virtual")
    page.click("#runs_open")
    with page.expect_download() as download_info:
        page.locator("#runs_list li button", has_text="Save run").first.click()
    page.click("#runs_close")
    page.click("#side_real")
    return [row.event for row in decode(download_info.value.path().read_bytes()).rows]
