"""The page without a server, a mouse, a large screen or good eyes, and within its policy."""

from __future__ import annotations

import json
import socket
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import pytest

from tests.support import studio
from tests.support.needs import need
from tests.support.studio import Pages, axe, checked, enter, image, shown, speak, turn, write
from tiniscript import check, compile
from tiniscript.base.languages import SOURCE, languages
from tiniscript.studio import serving

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page, Playwright

SCREENS = ((1366, 768), (1024, 600), (390, 844), (844, 390))
WRONG = "SI|" + "F(-2, 80);\nIF(DISTANCE < 10;\n" * 6
# What can be pressed or chosen, and whether another such thing or the edge of the screen cuts it.
LOOK = """() => {
  const found = [];
  const boxes = [...document.querySelectorAll('header button, header select, h1, main section > :not(div), #sides > *, #views_of_run > *, #controls > *, #editor, #link_ways > *, #link_drive > *, #lesson_controls > *, #lesson_said, #lesson_page, #arena, #world_tools > :not(span), #world_numbers > *')]
    .filter((e) => e.checkVisibility() && (e.textContent || e.value || e.id === 'arena' || e.querySelector('svg')))
    .map((e) => [e.id || e.tagName, e.getBoundingClientRect()]);
  for (const [name, box] of boxes) {
    if (box.left < -0.5 || box.top < -0.5 || box.right > innerWidth + 0.5 || box.bottom > innerHeight + 0.5)
      found.push(name + ' is cut off');
    if (box.width < 1 || box.height < 1) found.push(name + ' cannot be seen');
  }
  for (const [a, one] of boxes) for (const [b, other] of boxes) {
    if (a < b && Math.min(one.right, other.right) - Math.max(one.left, other.left) > 1
        && Math.min(one.bottom, other.bottom) - Math.max(one.top, other.top) > 1)
      found.push(a + ' is over ' + b);
  }
  for (const e of document.querySelectorAll('button, select')) {
    if (!e.checkVisibility()) continue;
    const box = e.getBoundingClientRect();
    if (box.height < 44 || box.width < 44) found.push((e.id || e.textContent) + ' is too small for a finger');
    if (e.scrollWidth > e.clientWidth + 1 && e.tagName === 'BUTTON') found.push(e.textContent + ' does not fit');
  }
  if (document.documentElement.scrollWidth > innerWidth) found.push('the page is too wide');
  return found;
}"""
THEMES = {"dark": "[data-dark]", "light": ":not([data-dark])"}


@pytest.mark.sampled("language", "screen", keep=2)
@pytest.mark.parametrize("language", ["en", "es"])
@pytest.mark.parametrize("screen", SCREENS, ids=lambda screen: "x".join(map(str, screen)))
def test_everything_is_seen(page: Page, screen: tuple[int, int], language: str) -> None:
    page.set_viewport_size({"width": screen[0], "height": screen[1]})
    speak(page, language)
    for text in ("SI|F(2, 80)", WRONG):
        write(page, text)
        assert page.evaluate(LOOK) == []
        turn(page, "robot")
        for side in ("lessons", "virtual"):
            page.click(f"#side_{side}")
            page.locator("#lesson_check:enabled").wait_for(state="attached")
            assert page.evaluate(LOOK) == [], side
        turn(page, "program")
    page.locator("#messages li").last.scroll_into_view_if_needed()
    assert page.locator("#editor").bounding_box()["height"] >= 96  # type: ignore[index]


@pytest.mark.sampled("theme")
@pytest.mark.parametrize("theme", ["light", "dark"])
def test_axe_finds_nothing_in_any_state(page: Page, theme: Literal["light", "dark"]) -> None:
    """From the start to a world that is drawn; the class has its own (`test_page_class.py`)."""

    def seen(state: str) -> None:
        assert axe(page) == [], state

    def in_phase(phase: str) -> None:
        page.locator(f"html[data-phase={phase}]").wait_for(state="attached")

    def text(program: str) -> None:
        page.click("#view_text")
        write(page, program)

    page.set_viewport_size({"width": 1366, "height": 768})
    page.emulate_media(color_scheme=theme)
    page.click("#home")
    seen("start")
    page.click("#start_write")
    page.click("#view_blocks")
    shown(page)
    page.locator(".blocklyToolboxCategory").first.click()
    seen("blocks, and what can be added")
    page.click("#words")
    seen("blocks with words")
    page.click("#words")
    text(WRONG)
    seen("wrong text")
    page.click("#view_blocks")
    seen("blocks that wait")
    text("F(3, 80);SHOW(1 / 0)")
    page.select_option("#world", "maze")
    page.select_option("#speed", "0.1")
    page.click("#run")
    in_phase("running")
    seen("running")
    page.click("#pause")
    in_phase("paused")
    seen("paused")
    page.select_option("#speed", "20")
    page.click("#pause")
    in_phase("ended")
    seen("a fault, and a score")
    for view in ("plot", "trace", "arena"):
        page.click(f"#seen_{view}")
        seen(view)
    for part in (0, 1, 2, -1):
        if part == 0:
            page.click("#world_draw")
        count = page.locator("#world_part option").count()
        page.select_option("#world_part", index=part % count)
        seen(f"part {part} of a world that is drawn")
    page.click("#world_done")
    page.select_option("#world", "obstacles")
    page.click("#side_lessons")
    page.locator("#lesson_check:enabled").wait_for(state="attached")
    seen("a lesson")
    page.locator("#lesson_steps button").last.click()
    page.click("#lesson_hint summary")
    page.click("#lesson_check")
    page.locator("#lesson_said[data-verdict]").wait_for()
    seen("a lesson that is checked")
    page.click("#lesson_hint summary")
    page.click("#side_real")
    page.click("#link_teacher summary")
    seen("a real robot, and the teacher's part")
    page.click("#link_teacher summary")
    page.click("#side_virtual")
    page.click("#my_programs")
    seen("programs")
    page.click("#programs_close")
    page.emulate_media(color_scheme="null")


