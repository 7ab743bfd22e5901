"""The page on a phone that lies on its side, enlarged, and in a system's own few colors."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from tests.studio.test_page_for_everyone import LOOK
from tests.support.studio import axe, shown, speak, turn, write

if TYPE_CHECKING:
    from playwright.sync_api import Page

# A phone on its side; 1366x768 and 1280x1024 at 200 and 400 %.
LOW = ((844, 390), (683, 384), (640, 512), (320, 256))
# The same where the page is scrolled: it is at most too long, and STOP lies over it.
SCROLLED = LOOK.replace(
    ".map((e) => [e.id || e.tagName, e.getBoundingClientRect()])",
    ".filter((e) => e.id !== 'stop').map((e) => [e.id || e.tagName, e.getBoundingClientRect()])"
    ".map(([id, box]) => [id, new DOMRect(box.x, box.y + scrollY, box.width, box.height)])",
).replace(
    "box.bottom > innerHeight", "box.bottom > document.documentElement.scrollHeight"
).replace(
    "return found;",
    "const stop = document.querySelector('#stop').getBoundingClientRect();"
    "const top = document.elementFromPoint(stop.x + stop.width / 2, stop.y + stop.height / 2);"
    "if (top?.id !== 'stop') found.push('no STOP in reach');"
    "return found;",
)  # fmt: skip


@pytest.fixture(autouse=True)
def large_again(page: Page) -> object:
    yield
    page.keyboard.press("Escape")
    page.emulate_media(forced_colors="none")
    page.set_viewport_size({"width": 1366, "height": 768})
    page.click("#side_virtual")
    page.click("#view_text")


@pytest.mark.sampled("language")
@pytest.mark.parametrize("language", ["en", "es"])
def test_everything_is_reached_on_a_low_screen(page: Page, language: str) -> None:
    speak(page, language)
    write(page, "SI|LOOP(FOREVER); F(1, 80); END_LOOP")
    for width, height in LOW if language == "es" else LOW[:1]:
        page.set_viewport_size({"width": width, "height": height})
        for view, end in (("blocks", 0), ("text", 10_000)):
            turn(page, "program")
            page.evaluate("(end) => scrollTo(0, end)", end)
            page.click(f"#view_{view}")
            assert page.evaluate(SCROLLED) == [], (width, height, view)
            turn(page, "robot")
            for side in ("real", "lessons", "virtual"):
                page.click(f"#side_{side}")
                assert page.evaluate(SCROLLED) == [], (width, height, view, side)
        page.click("#world_draw")
        assert page.evaluate(SCROLLED) == [], (width, height, "drawing")
        assert page.evaluate("document.querySelector('#arena').clientHeight") >= 60
        page.click("#world_done")
    assert axe(page) == []


def test_a_phone_is_turned_while_a_program_runs(page: Page) -> None:
    write(page, "SI|LOOP(FOREVER); F(1, 80); END_LOOP")
    page.set_viewport_size({"width": 390, "height": 844})
    page.click("#run")
    page.locator("html[data-phase=running]").wait_for(state="attached")
    for width, height in ((844, 390), (390, 844), (844, 390)):
        page.set_viewport_size({"width": width, "height": height})
        ratio = page.evaluate(
            "() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame("
            "() => { const a = document.querySelector('#arena');"
            " resolve(a.width / a.clientWidth / (a.height / a.clientHeight)); })))"
        )
        assert ratio == pytest.approx(1, abs=0.02)  # what is drawn is not stretched
        assert page.evaluate("document.documentElement.dataset.phase") == "running"
    page.evaluate("scrollTo(0, document.documentElement.scrollHeight)")
    page.click("#stop")
    page.locator("html[data-phase=ended]").wait_for(state="attached")


def test_what_is_chosen_and_runs_is_seen_without_backgrounds(page: Page) -> None:
    write(page, "SI|LOOP(FOREVER); F(1, 80); END_LOOP")
    page.emulate_media(forced_colors="active")
    width = "(e) => parseFloat(getComputedStyle(e).outlineWidth)"
    style = "(e) => getComputedStyle(e).outlineStyle"
    for name, is_chosen in (("#view_text", True), ("#view_blocks", False), ("#side_virtual", True)):
        assert (page.locator(name).evaluate(style) == "solid") == is_chosen, name
        assert not is_chosen or page.locator(name).evaluate(width) >= 3
    page.click("#run")
    assert page.locator(".cm-running").first.evaluate(style) == "solid"
    page.click("#view_blocks")
    shown(page)
    page.locator("#blocks .running").wait_for()
    assert axe(page) == []
