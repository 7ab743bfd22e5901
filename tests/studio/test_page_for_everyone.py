"""The page without a server, a mouse, a large screen or good eyes, and within its policy."""

from __future__ import annotations

import json
import socket
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import pytest

from tests.studio import screens
from tests.support import studio
from tests.support.needs import need
from tests.support.page_screens import LOOK_SCRIPT, SCREENS
from tests.support.sampling import sample_of
from tests.support.studio import Pages, axe, enter, image, speak, wait_until_checked, write
from tiniscript import check, compile
from tiniscript.base.languages import SOURCE_LANGUAGE, languages
from tiniscript.studio import serving

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page, Playwright

# 1366x768 and 1280x1024 at 200 and 400 %, and a low window.
LOW_SIZES = ((683, 384), (640, 512), (320, 256), (1024, 500))
# The minimum width and height of an element.
MIN_SIZES = {"wrong": ("#editor", 0, 96), "blocks": ("#blocks", 300, 96), "drawing": ("#arena", 120, 120),
               "plot": ("#plot_place", 300, 60), "trace": ("#trace_place", 300, 60)}  # fmt: skip
# The same where the page is scrolled: it is at most too long, and STOP lies over it.
SCROLLED_LOOK_SCRIPT = LOOK_SCRIPT.replace(
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
# The same in the window of programs.
DIALOG_SCRIPT = """() => {
  const found = [];
  const boxes = [...document.querySelectorAll('#programs button, #programs h2, #programs summary, #programs textarea, #programs canvas')]
    .filter((e) => e.checkVisibility()).map((e) => [e.id || e.textContent, e.getBoundingClientRect(), e]);
  const own = document.querySelector('#programs').getBoundingClientRect();
  for (const [name, box, e] of boxes) {
    if (box.left < own.left || box.right > own.right) found.push(name + ' is cut off');
    if (e.tagName === 'BUTTON' && (box.height < 44 || box.width < 44)) found.push(name + ' is too small');
    if (e.tagName === 'BUTTON' && e.scrollWidth > e.clientWidth + 1) found.push(name + ' does not fit');
  }
  const header = document.querySelectorAll('#programs header *');
  for (const [k, one] of boxes.entries()) for (const other of boxes.slice(k + 1)) {
    const a = one[1], b = other[1];
    if ([...header].includes(one[2]) !== [...header].includes(other[2])) continue;  // it stays on top
    if (Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1
        && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1) found.push(one[0] + ' is over ' + other[0]);
  }
  const stop = document.querySelector('#programs_stop').getBoundingClientRect();
  if (stop.top < 0 || stop.bottom > innerHeight) found.push('no stop in reach');
  return found;
}"""
# Each choice whose name is cut in its list.
CUT_CHOICES_SCRIPT = """() => [...document.querySelectorAll('select')].filter((e) => e.checkVisibility()).flatMap((e) => {
  const chosen = e.value;
  const cut = [...e.options].filter((each) => {
    e.value = each.value;
    return e.scrollWidth > e.clientWidth + 1 || e.scrollHeight > e.clientHeight + 1;
  });
  e.value = chosen;
  return cut.map((each) => each.innerText);
})"""
THEMES = {"dark": "[data-dark]", "light": ":not([data-dark])"}


@pytest.mark.sampled("language", "theme")
@pytest.mark.parametrize("language", ["en", "es"])
@pytest.mark.parametrize("theme", ["light", "dark"])
def test_each_screen_is_fully_visible_and_axe_finds_nothing(
    page: Page, theme: Literal["light", "dark"], language: str, pytestconfig: pytest.Config
) -> None:
    """At two sizes, others in each commit; the class is in `test_page_class.py`."""
    usual_sizes = {screen: sample_of(pytestconfig, screen, SCREENS) for screen in screens.SCREENS}
    low_sizes = {screen: sample_of(pytestconfig, screen, LOW_SIZES) for screen in screens.SCREENS}
    axed = {screen: sample_of(pytestconfig, screen, usual_sizes[screen]) for screen in usual_sizes}
    page.emulate_media(color_scheme=theme)
    speak(page, language)
    page.click("#home")
    for screen, size in screens.each_screen(
        page, lambda name: (*usual_sizes[name], *low_sizes[name])
    ):
        assert page.locator("#stop").is_visible()
        if screen not in ("teacher", "programs"):  # one screen scrolls, the other covers everything
            for end in (0,) if size in SCREENS else (0, 10_000):
                look_script = LOOK_SCRIPT if size in SCREENS else SCROLLED_LOOK_SCRIPT
                problems = page.evaluate(
                    f"(end) => {{ scrollTo(0, end); return ({look_script})(); }}", end
                )
                assert problems == [], (screen, size, end)
        if size in SCREENS:
            assert page.evaluate(CUT_CHOICES_SCRIPT) == [], (screen, size)
        if size in SCREENS and screen in MIN_SIZES:
            selector, width, height = MIN_SIZES[screen]
            box = page.locator(selector).bounding_box()
            assert box is not None and box["width"] >= width and box["height"] >= height, screen
        if screen == "drawing":
            assert page.evaluate("arena.clientHeight") >= 60, size
        if screen == "programs":
            assert page.evaluate(DIALOG_SCRIPT) == [], size
            page.locator("#share").evaluate("e => { e.open = true; }")
            for share_kind in ("link", "line"):
                page.click(f"#share_{share_kind}")
                page.locator("#programs:not([data-shared=asked])").wait_for()
                assert page.evaluate(DIALOG_SCRIPT) == [], (share_kind, size)
        if size in axed[screen]:
            assert axe(page) == [], (screen, size)
    page.emulate_media(color_scheme="null")
    page.set_viewport_size({"width": 1366, "height": 768})
    page.click("#start_write")


@pytest.mark.sampled("language")
@pytest.mark.parametrize("language", ["en", "es", "pt"])
def test_the_bar_above_the_program_stays_in_one_row_for_any_robot_name(
    page: Page, language: str
) -> None:
    speak(page, language)
    for width in (1000, 1024, 1366):
        page.set_viewport_size({"width": width, "height": 600})
        for robot in page.locator("#robot option").evaluate_all("all => all.map((e) => e.value)"):
            page.select_option("#robot", robot)
            assert page.evaluate("document.querySelector('header').clientHeight") < 60, robot
        assert page.evaluate(CUT_CHOICES_SCRIPT) == []
    speak(page, "en")


def test_the_dark_theme_follows_the_system_or_the_users_choice(page: Page) -> None:
    """The contrast is as good; a person's choice takes precedence, and is kept."""

    def wait_for_theme(theme: str) -> None:
        page.locator(f"html{THEMES[theme]}").wait_for(state="attached")

    page.set_viewport_size({"width": 1366, "height": 768})
    page.emulate_media(color_scheme="dark")
    wait_for_theme("dark")
    write(page, "F(-2, 80)\nF(1, 20)")
    page.click("#home")
    page.click("#theme")
    wait_for_theme("light")
    page.emulate_media(color_scheme="light")
    page.click("#theme")
    wait_for_theme("dark")
    assert page.get_attribute("#theme", "aria-pressed") == "true"
    page.evaluate("localStorage.setItem('tiniscript.theme', '<b>')")
    page.evaluate("dispatchEvent(new Event('storage'))")  # like an event from another tab
    wait_for_theme("light")
    page.evaluate("localStorage.removeItem('tiniscript.theme')")
    page.emulate_media(color_scheme="null")
    page.click("#start_write")


def test_the_keyboard_alone_is_enough(page: Page) -> None:
    """It reaches everything from the robot's choice to the button of a repair, and leaves the
    editor."""
    page.set_viewport_size({"width": 1366, "height": 768})
    write(page, "F(-2, 80)")
    page.locator("#messages .repair").wait_for()
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
        "robot", "language", "bar_new", "open", "save", "my_programs", "stop", "view_blocks", "view_text",
        "words", "undo", "redo", "editor", "place", "repair",
    ]  # fmt: skip
    page.keyboard.press("Enter")
    wait_until_checked(page)
    assert image(page) == compile("B(2, 80)").image