@pytest.mark.sampled("theme", "size")
@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("size", SCREENS[2:], ids=["upright", "lying"])
def test_axe_finds_nothing_on_a_phone(
    page: Page, size: tuple[int, int], theme: Literal["light", "dark"]
) -> None:
    page.emulate_media(color_scheme=theme)
    page.set_viewport_size({"width": size[0], "height": size[1]})
    for state in _screens(page):
        page.evaluate(studio.SETTLED)
        assert axe(page) == [], state
    page.click("#programs_close")
    page.click("#link_teacher summary")
    page.click("#side_virtual")
    page.emulate_media(color_scheme="null")
    page.set_viewport_size({"width": 1366, "height": 768})


def _screens(page: Page) -> Iterator[str]:
    """Go from screen to screen of a phone; yield what is seen."""
    page.click("#home")
    yield "start"
    page.click("#start_write")
    page.click("#view_blocks")
    shown(page)
    yield "blocks"
    page.click("#view_text")
    write(page, WRONG)
    yield "wrong text"
    page.click("#sheet")
    yield "messages that are put away"
    write(page, "SI|F(1, 80)")
    turn(page, "robot")
    yield "robot"
    page.click("#world_draw")
    page.select_option("#world_part", index=1)
    yield "a world that is drawn"
    page.click("#world_done")
    page.click("#side_lessons")
    page.locator("#lesson_check:enabled").wait_for(state="attached")
    yield "a lesson"
    page.click("#side_real")
    page.click("#link_teacher summary")
    yield "a real robot, and the teacher's part"
    page.click("#my_programs")
    yield "programs"


def test_it_is_dark_where_the_system_is_or_somebody_wants_it(page: Page) -> None:
    """With no less contrast; what somebody has chosen counts more, and is kept."""

    def become(theme: str) -> None:
        page.locator(f"html{THEMES[theme]}").wait_for(state="attached")

    page.set_viewport_size({"width": 1366, "height": 768})
    page.emulate_media(color_scheme="dark")
    become("dark")
    write(page, "F(-2, 80)\nF(1, 20)")
    page.click("#home")
    page.click("#theme")
    become("light")
    page.emulate_media(color_scheme="light")
    page.click("#theme")
    become("dark")
    assert page.get_attribute("#theme", "aria-pressed") == "true"
    page.evaluate("localStorage.setItem('tiniscript.theme', '<b>')")
    page.evaluate("dispatchEvent(new Event('storage'))")  # as another tab would
    become("light")
    page.evaluate("localStorage.removeItem('tiniscript.theme')")
    page.emulate_media(color_scheme="null")
    page.click("#start_write")


def test_the_keyboard_alone_is_enough(page: Page) -> None:
    """From the robot's choice to the button of a repair, and out of the editor."""
    page.set_viewport_size({"width": 1366, "height": 768})
    write(page, "F(-2, 80)")
    page.locator("#robot").focus()
    visited = []
    for _ in range(16):
        visited.append(
            page.evaluate("document.activeElement.id || document.activeElement.className")
        )
        if visited[-1] == "repair":
            break
        page.keyboard.press("Tab")
    assert visited == [
        "robot", "language", "open", "save", "my_programs", "stop", "view_blocks", "view_text",
        "words", "undo", "redo", "editor", "place", "repair",
    ]  # fmt: skip
    page.keyboard.press("Enter")
    checked(page)
    assert image(page) == compile("B(2, 80)").image


def test_a_screen_reader_hears_what_is_said(page: Page) -> None:
    write(page, "F(-2, 80)")
    assert page.get_by_role("status").first.inner_text() == "1 mistake"
    said = "Line 1: -2 does not fit: here F takes 0 or more. Try: B(2, 80)"
    assert page.get_by_role("status").get_by_text(said).count() == 1
    assert page.get_by_role("button", name=said).inner_text() == "Line 1"
    assert page.get_by_role("textbox", name="Program").count() == 1
    assert page.get_by_role("combobox", name="Robot").count() == 1
    assert page.get_by_role("button", name="Do it: line 1, B(2, 80)").count() == 1
    write(page, "SI|IF(DISTANCE < 10)\nS")  # no full stop stands behind a word of a program
    for place in ("#messages li", "#first_message"):
        assert " has no ENDIF – Try: " in page.inner_text(place)


