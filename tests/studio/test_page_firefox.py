"""The page in the system's Firefox: all but a real robot, which that browser does not reach."""

from __future__ import annotations

import base64
from collections.abc import Iterator
from typing import TYPE_CHECKING

import pytest

from tests.support import studio
from tests.support.needs import need
from tests.support.page_programs import MOVE_COLOUR, colours, content, list_programs, share
from tests.support.studio import (
    Pages,
    dance_like_the_command,
    enter,
    image,
    speak,
    wait_for_blocks,
    wait_until_checked,
    write,
)
from tiniscript import compile
from tiniscript.virtual.worlds import read

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page, Playwright

pytestmark = pytest.mark.long

PROGRAM = "SI|LOOP(2);\n  F(0.2, 80);\nEND_LOOP;\nSHOW(5)"


@pytest.fixture(scope="module")
def firefox(playwright: Playwright) -> Iterator[Browser]:
    need(studio.missing_firefox())
    browser = playwright.firefox.launch(channel="moz-firefox", executable_path=studio.firefox())
    yield browser
    browser.close()


# Playwright does not see downloads in this Firefox, so the data passed to the browser is kept.
KEEP_DOWNLOAD_SCRIPT = """() => { const make = URL.createObjectURL.bind(URL);
  URL.createObjectURL = (blob) => { window.made = blob; return make(blob); }; }"""
READ_DOWNLOAD_SCRIPT = """async () => {
  const bytes = new Uint8Array(await window.made.arrayBuffer());
  return btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join('')); }"""


def read_saved_file(page: Page) -> bytes:
    """Return the newest file that the page has saved."""
    return base64.b64decode(page.evaluate(READ_DOWNLOAD_SCRIPT))


@pytest.fixture(scope="module")
def firefox_page(firefox: Browser, address: str) -> Iterator[tuple[Pages, Page]]:
    pages = Pages(firefox, address)
    page = pages.open("blocks", is_alone=True)
    page.evaluate(KEEP_DOWNLOAD_SCRIPT)
    yield pages, page
    pages.close()


@pytest.fixture
def page(firefox_page: tuple[Pages, Page]) -> Iterator[Page]:
    pages, current_page = firefox_page
    studio.begin_anew(current_page)
    yield current_page
    errors, pages.errors[:] = pages.errors[:], []
    assert not errors


def test_blocks_and_text_are_the_same_program(page: Page) -> None:
    write(page, PROGRAM)
    assert image(page) == compile(PROGRAM).image
    page.click("#view_blocks")
    wait_for_blocks(page)
    assert page.locator("#blocks .blocklyBlock").count() >= 4
    page.click("#undo")
    wait_for_blocks(page)
    assert image(page) == compile("").image
    page.click("#redo")
    wait_for_blocks(page)
    assert image(page) == compile(PROGRAM).image


def test_a_mistake_is_reported_in_spanish_and_repaired(page: Page) -> None:
    speak(page, "es")
    write(page, "F(-2, 80)")
    assert page.inner_text("#status") == "1 error"
    page.get_by_role("button", name="Hacerlo: línea 1, B(2, 80)").click()
    wait_until_checked(page)
    assert image(page) == compile("B(2, 80)").image


def test_a_run_matches_the_command(page: Page) -> None:
    dance_like_the_command(page)


def test_a_world_is_changed_and_saved(page: Page) -> None:
    page.click("#world_draw")
    page.locator("#world_add_boxes").focus()
    page.keyboard.press("Enter")
    page.locator("#arena").focus()
    page.keyboard.press("ArrowRight")
    page.click("#world_save")
    page.locator("#doing").filter(has_text="Saved: world.toml").wait_for()
    world = read(read_saved_file(page).decode(), "world")
    assert max(x for x, _ in world.boxes[-1]) == 125
    page.click("#world_done")


def test_programs_are_shared_kept_and_saved_as_pictures(page: Page) -> None:
    write(page, PROGRAM)
    link = share(page)
    assert "#program=" in link and PROGRAM.split("\n")[0] in " ".join(list_programs(page))
    page.click("#share_picture")
    page.locator("#shared_told").filter(has_text="Saved: program.png").wait_for()
    width, height, counts = colours(page, read_saved_file(page))
    assert width > 200 and height > 200 and counts[MOVE_COLOUR] > 1000
    page.keyboard.press("Escape")
    page.goto(link)
    page.locator("#note").filter(has_text="This program came from a link.").wait_for()
    assert content(page).rstrip() == PROGRAM


def test_the_page_works_offline(firefox: Browser) -> None:
    context = firefox.new_context()
    page = context.new_page()
    with studio.serve_page() as server:
        enter(page, server.address)
        page.evaluate("navigator.serviceWorker.ready.then(() => 1)")
        address = server.address
    enter(page, address)
    page.click("#view_text")
    write(page, PROGRAM)
    assert image(page) == compile(PROGRAM).image
    context.close()