def test_a_screen_reader_gets_all_messages(page: Page) -> None:
    write(page, "F(-2, 80)")
    assert page.get_by_role("status").first.inner_text() == "1 mistake"
    sentence = "Line 1: -2 is out of range: here F takes 0 or more. Try: B(2, 80)"
    assert page.get_by_role("status").get_by_text(sentence).count() == 1
    assert page.get_by_role("button", name=sentence).inner_text() == "Line 1"
    assert page.get_by_role("textbox", name="Program").count() == 1
    assert page.get_by_role("combobox", name="Robot").count() == 1
    page.get_by_role("button", name="Apply the fix: line 1, B(2, 80)").wait_for()
    write(page, "SI|IF(DISTANCE < 10)\nS")  # no full stop follows a word of a program
    for place in ("#messages li", "#first_message"):
        assert " has no ENDIF – Try: " in page.inner_text(place)


TRY_REQUEST_SCRIPT = """async (address) => {
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


def test_the_content_security_policy_holds(page: Page, only_page: tuple[Pages, Page]) -> None:
    """The page does not reach another address, and no text becomes code."""
    errors = only_page[0].errors
    with socket.create_server(("127.0.0.1", 0)) as other_server:
        address = f"http://127.0.0.1:{other_server.getsockname()[1]}/"
        tried: dict[str, Any] = page.evaluate(TRY_REQUEST_SCRIPT, address)
        assert [name for name, outcome in tried.items() if outcome != "refused"] == []
        other_server.setblocking(False)
        with pytest.raises(BlockingIOError):
            other_server.accept()
    assert sum("Content Security Policy" in error for error in errors) >= 5
    errors.clear()


# Waits until files of a language are kept.
WAIT_FOR_FILES_SCRIPT = """async (names) => {
  const isKept = async (name) => Boolean(await caches.match(name));
  while (!(await Promise.all(names.map(isKept))).every(Boolean)) await new Promise((resolve) => setTimeout(resolve, 20));
}"""


def test_the_page_works_offline(playwright: Playwright, tmp_path: Path) -> None:
    """After one visit, the server is shut down, and the browser was closed in between."""

    def visit(address: str, text: str) -> bytes:
        context = playwright.chromium.launch_persistent_context(
            str(tmp_path / "profile"), executable_path=studio.chromium(), args=list(studio.OPTIONS)
        )
        try:
            page = context.new_page()
            enter(page, address)
            page.click("#view_text")
            page.evaluate("navigator.serviceWorker.ready.then(() => 1)")
            image_before = image(page)
            speak(page, "es")
            page.evaluate(WAIT_FOR_FILES_SCRIPT, ["./texts.es.json", "./messages.es.json"])
            write(page, "F(-2, 80)")
            assert check("F(-2, 80)", language="es")[0].message in page.inner_text("#messages li")
            write(page, text)
            return image_before
        finally:
            context.close()

    with studio.serve_page() as server:
        address = server.address
        visit(address, "SI|F(7, 70)")
    assert visit(address, "SI|S") == compile("SI|F(7, 70)").image


@pytest.mark.sampled(of="pages of their own", keep=2)
def test_an_update_does_not_disturb_an_open_page(browser: Browser) -> None:
    """A newer build waits until no tab has the old one, and is there then."""
    need(studio.missing())
    page = serving.files()
    context = browser.new_context()
    with studio.serve_page(page) as server:
        tab = context.new_page()
        enter(tab, server.address)
        tab.evaluate("navigator.serviceWorker.ready.then(() => 1)")
        tab.click("#view_text")
        for name, old_text, new_text in (
            ("index.html", b"<html ", b'<html data-build="2" '),
            ("service_worker.js", b'VERSION = "', b'VERSION = "newer'),
        ):
            data = page[name].data.replace(old_text, new_text, 1)
            assert data != page[name].data
            page[name] = page[name]._replace(data=data, etag=f'"{new_text.hex()}"')
        tab.evaluate(UPDATE_SCRIPT)
        write(tab, "SI|F(3, 30)")  # the old one continues
        tab.reload()
        wait_until_checked(tab)
        assert tab.locator("html[data-build]").count() == 0
        assert image(tab) == compile("SI|F(3, 30)").image
        for _ in range(10):  # a busy browser ends a closed tab late
            tab.close()
            tab = context.new_page()
            enter(tab, server.address)
            if count := tab.locator("html[data-build]").count():
                break
        assert count == 1
        assert image(tab) == compile("SI|F(3, 30)").image  # the work is kept
    context.close()


# Looks for a newer build, and waits until it is whole and waits.
UPDATE_SCRIPT = """async () => {
  const found = await navigator.serviceWorker.getRegistration();
  await found.update();
  while (!found.waiting) await new Promise((resolve) => setTimeout(resolve, 20));
}"""


def test_the_service_worker_has_every_file() -> None:
    need(studio.missing())
    source = serving.files()["service_worker.js"].data.decode()
    listed_files = json.loads(source.partition("FILES = ")[2].partition(";")[0])
    names = set(serving.files()) - {
        "index.html",
        "service_worker.js",
        "licences.txt",
        serving.FIRMWARE_FILE,
    }
    codes = json.loads(source.partition("LANGUAGES = ")[2].partition(";")[0])
    assert set(codes) == set(languages())
    later_files = {name for code in codes if code != SOURCE_LANGUAGE for name in codes[code]}
    assert set(listed_files) == {"./", *names} - later_files and later_files < names