TRY = """async (address) => {
  await new Promise((resolve) => setTimeout(resolve));  // what a test asks may evaluate at first
  const found = {};
  const attempt = async (name, act) => { try { await act(); found[name] = 'done'; } catch { found[name] = 'refused'; } };
  await attempt('fetch', () => fetch(address));
  await attempt('eval', () => eval('1'));
  await attempt('function', () => new Function('1')());
  const script = document.createElement('script');
  script.textContent = 'window.taken = 1';
  document.body.append(script);
  found.script = window.taken ? 'done' : 'refused';
  const image = new Image();
  const over = new Promise((resolve) => { image.onload = () => resolve('done'); image.onerror = () => resolve('refused'); });
  image.src = address + 'x.png';
  found.image = await over;
  return found;
}"""


def test_the_policy_holds(pages: Pages) -> None:
    """The page does not reach another address, and no text becomes code."""
    page = pages.open()
    with socket.create_server(("127.0.0.1", 0)) as other:
        address = f"http://127.0.0.1:{other.getsockname()[1]}/"
        tried: dict[str, Any] = page.evaluate(TRY, address)
        assert [name for name, how in tried.items() if how != "refused"] == []
        other.setblocking(False)
        with pytest.raises(BlockingIOError):
            other.accept()
    assert sum("Content Security Policy" in each for each in pages.wrong) >= 5
    pages.wrong.clear()


# Waits until files of a language are kept.
KEPT = """async (names) => {
  const isKept = async (name) => Boolean(await caches.match(name));
  while (!(await Promise.all(names.map(isKept))).every(Boolean)) await new Promise((resolve) => setTimeout(resolve, 20));
}"""


def test_it_works_without_its_server(playwright: Playwright, tmp_path: Path) -> None:
    """After one visit: the server is gone, and the browser was closed in between."""

    def visit(address: str, text: str) -> bytes:
        context = playwright.chromium.launch_persistent_context(
            str(tmp_path / "profile"), executable_path=studio.chromium(), args=list(studio.OPTIONS)
        )
        try:
            page = context.new_page()
            enter(page, address)
            page.click("#view_text")
            page.evaluate("navigator.serviceWorker.ready.then(() => 1)")
            before = image(page)
            speak(page, "es")
            page.evaluate(KEPT, ["./texts.es.json", "./messages.es.json"])
            write(page, "F(-2, 80)")
            assert check("F(-2, 80)", language="es")[0].message in page.inner_text("#messages li")
            write(page, text)
            return before
        finally:
            context.close()

    with studio.served() as server:
        address = server.address
        visit(address, "SI|F(7, 70)")
    assert visit(address, "SI|S") == compile("SI|F(7, 70)").image


def test_an_open_page_is_left_by_its_update(browser: Browser) -> None:
    """A newer build waits until no tab has the old one, and is there then."""
    need(studio.missing())
    page = serving.files()
    context = browser.new_context()
    with studio.served(page=page) as server:
        tab = context.new_page()
        enter(tab, server.address)
        tab.evaluate("navigator.serviceWorker.ready.then(() => 1)")
        tab.click("#view_text")
        for name, old, new in (
            ("index.html", b"<html ", b'<html data-build="2" '),
            ("service_worker.js", b'VERSION = "', b'VERSION = "newer'),
        ):
            data = page[name].data.replace(old, new, 1)
            assert data != page[name].data
            page[name] = page[name]._replace(data=data, tag=f'"{new.hex()}"')
        tab.evaluate(UPDATE)
        write(tab, "SI|F(3, 30)")  # the old one goes on
        tab.reload()
        checked(tab)
        assert tab.locator("html[data-build]").count() == 0
        assert image(tab) == compile("SI|F(3, 30)").image
        for _ in range(10):  # a busy browser ends a closed tab late
            tab.close()
            tab = context.new_page()
            enter(tab, server.address)
            if found := tab.locator("html[data-build]").count():
                break
        assert found == 1
        assert image(tab) == compile("SI|F(3, 30)").image  # and the work is kept
    context.close()


# Looks for a newer build, and waits until it is whole and waits.
UPDATE = """async () => {
  const found = await navigator.serviceWorker.getRegistration();
  await found.update();
  while (!found.waiting) await new Promise((resolve) => setTimeout(resolve, 20));
}"""


def test_the_service_worker_has_every_file() -> None:
    need(studio.missing())
    source = serving.files()["service_worker.js"].data.decode()
    listed = json.loads(source.partition("FILES = ")[2].partition(";")[0])
    names = set(serving.files()) - {
        "index.html",
        "service_worker.js",
        "licences.txt",
        serving.FIRMWARE,
    }
    said = json.loads(source.partition("LANGUAGES = ")[2].partition(";")[0])
    assert set(said) == set(languages())
    later = {name for code in said if code != SOURCE for name in said[code]}
    assert set(listed) == {"./", *names} - later and later < names
