"""The start screen: one click to a robot that moves, earlier programs, and ways onward."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import pytest

from tests.support.page_programs import GOOD_WORK
from tests.support.studio import (
    SETTLED_SCRIPT,
    Pages,
    image,
    speak,
    wait_for,
    wait_for_blocks,
    wait_for_note,
    wait_for_phase,
    wait_until_checked,
    write,
)
from tiniscript import compile
from tiniscript.lessons import catalogue

if TYPE_CHECKING:
    from playwright.sync_api import Locator, Page, Route

sampled = pytest.mark.sampled(of="details of the start", keep=2)

PICTURES = ("dance", "square", "obstacle", "line", "light", "music", "drive")
START = "html[data-screen=start]"
NOTES_CONFETTI = """() => {
  window.thrown = 0;
  new MutationObserver((all) => {
    const added = all.flatMap(({ addedNodes }) => [...addedNodes]);
    window.thrown += added.filter((each) => each.className === 'confetti').length;
  }).observe(document.body, { childList: true });
}"""


SIZES = ((1366, 768), (1024, 600), (820, 1180), (390, 844))


@pytest.fixture
def start(page: Page) -> Iterator[Page]:
    """The screen of a page that was here before; no earlier program is kept."""
    page.set_viewport_size({"width": 1366, "height": 768})
    page.click("#view_blocks")
    page.click("#home")
    page.click("[data-begin=dance]")  # the page's own example is not kept
    wait_for_phase(page, "running")
    page.evaluate("localStorage.clear()")
    page.click("#home")
    page.locator(START).wait_for(state="attached")
    yield page
    if screen(page) == "start":
        page.click("#start_write")
    page.click("#view_text")


def screen(page: Page) -> str:
    return str(page.evaluate("document.documentElement.dataset.screen"))


def has_moved(page: Page) -> bool:
    """Return whether its robot has moved."""
    trace = page.locator("#trace").text_content() or ""
    return re.search("MOTORS .*[1-9]", trace) is not None


def test_one_click_moves_the_robot(start: Page) -> None:
    assert start.locator("[data-begin]").count() == len(PICTURES)
    for name in PICTURES:
        start.click(f"[data-begin={name}]")
        wait_for_phase(start, "running")
        if name == "drive":  # driven by hand
            start.keyboard.down("ArrowUp")
        wait_for(start, lambda: has_moved(start), "it moves")
        start.keyboard.up("ArrowUp")
        assert start.inner_text("#status").startswith("Ready to run"), name
        assert start.locator("#arena").is_visible()
        start.click("#home")
        wait_for_phase(start, "ended")
    assert start.locator("#start_programs li").count() == 0  # the page has brought all of them


@sampled
def test_late_files_do_not_disturb_a_run(pages: Pages) -> None:
    """The robot moves before the blocks are fetched, and continues when the lessons arrive."""
    page = pages.blank()
    fetched: list[str] = []
    page.on("request", lambda request: fetched.append(request.url))
    held_routes: list[Route] = []
    for name in ("tiniscript.zip", "lessons.zip"):
        page.route(f"**/{name}", lambda route: held_routes.append(route))
    page.goto(pages.address)
    page.click("[data-begin=dance]")
    page.locator("#doing", has_text="The compiler is still working").wait_for()
    wait_for(page, lambda: held_routes, "the compiler is asked for")
    assert not any("/blocks-" in url for url in fetched)
    held_routes.pop().continue_()
    wait_for_phase(page, "running")
    wait_for_blocks(page)
    assert any("/blocks-" in url for url in fetched)
    page.click("#home")
    page.click("#start_lessons")
    wait_for(page, lambda: held_routes, "the lessons are asked for")
    assert not page.locator("#lesson_hint").is_visible()
    page.click("#home")
    page.click("[data-begin=obstacle]")
    wait_for_phase(page, "running")
    held_routes.pop().continue_()
    page.locator("#lesson_page[data-lesson]").wait_for(state="attached")
    assert page.get_attribute("html", "data-phase") == "running"
    assert page.input_value("#world") == "obstacles"
    page.click("#side_lessons")
    page.locator("#world option:checked", has_text="Lesson 1").wait_for(state="attached")


def test_missing_files_are_reported_and_no_empty_page_is_shown(pages: Pages) -> None:
    """Before the texts arrive, the page shows nothing; a missing compiler is reported next to the
    robot."""
    page = pages.blank()
    held_routes: list[Route] = []
    page.route("**/texts.*.json", lambda route: held_routes.append(route))
    page.route("**/tiniscript.zip", lambda route: route.abort())
    page.goto(pages.address, wait_until="domcontentloaded")
    wait_for(page, lambda: held_routes, "the texts are asked for")
    locator = page.locator("header :is(button, select):visible")
    assert locator.all_inner_texts() == ["STOP"]
    held_routes[0].continue_()
    page.locator(START).wait_for(state="attached")
    assert locator.count() > 3
    page.click("[data-begin=dance]")
    page.locator("#doing", has_text="The compiler did not load. Press Run to try again").wait_for()
    page.click("#side_lessons")
    page.locator("#lesson_said", has_text="The compiler did not load. Press").wait_for()
    wait_for(page, lambda: pages.errors, "what the compiler lacks")
    pages.errors.clear()


@sampled
def test_the_address_selects_the_screen(start: Page) -> None:
    start.click("#start_write")
    assert (screen(start), start.evaluate("location.hash")) == ("program", "#editor")
    start.reload()
    start.locator("html[data-screen=program]").wait_for(state="attached")
    start.go_back()
    start.locator(START).wait_for(state="attached")
    start.go_forward()
    start.locator("html[data-screen=program]").wait_for(state="attached")
    assert start.locator("#home").is_visible()
    start.evaluate("document.documentElement.dataset.class = 'pupil'")
    assert not start.locator("#home").is_visible()  # a class has no start
    start.evaluate("delete document.documentElement.dataset.class")
    start.click("#home")
    assert screen(start) == "start"
    start.click("#start_lessons")
    assert start.locator("#lessons").is_visible()
    start.click("#home")
    start.click("#start_robot")
    assert start.locator("#link").is_visible()


@sampled
def test_a_link_opens_its_program_and_not_the_start(pages: Pages, start: Page) -> None:
    start.goto(f"{pages.address}#program={GOOD_WORK}")
    wait_for_note(start, "This program came from a link.")
    assert screen(start) == "program"
    wait_until_checked(start)
    assert image(start) == compile("SI|F(9, 90)").image
    other_page = pages.visit(f"{pages.address}#program={GOOD_WORK[:-8]}")
    wait_for_note(other_page, "The link is incomplete")
    assert screen(other_page) == "program"


NO_MARKS = """() => {
  const sheet = new CSSStyleSheet();
  const marks = '#pictures button::before, #pictures button::after';
  sheet.replaceSync(`${marks} { visibility: hidden !important; }`);
  document.adoptedStyleSheets = [...document.adoptedStyleSheets, sheet];
}"""


def words_of(name: Locator) -> Any:
    """Return the box of a name without the rounded border that its picture touches."""
    name.scroll_into_view_if_needed()
    box = name.evaluate("e => e.getBoundingClientRect().toJSON()")
    left, top, width, height = (box[side] for side in ("x", "y", "width", "height"))
    return {"x": left + 8, "y": top + 6, "width": width - 16, "height": height - 14}


@pytest.mark.long
def test_no_name_of_a_picture_is_covered(pages: Pages) -> None:
    """The mark for playing does not change its look."""
    page = pages.open("start", viewport={"width": 1366, "height": 768})
    names = page.locator("#pictures span")
    shots_by_size: dict[tuple[str, int, int], list[bytes]] = {}
    sizes = [(language, *size) for language in ("en", "es") for size in SIZES]
    for language, width, height in (*sizes, *sizes):
        if (language, width, height) == sizes[0] and shots_by_size:
            page.evaluate(NO_MARKS)
        page.set_viewport_size({"width": width, "height": height})
        speak(page, language)
        page.evaluate(SETTLED_SCRIPT)
        page.mouse.move(2, 2)
        shots = [page.screenshot(clip=words_of(name)) for name in names.all()]
        assert shots_by_size.setdefault((language, width, height), shots) == shots, (
            language,
            width,
        )


@sampled
def test_earlier_programs_are_listed_with_pictures(start: Page) -> None:
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
    wait_until_checked(start)
    assert screen(start) == "program"
    assert start.evaluate("document.documentElement.dataset.phase") != "running"
    assert image(start) == compile("SI|LOOP(2)\nF(1, 80)\nBEEP(0.1, 440)\nEND_LOOP").image


def test_an_unnamed_program_is_called_by_its_first_block(start: Page) -> None:
    start.click("#start_write")
    start.click("#view_text")
    for program in ("SI|F(2.5, 80)", "// a\nSB|LOOP(FOREVER); F(20 CM, 50); END_LOOP", "A = 3",
                    "SI|DEF HOP;F(1, 50);END_DEF;L(1, 50)"):  # fmt: skip
        start.click("#bar_new")
        write(start, program)
    start.click("#home")
    names = start.locator("#start_programs strong")
    assert names.all_inner_texts() == [
        "SI|DEF HOP;F(1, 50);END_DEF;L(1, 50)",
        "A = 3",
        "// a SB|LOOP(FOREVER); F(20 CM, 50); END_LOOP",
        "SI|F(2.5, 80)",
    ]
    start.click("#start_write")
    start.click("#view_blocks")
    start.click("#home")
    assert names.all_inner_texts() == [
        "turn left 1 s at 50 %", "Program 3", "repeat forever", "forward 2.5 s at 80 %",
    ]  # fmt: skip
    speak(start, "es")
    assert names.all_inner_texts() == [
        "gira a la izquierda 1 s al 50 %",
        "Programa 3",
        "repite para siempre",
        "avanza 2.5 s al 80 %",
    ]


def test_a_solved_world_is_celebrated_and_its_stars_are_kept(start: Page) -> None:
    start.evaluate(NOTES_CONFETTI)
    start.click("[data-begin=line]")
    start.select_option("#speed", "20")
    start.locator("#score.whole").wait_for()
    stars = start.inner_text("#score").count("★")
    assert stars > 0 and start.evaluate("window.thrown") == 1
    start.click("#stop")
    assert ("★" * stars) in str(start.locator("#world option[value=line]").text_content())
    start.click("#home")
    lessons = len(catalogue.folders())
    assert start.locator("#start_badge").inner_text().startswith(f"✓ 0/{lessons} ★ {stars}/")


def test_a_new_program_puts_the_robot_at_its_start(start: Page) -> None:
    """Neither the path on the floor nor a crash remains from the program before."""
    start.click("[data-begin=obstacle]")
    start.locator("#values dd").first.filter(has_text="1.").wait_for()
    screenshot_before = start.locator("#arena").screenshot()
    start.click("#bar_new")
    start.wait_for_function("document.documentElement.dataset.phase === 'off'")
    assert set(start.locator("#values dd").all_inner_texts()) == {"–"}
    start.evaluate(SETTLED_SCRIPT)
    new_program_image = start.locator("#arena").screenshot()
    assert new_program_image != screenshot_before
    start.click("#erase_ways")
    start.evaluate(SETTLED_SCRIPT)
    assert start.locator("#arena").screenshot() == new_program_image


@sampled
def test_a_double_press_does_not_hit_a_moved_control(start: Page) -> None:
    start.dblclick("#start_write")
    assert start.get_attribute("#side_real", "aria-pressed") == "false"
    wait_for_blocks(start)
    start.click("#home")
    start.dblclick("[data-begin=dance]", position={"x": 40, "y": 100})
    assert screen(start) == "program"
    assert start.locator(".blocklyToolboxSelected").count() == 0
    wait_for_phase(start, "running")
    start.click("#home")
    start.dblclick("#start_write")  # STOP works immediately
    start.dblclick("#run")
    wait_for_phase(start, "running")
    start.click("#stop")
    wait_for_phase(start, "ended")


def test_the_keyboard_alone_is_enough(start: Page) -> None:
    start.locator("#language").focus()
    visited = []
    for _ in range(6 + len(PICTURES)):
        start.keyboard.press("Tab")
        visited.append(start.evaluate("(e => e.dataset.begin ?? e.id)(document.activeElement)"))
    assert visited == [
        "theme", "open", "stop", *PICTURES, "start_write", "start_lessons", "start_robot",
    ]  # fmt: skip
    start.locator("[data-begin=square]").focus()
    start.keyboard.press("Enter")
    wait_for_phase(start, "running")
    assert start.evaluate("document.activeElement.id") == "stop"
    start.keyboard.press("Space")
    wait_for_phase(start, "ended")
