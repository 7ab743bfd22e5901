"""A class in browsers: pupils at an address of the network, a teacher, and robots on ptys."""

from __future__ import annotations

import json
import re
import time
from collections.abc import Iterator
from functools import partial
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests.support import studio
from tests.support.class_pages import join_class, open_teacher_page, wait_for_status
from tests.support.command import FOREVER
from tests.support.page_screens import LOOK_SCRIPT, SCREENS
from tests.support.pty_robot import PtyRobot
from tests.support.sampling import sample_of
from tests.support.studio import (
    Class,
    Pages,
    axe,
    image,
    speak,
    start_drive,
    wait_for,
    wait_for_note,
    wait_until_checked,
    write,
)
from tests.support.torn_requests import lose_answer, refuse, tear_requests
from tests.support.waiting import until
from tiniscript import compile, robots
from tiniscript.studio.attending import LATCH_S

if TYPE_CHECKING:
    from playwright.sync_api import APIResponse, Browser, Locator, Page, Route

pytestmark = pytest.mark.usefixtures("no_page_timeouts")
sampled = pytest.mark.sampled(of="details of a class", keep=2)

KIT = robots.load("tinibot").kit
WALL_FITS_SCRIPT = (
    "() => wall.scrollHeight === wall.clientHeight && wall.scrollWidth === wall.clientWidth"
)
HOSTILE_NAME = "<img src=x onerror=1>"
# The page waits for an answer however slow this computer is.
NO_TIMEOUT_SCRIPT = """() => { window.limit = AbortSignal.timeout;
  AbortSignal.timeout = () => new AbortController().signal; }"""
# Notes every text that the wall has from now on.
NOTES = """() => { window.noted = '';
  const all = {childList: true, subtree: true, characterData: true};
  new MutationObserver(() => { window.noted += wall.textContent; }).observe(wall, all); }"""

# The number of lines of the bar, if each of its pictures is as wide as it is high.
BAR_LINES_SCRIPT = """() => {
  const pictures = [...document.querySelectorAll('#bar button > svg')].filter((each) => each.checkVisibility());
  if (pictures.some((each) => each.clientWidth < each.clientHeight)) return 0;
  const tops = (each) => {
    const range = document.createRange();
    range.selectNodeContents(each.querySelector('span') ?? each);
    return new Set([...range.getClientRects()].map(({ top }) => Math.round(top))).size;
  };
  return Math.max(...[...document.querySelectorAll('#bar button:not(:has(> svg:only-child))')].map(tops));
}"""  # noqa: E501

# Whether the tabs and the buttons of the bar are each in one row inside the page.
IN_ONE_ROW_SCRIPT = """() => ['#sides', '#bar'].map((row) => {
  const buttons = [...document.querySelectorAll(`${row} > button`)];
  const boxes = buttons.filter((it) => it.checkVisibility()).map((it) => it.getBoundingClientRect());
  return new Set(boxes.map(({ top }) => top)).size < 2 && boxes.every(({ right }) => right <= innerWidth);
})"""  # noqa: E501

# A hand goes up on a page that no longer polls by itself.
RAISE_HAND_SCRIPT = """() => { for (let k = setTimeout(() => {}); k > 0; k--) clearTimeout(k);
  class_hand.click(); }"""

# No picture is made but by `made()`.
HOLD_PICTURES_SCRIPT = """() => { window.held = [];
  const all = HTMLCanvasElement.prototype, make = all.toBlob;
  all.toBlob = function (...words) { held.push(() => make.apply(this, words)); };
  window.made = () => held.shift()();
  window.released = () => { all.toBlob = make; made(); }; }"""
ONE_HELD_SCRIPT = "() => held.length === 1"


@pytest.fixture(scope="module")
def robot() -> Iterator[PtyRobot]:
    with PtyRobot(KIT) as pty_robot:
        yield pty_robot


@pytest.fixture(scope="module")
def shared_class(robot: PtyRobot, browser: Browser) -> Iterator[Class]:
    """A class that many tests share: Python takes a while to start in each page of it."""
    with studio.serve_class([robot.port]) as taught_class:
        taught_class.room.teach(
            {"do": "class_places", "places": 9}
        )  # left ones keep theirs for 5 s
        yield taught_class


@pytest.fixture(scope="module")
def shared_pages(browser: Browser, shared_class: Class) -> Iterator[Pages]:
    opened_pages = Pages(browser, shared_class.server.address)
    yield opened_pages
    opened_pages.close()


@pytest.fixture
def pages(shared_pages: Pages) -> Iterator[Pages]:
    yield shared_pages
    errors, shared_pages.errors[:] = shared_pages.errors[:], []
    assert not errors


@pytest.fixture(scope="module")
def first(shared_pages: Pages, shared_class: Class) -> Page:
    return join_class(shared_pages, shared_class, "Ana")


@pytest.fixture(scope="module")
def teacher(shared_pages: Pages, shared_class: Class) -> Page:
    return open_teacher_page(shared_pages, shared_class)


@pytest.fixture
def ana(first: Page, pages: Pages, shared_class: Class, robot: PtyRobot) -> Iterator[Page]:
    """The page of a pupil without a robot before and after each test."""
    yield first
    robot.switch_on()
    for pupil in shared_class.room.teach({"do": "class"})["pupils"]:
        shared_class.room.teach({"do": "class_next", "pupil": pupil["number"]})
    first.locator("[data-text=class_ask]").wait_for()
    first.locator("html:not([data-robot=connected])").wait_for(state="attached")


def wait_for_link(page: Page, text: str) -> None:
    page.locator("#link_said").filter(has_text=text).wait_for()


def tile(teacher: Page, name: str) -> Locator:
    return teacher.locator("#wall li").filter(has_text=name)


def remove_all_but_ana(class_: Class) -> None:
    """Remove the others, and their remains."""
    for pupil in class_.room.teach({"do": "class"})["pupils"]:
        if pupil["name"] != "Ana":
            class_.room.teach({"do": "class_remove", "pupil": pupil["number"]})
    for kept_work in class_.room.teach({"do": "class"})["kept"]:
        class_.room.teach({"do": "class_forget", "key": kept_work["key"]})


def click_ask(page: Page) -> None:
    page.click("[data-text=class_ask]")


def test_three_pupils_share_a_robot(
    ana: Page, teacher: Page, pages: Pages, shared_class: Class, robot: PtyRobot
) -> None:
    luz, teo = (join_class(pages, shared_class, name) for name in ("Luz", "Teo"))
    large_picture = teacher.locator("#big_pupil")
    click_ask(ana)
    wait_for_status(ana, "It is your turn. Nobody is waiting.")
    wait_for_link(ana, "Connected: ")
    click_ask(luz)
    wait_for_status(luz, "Your place in the queue: 1 of 1.")
    click_ask(teo)
    wait_for_status(teo, "Your place in the queue: 2 of 2.")
    wait_for_status(ana, "It is your turn. Time left: ")
    start_drive(ana, robot)
    # A pupil stops only their own robot.
    luz.click("#stop")
    luz.keyboard.press("Escape")
    time.sleep(0.5)
    assert robot.moves
    tile(teacher, "Ana").locator(".badge.drives").wait_for()
    tile(teacher, "Teo").filter(has_text="place 2").wait_for()
    for name, is_driving in (("Teo", False), ("Ana", True)):  # one without a turn loses none
        tile(teacher, name).locator(".see").click()
        assert large_picture.locator("h2").inner_text() == name
        for action in ("stop", "class_next"):
            assert large_picture.locator(f"[data-text={action}]").is_visible() is is_driving
        if name == "Teo":
            large_picture.locator("[data-text=close]").click()
    large_picture.locator("pre").filter(has_text=FOREVER.split(";")[0]).wait_for()
    large_picture.locator("img[src^=blob]").wait_for()
    large_picture.locator("[data-text=class_stop_all]").click()
    robot.until(lambda: not robot.moves, "the teacher stops it")
    wait_for_link(ana, "Stopped: the robot has confirmed the stop.")
    stops = teacher.locator("#stops")
    stops.filter(has_text="STOP: 1 of 1 connected robots have confirmed it.").wait_for()
    assert not teacher.locator("#stops .wrong").count()
    time.sleep(LATCH_S)
    start_drive(ana, robot)
    large_picture.locator("[data-text=stop]").click()
    robot.until(lambda: not robot.moves, "the teacher stops this one")
    time.sleep(LATCH_S)
    start_drive(ana, robot)
    large_picture.locator("[data-text=class_next]").click()
    robot.until(lambda: not robot.moves, "the turn is over")
    large_picture.locator("[data-text=close]").click()
    wait_for_link(ana, "Your turn is over.")
    wait_for_link(luz, "Connected: ")
    luz.click("#link_leave")
    wait_for_link(teo, "Connected: ")
    start_drive(teo, robot)
    teo.close()
    robot.until(lambda: not robot.moves, "a page that is closed stops it")
    luz.close()


@sampled
def test_a_pupil_whose_connect_is_lost_gets_the_robot_of_the_turn(
    ana: Page, shared_pages: Pages
) -> None:
    for tear, times in ((lose_answer, 2), (refuse, 3)):
        tear_requests(ana, "connect", tear, times)
        click_ask(ana)
        if times == 3:  # most tries of the page itself
            ana.click("#class_pupil [data-text=link_connect]")
        wait_for_link(ana, "Connected: ")
        ana.locator("#class_pupil [data-text=link_connect]").wait_for(state="hidden")
        ana.unroute_all(behavior="wait")
        ana.click("#link_leave")
        ana.locator("[data-text=class_ask]").wait_for()
    errors, shared_pages.errors[:] = shared_pages.errors[:], []
    assert all("ERR_FAILED" in error or "500" in error for error in errors)


def test_features_missing_in_plain_http_are_not_offered(ana: Page) -> None:
    if not ana.evaluate("isSecureContext"):  # true on a computer without a network
        for name in ("serial", "bluetooth", "serviceWorker", "clipboard"):
            assert not ana.evaluate(f"'{name}' in navigator && !!navigator.{name}")
        ana.click("#my_programs")
        ana.click("#share summary")
        ana.click("#share_line")
        ana.locator("#programs[data-shared=done]").wait_for()
        assert not ana.locator("#copy").is_visible()
        ana.click("#programs_close")
    for name in ("#link_serial", "#link_bluetooth", "#keys_import", "#link_port", "#keys_claim"):
        assert not ana.locator(name).is_visible()
    assert ana.inner_text("#side_class") == "Your group"  # there is no wall in this state


# The most pixels of a page's height that the entrance takes, by the size of the page.
ENTRANCE_HEIGHTS = {(1366, 768): 110, (1024, 600): 130, (390, 844): 280}


@pytest.mark.parametrize("size", ENTRANCE_HEIGHTS, ids=str)
def test_opening_the_address_of_a_class_shows_its_entrance(
    pages: Pages, shared_class: Class, size: tuple[int, int]
) -> None:
    """Code and name come before everything else, and leave the page its room; the focus is in the
    code. What is said there follows the language.
    """
    page = pages.open("blocks", viewport={"width": size[0], "height": size[1]}, locale="es-AR")
    page.locator("#class_entry").wait_for()
    assert page.inner_text("#class_entry h2") == "Entra a la clase"
    page.wait_for_function("document.activeElement.matches('#class_entry input')")
    for locator in page.locator("#class_entry :is(input, [data-text=class_join]):visible").all():
        box = locator.bounding_box()
        assert (
            box and box["y"] + box["height"] <= size[1] / 2 and box["x"] + box["width"] <= size[0]
        )
    assert page.locator("#class_entry").evaluate("e => e.offsetHeight") <= ENTRANCE_HEIGHTS[size]
    for language, words in (("en", "To send a program"), ("es", "Para enviar un programa")):
        speak(page, language)
        page.locator("#class_entry [role=status]", has_text=words).wait_for()
    assert axe(page) == []
    page.locator("#class_entry input").first.focus()
    page.keyboard.type(shared_class.room.code)
    page.keyboard.press("Tab")
    page.keyboard.type("Eva")
    page.keyboard.press("Enter")
    page.locator("#class_entry").wait_for(state="hidden")
    page.click("#side_real" if size[0] > size[1] else "#other")
    page.click("#side_real")
    wait_for_status(page, "Estás en la clase, Eva")
    if size[0] < size[1]:
        for _ in range(2):
            assert page.evaluate(BAR_LINES_SCRIPT) == 1  # including the raised hand
            assert page.evaluate(IN_ONE_ROW_SCRIPT) == [True, True]
            page.click("#other")
    page.close()
    remove_all_but_ana(shared_class)


def test_a_wrong_code_is_reported_and_a_pupil_can_be_removed(
    pages: Pages, shared_class: Class, teacher: Page
) -> None:
    page = pages.open(locale="es-AR")
    page.click("#side_real")
    page.locator("#class_pupil input").nth(0).fill("000000")
    page.locator("#class_pupil input").nth(1).fill(HOSTILE_NAME)
    page.click("[data-text=class_join]")
    wait_for_status(page, "Ese no es el código de esta clase.")
    page.locator("#class_pupil input").nth(0).fill(shared_class.room.code)
    page.click("[data-text=class_join]")
    wait_for_status(page, "Estás en la clase, ")
    page.reload()  # a tab keeps its place
    wait_until_checked(page)
    page.click("#side_real")
    wait_for_status(page, f"Estás en la clase, {HOSTILE_NAME}"[:40])
    row = tile(teacher, HOSTILE_NAME)
    row.wait_for()
    assert (
        teacher.locator("#class img[src=x]").count()
        == page.locator("#class_pupil img").count()
        == 0
    )
    row.hover()
    row.locator(".out").click()
    wait_for_status(page, "Ahora no estás en la clase.")
    row.locator(".see").and_(teacher.locator("[aria-label*='gone']")).wait_for()
    row.locator(".out").click()  # nor is the work kept then
    row.wait_for(state="detached")
    page.close()
    assert [error for error in pages.errors if "403" not in error] == []
    pages.errors.clear()


@sampled
def test_a_late_answer_does_not_readmit_a_removed_pupil(teacher: Page, shared_class: Class) -> None:
    """A wall that looks while a pupil is removed does not show the pupil again."""
    room = shared_class.room
    for name in ("Eva", "Noa"):
        room.answer("", "192.0.2.7", {"do": "join", "code": room.code, "name": name})
    late_answers: list[tuple[Route, APIResponse]] = []

    def hold(route: Route) -> None:
        if not late_answers and '"do":"class"' in (route.request.post_data or ""):
            late_answers.append((route, route.fetch()))
        else:
            route.continue_()

    tile(teacher, "Eva").wait_for()
    teacher.evaluate(NO_TIMEOUT_SCRIPT)
    teacher.route("**/*", hold)
    wait_for(teacher, lambda: late_answers, "the wall looks")
    tile(teacher, "Eva").hover()
    tile(teacher, "Eva").locator(".out").click()
    tile(teacher, "Eva").wait_for(state="detached")
    teacher.evaluate(NOTES)
    route, response = late_answers[0]
    route.fulfill(response=response)
    teacher.unroute_all(behavior="wait")
    for pupil in room.teach({"do": "class"})["pupils"]:
        if pupil["name"] == "Noa":
            room.teach({"do": "class_remove", "pupil": pupil["number"]})
    tile(teacher, "Noa").wait_for(state="detached")
    assert "Eva" not in teacher.evaluate("window.noted")
    teacher.evaluate("() => { AbortSignal.timeout = window.limit; }")


@sampled
def test_thirty_tiles_fit_without_scrolling(teacher: Page, shared_class: Class) -> None:
    """Their pictures are made of the pupils' texts. A stop that failed takes the place of a row."""
    room = shared_class.room
    room.teach({"do": "class_places", "places": 60})
    tokens = []
    state = room.teach({"do": "class"})
    for k in range(30 - len(state["pupils"]) - len(state["kept"])):
        request = {"do": "join", "code": room.code, "name": f"Pupil {k + 1}"}
        tokens.append(room.answer("", "192.0.2.7", request)["token"])
        text = "SI|F(1, 50);" * (k % 3 + 1)
        beat = {"do": "here", "text": text, "robot": "tinibot", "lessons": ["01_first_line"]}
        room.answer(tokens[k], "192.0.2.7", beat)
    for language, (width, height) in product(("en", "es"), ((1366, 768), (1024, 600))):
        teacher.set_viewport_size({"width": width, "height": height})
        speak(teacher, language)
        teacher.locator("#wall li").nth(29).wait_for()
        assert not teacher.locator("#wall .empty:visible").count()  # the picture arrives later
        teacher.wait_for_function(WALL_FITS_SCRIPT)  # a wall fits its tiles once it knows its size
        assert teacher.evaluate(LOOK_SCRIPT) == []
    tile(teacher, "Pupil 7").locator("img[src^=blob]").wait_for()
    assert tile(teacher, "Pupil 7").locator("i.done").count() == 1
    speak(teacher, "en")
    remove_all_but_ana(shared_class)


@sampled
def test_an_enlarged_picture_stays_while_the_next_is_drawn(
    ana: Page, teacher: Page, shared_class: Class
) -> None:
    remove_all_but_ana(shared_class)
    teacher.locator("#wall li:only-child img[src^=blob]").wait_for()
    teacher.evaluate(HOLD_PICTURES_SCRIPT)
    for language in ("es", "en"):  # each makes it anew
        with teacher.expect_response(
            lambda response: '"class_text"' in (response.request.post_data or "")
        ):
            speak(teacher, language)
        teacher.wait_for_function(ONE_HELD_SCRIPT)
    first_picture = tile(teacher, "Ana").locator("img").get_attribute("src")
    teacher.evaluate("() => made()")
    teacher.wait_for_function(ONE_HELD_SCRIPT)
    assert tile(teacher, "Ana").locator("img").get_attribute("src") != first_picture
    tile(teacher, "Ana").locator(".see").click()
    large_picture = teacher.locator("#big_pupil img[src^=blob]")
    assert large_picture.evaluate(
        "async (image) => { await image.decode(); return image.width > 0; }"
    )
    teacher.click("#big_pupil [data-text=close]")
    teacher.evaluate("() => released()")


LONG_PROGRAM = "SI|" + ";".join(["F(1, 50)", "IF(DISTANCE < 9)", "S", "END_IF"] * 120)
# Time advances only by the test; pages without a wait are counted.
MANUAL_CLOCK_SCRIPT = """() => { window.now = performance.now(); window.each = 0; window.slices = 0;
  performance.now = () => (window.now += window.each);
  const own = setTimeout; window.setTimeout = (does, ms, ...words) => {
    window.slices += ms === 0; return own(does, ms, ...words); }; }"""
SIZE = "async (each) => { await each.decode(); return [each.naturalWidth, each.naturalHeight]; }"


@pytest.mark.long
def test_a_long_program_is_drawn_in_slices_and_truncated(
    first: Page, pages: Pages, shared_class: Class
) -> None:
    """Therefore STOP ALL need not wait for it: `tools.bench.studio` measures the wait."""
    teacher = open_teacher_page(pages, shared_class)
    remove_all_but_ana(shared_class)
    picture = tile(teacher, "Ana").locator("img[src^=blob]")
    picture.wait_for()
    teacher.evaluate(MANUAL_CLOCK_SCRIPT)
    teacher.evaluate("() => { window.each = 20; }")  # each step is as long as a slice
    sizes = []
    for text in (LONG_PROGRAM, LONG_PROGRAM + ";" + LONG_PROGRAM[3:]):
        text_before, slices = picture.get_attribute("src"), teacher.evaluate("slices")
        write(first, text)
        teacher.locator(f"#wall img[src^=blob]:not([src='{text_before}'])").wait_for()
        assert teacher.evaluate("slices") - slices > 300  # each block is made, and drawn
        sizes.append(picture.evaluate(SIZE))
    assert sizes[0] == sizes[1]
    write(first, "F(1, 50)")
    teacher.close()


# Programs that the page has received, and those with a picture.
COUNT_DRAWINGS_SCRIPT = """() => { window.told = []; window.drawn = [];
  const ask = fetch, post = Worker.prototype.postMessage, make = URL.createObjectURL;
  let newest = '';
  window.fetch = async (...words) => {
    const answer = await ask(...words);
    answer.clone().json().then(({ text }) => window.told.push(text), () => {});
    return answer; };
  Worker.prototype.postMessage = function (...words) {
    const { do: what } = JSON.parse(words[0].request);
    if (what === 'blocks') newest = new TextDecoder().decode(words[0].data);
    return post.apply(this, words); };
  URL.createObjectURL = (blob) => (window.drawn.push(newest), make(blob)); }"""


@sampled
def test_a_pupils_picture_is_drawn_once_a_second(
    first: Page, pages: Pages, shared_class: Class
) -> None:
    """Whatever the page writes meanwhile, the newest is drawn then. Others have no wait."""
    teacher = open_teacher_page(pages, shared_class)
    remove_all_but_ana(shared_class)
    tile(teacher, "Ana").locator("img[src^=blob]").wait_for()
    teacher.evaluate(COUNT_DRAWINGS_SCRIPT)
    teacher.evaluate(MANUAL_CLOCK_SCRIPT)

    def is_shown(names: str, text: str, passed_ms: int = 0) -> bool:
        teacher.evaluate(f"() => {{ window.now += {passed_ms}; }}")
        return text in teacher.evaluate(names)

    shown_program = "F(1, 51)"

    def add_line() -> str:
        """Write one line more, at once; return the whole."""
        nonlocal shown_program
        shown_program += "\nW(1)"
        first.locator(".cm-content").focus()
        first.keyboard.press("Control+End")
        first.keyboard.insert_text("\nW(1)")
        return shown_program

    write(first, shown_program)
    wait_for(
        teacher,
        lambda: is_shown("drawn", shown_program, 1000),
        "what waits, and was written between",
    )
    teacher.evaluate("() => { window.now += 1000; }")
    newest = add_line()
    wait_for(teacher, lambda: is_shown("drawn", newest), "after a second it is drawn at once")
    count_before = len(teacher.evaluate("drawn"))
    for _ in range(2):
        newest = add_line()
        wait_for(teacher, partial(is_shown, "told", newest), "it is told")
    request = {"do": "join", "code": shared_class.room.code, "name": "Teo"}
    teo = shared_class.room.answer("", "192.0.2.7", request)["token"]
    shared_class.room.answer(teo, "192.0.2.7", {"do": "here", "text": "S", "robot": "tinibot"})
    tile(teacher, "Teo").locator("img[src^=blob]").wait_for()
    assert teacher.evaluate("drawn")[count_before:] == ["S"]
    teacher.evaluate("() => { window.now += 1000; }")
    wait_for(teacher, lambda: is_shown("drawn", newest), "the newest is drawn")
    assert teacher.evaluate("drawn")[count_before:] == ["S", newest]
    teacher.close()
    remove_all_but_ana(shared_class)


def test_a_robot_that_does_not_confirm_a_stop_is_red_until_the_next_stop(
    ana: Page, teacher: Page, robot: PtyRobot
) -> None:
    click_ask(ana)
    wait_for_link(ana, "Connected: ")
    start_drive(ana, robot)
    robot.switch_off()  # the robot hears nothing, but its port exists
    teacher.keyboard.press("Escape")
    red = teacher.locator("#stops .wrong")
    red.filter(has_text=f"Not confirmed: {robot.port}. If one moves, lift it").wait_for()
    assert "STOP: 0 of 1 connected robots" in teacher.locator("#stops").inner_text()
    robot.switch_on()
    teacher.keyboard.press("Escape")  # the next stop replaces this one
    red.wait_for(state="detached")


@sampled
def test_robots_are_assigned_and_withdrawn(ana: Page, teacher: Page, robot: PtyRobot) -> None:
    click_ask(ana)
    wait_for_link(ana, "Connected: ")
    teacher.click("#class_settings")
    teacher.click("[data-text=class_take]")
    wait_for_link(ana, "Your turn is over.")
    wait_for_status(ana, "Robots: 0.")
    teacher.click("#class_window [data-text=link_look]")
    teacher.locator(f"#class_window select option[value='{robot.port}']").wait_for(state="attached")
    teacher.locator("#class_window select").select_option(robot.port)
    teacher.click("[data-text=class_give]")
    wait_for_status(ana, "Robots: 1.")
    teacher.click("#class_window [data-text=close]")


@sampled
def test_a_switched_off_robot_is_reported(ana: Page, robot: PtyRobot) -> None:
    robot.switch_off()
    click_ask(ana)
    wait_for_link(ana, "Nothing responds.")
    wait_for_status(ana, "You are in the class, ")


def test_every_element_is_visible_and_axe_finds_nothing(
    ana: Page, teacher: Page, pages: Pages, shared_class: Class, pytestconfig: pytest.Config
) -> None:
    long_name_page = join_class(pages, shared_class, "A" * 24)
    click_ask(long_name_page)
    wait_for_link(long_name_page, "Connected: ")
    long_name_page.click("#class_hand")
    tile(teacher, "A" * 24).locator(".hand").wait_for()
    for page in (long_name_page, teacher):
        for width, height in sample_of(pytestconfig, "screens of a class", SCREENS, 2):
            page.set_viewport_size({"width": width, "height": height})
            for language in ("en", "es"):
                speak(page, language)
                wait_until_checked(page)
                assert page.evaluate(LOOK_SCRIPT) == []
            if page is teacher:  # the code is whole, and the tiles have two fifths of a low screen
                assert page.locator("#class_come strong").last.bounding_box()["height"] < 40  # type: ignore[index]
                wall = page.locator("#wall").bounding_box()["height"]  # type: ignore[index]
                assert 5 * wall > 2 * height or height > width
        assert axe(page) == []
    for button, window in (
        ("#class_come", "#big_code"),
        ("#wall .see >> nth=0", "#big_pupil"),
        ("#class_settings", "#class_window"),
    ):
        teacher.click(button)
        teacher.emulate_media(color_scheme="light")
        assert axe(teacher, within=window) == []
        teacher.emulate_media(color_scheme="dark")
        assert axe(teacher, "color-contrast", within=window) == []
        teacher.click(f"{window} [data-text=close]")
    assert axe(teacher, "color-contrast") == []  # the wall, in the dark
    teacher.emulate_media(color_scheme="light")
    speak(teacher, "en")
    tile(teacher, "A" * 24).locator(".hand").click()
    long_name_page.locator("#class_hand[aria-pressed=false]").wait_for()
    long_name_page.evaluate(RAISE_HAND_SCRIPT)
    tile(teacher, "A" * 24).locator(".hand").wait_for()
    long_name_page.close()
    remove_all_but_ana(shared_class)


def test_the_work_of_a_class_is_saved_opened_and_given_back(
    ana: Page, teacher: Page, shared_class: Class, tmp_path: Path
) -> None:
    """Only a teacher's press returns work, to one pupil: taking a name gives no access."""
    write(ana, "F(1, 77)")
    until(lambda: "F(1, 77)" in str(shared_class.room.works()), "the class has it")
    teacher.click("#class_settings")
    with teacher.expect_download() as saving:
        teacher.click("[data-text=class_save]")
    file = tmp_path / "class.json"
    saving.value.save_as(file)
    texts = {pupil["name"]: pupil["text"] for pupil in json.loads(file.read_text())["pupils"]}
    assert texts["Ana"] == "F(1, 77)"
    write(ana, "F(1, 33)")
    for name, message in (
        ("bad.json", "bad.json is not a file of saved class work"),
        ("class.json", "Opened. "),
    ):
        (tmp_path / "bad.json").write_text('{"tiniscript_class": 1, "pupils": [{"name": 5}]}')
        teacher.click("#class_settings")
        teacher.set_input_files("#class_window input[type=file]", tmp_path / name)
        teacher.locator("#class_said").filter(has_text=message).wait_for()
    assert image(ana) == compile("F(1, 33)").image
    row = opened_row(teacher, "Ana")
    choice = row.locator("select")
    assert choice.evaluate("(each) => each.selectedOptions[0].textContent") == "Ana"
    eve = shared_class.room.answer(
        "", "192.0.2.66", {"do": "join", "code": shared_class.room.code, "name": "\u0410na"}
    )["token"]
    # There are two candidates, so none is chosen for the teacher.
    row.locator("button:disabled").wait_for()
    assert axe(teacher, within="#class_giving") == []
    choice.select_option(label="Ana")
    row.locator("button").click()
    ana.locator(".cm-content", has_text="F(1, 77)").wait_for()
    wait_for_note(ana, "Your teacher has given you your work back.")
    wait_until_checked(ana)
    assert image(ana) == compile("F(1, 77)").image
    row.wait_for(state="detached")  # once her page has reported it
    assert "given" not in shared_class.room.answer(eve, "192.0.2.66", {"do": "here"})
    write(ana, "F(1, 78)")  # her later text stays
    until(lambda: "F(1, 78)" in str(shared_class.room.works()), "the class has it")
    assert image(ana) == compile("F(1, 78)").image
    if teacher.locator("#class_giving[open]").count():
        teacher.click("#class_giving [data-text=close]")
    remove_all_but_ana(shared_class)


# The page receives the work, but its next requests are lost.
LOSE_ANSWERS_SCRIPT = """() => { window.own = fetch; window.fetch = (where, what) =>
  what?.body?.includes('"took"') ? Promise.reject(new TypeError('lost')) : own(where, what); }"""


def test_work_is_kept_until_the_page_confirms_receipt(
    ana: Page, teacher: Page, shared_class: Class
) -> None:
    """Its word is lost, and the page is loaded again: it gets the same once more."""
    write(ana, "F(1, 33)")
    until(lambda: "F(1, 33)" in str(shared_class.room.works()), "the class has it")
    request = {"do": "class_bring", "name": "Ana", "text": "F(1, 77)", "robot": "", "lessons": []}
    shared_class.room.teach(request)
    ana.evaluate(LOSE_ANSWERS_SCRIPT)
    row = opened_row(teacher, "Ana")
    row.locator("button").click()
    row.filter(has_text="Ana is getting the work back.").wait_for()
    wait_for_note(ana, "Your teacher has given you your work back.")
    wait_for_status(ana, "The teacher’s computer is not responding.")
    assert "F(1, 77)" in str(shared_class.room.works())
    ana.reload()
    wait_until_checked(ana)
    row.wait_for(state="detached")
    wait_until_checked(ana)
    assert image(ana) == compile("F(1, 77)").image
    ana.click("#side_real")
    remove_all_but_ana(shared_class)


@sampled
def test_what_the_teacher_gives_to_all_is_opened_once_by_each_pupil(browser: Browser) -> None:
    """Nothing is taken from a pupil, and who comes later gets it, too."""
    with studio.serve_class([]) as class_:
        pages = Pages(browser, class_.server.address)
        check_handouts(pages, class_)
        pages.close()
        assert not pages.errors


def check_handouts(pages: Pages, class_: Class) -> None:
    ana = join_class(pages, class_, "Ana")
    write(ana, "F(1, 33)")
    teacher = open_teacher_page(pages, class_)
    teacher.click("#class_studio")
    write(teacher, "F(1, 77)")
    teacher.click("#my_programs")
    assert teacher.inner_text("#programs_stop") == teacher.inner_text("#stop") == "STOP ALL"
    teacher.click("#programs_close")
    teacher.click("#side_class")
    give_to_all(teacher, "The program in your studio")
    opened = teacher.locator("#class_said")
    opened.filter(has_text="Your program has been opened by 0 of 1 pupils.").wait_for()
    press = ana.locator("#class_handout button")
    press.wait_for()
    assert "F(1, 33)" in ana.inner_text(".cm-content")
    ana.reload()
    wait_until_checked(ana)
    assert axe(ana, within="#class_handout") == []
    ana.evaluate(LOSE_OPENED_SCRIPT)
    press.click()
    wait_for_note(ana, "This is your teacher’s program. Yours is in My programs.")
    wait_until_checked(ana)
    assert image(ana) == compile("F(1, 77)").image
    write(ana, "F(1, 78)")
    luz = join_class(pages, class_, "Luz")
    luz.click("#class_handout button")  # she has written nothing that would be kept
    wait_for_note(luz, "Your teacher has sent you a program.")
    opened.filter(has_text="opened by 1 of 2 pupils.").wait_for()
    ana.reload()  # her page's word was lost
    opened.filter(has_text="opened by 2 of 2 pupils.").wait_for()
    wait_until_checked(ana)
    assert press.is_hidden() and image(ana) == compile("F(1, 78)").image
    ana.click("#my_programs")
    assert "F(1, 33)" in ana.inner_text("#versions")
    ana.click("#programs_close")
    give_to_all(teacher, "2[.] .")
    for pupil in (ana, luz):
        pupil.locator("#class_handout", has_text="Your teacher has sent you lesson 2.").wait_for()
        pupil.click("#class_handout button")
        pupil.locator("#lesson_page[data-lesson='2']").wait_for()
    opened.filter(has_text="Lesson 2 has been opened by 2 of 2 pupils.").wait_for()


# What a page says of a handout that it has opened is lost.
LOSE_OPENED_SCRIPT = """() => { window.own = fetch; window.fetch = (where, what) =>
  /"opened":"./.test(what?.body) ? Promise.reject(new TypeError('lost')) : own(where, what); }"""


def give_to_all(teacher: Page, title: str) -> None:
    teacher.click("#class_bar [data-text=class_hand_out]")
    select = teacher.locator("#class_handout_window select")
    option = select.locator("option").filter(has_text=re.compile(f"^{title}"))
    option.wait_for(state="attached")
    select.select_option(index=option.evaluate("(each) => each.index"))
    teacher.click("#class_handout_window section button")


def opened_row(teacher: Page, name: str) -> Locator:
    """Open the window in which work is given back; return the row of this one."""
    teacher.click("#class_bar [data-text=class_give_back]")
    row = teacher.locator("#class_giving li").filter(has_text=name)
    row.wait_for()
    return row


@sampled
def test_a_pupil_who_reopens_the_page_is_the_same_pupil(
    pages: Pages, shared_class: Class, teacher: Page
) -> None:
    page = join_class(pages, shared_class, "Noa")
    write(page, "F(1, 66)")
    until(lambda: "F(1, 66)" in str(shared_class.room.works()), "the class has it")
    page.evaluate("sessionStorage.clear()")  # like a closed page
    tile(teacher, "Noa").hover()
    tile(teacher, "Noa").locator(".out").click()
    page.locator("[data-pupil=class_gone]").wait_for(state="attached")
    page.locator("#class_pupil input").nth(0).fill(shared_class.room.code)
    page.locator("#class_pupil input").nth(1).fill("noa")
    page.click("[data-text=class_join]")
    wait_for_status(page, "You are in the class, Noa.")
    assert tile(teacher, "Noa").count() == 1
    page.close()
    remove_all_but_ana(shared_class)
    errors = [error for error in pages.errors if "403" not in error]
    assert errors == []
    pages.errors.clear()


@sampled
def test_the_teacher_plays_a_pupils_newest_run_in_one_click(
    ana: Page, teacher: Page, shared_class: Class
) -> None:
    """It is exactly that run: with its key presses, its program and its world."""
    remove_all_but_ana(shared_class)
    ana.reload()  # the page forgets the runs of other tests
    wait_until_checked(ana)
    play = tile(teacher, "Ana").locator(".play")
    play.dispatch_event("click")
    teacher.locator("#class_said", has_text="Ana has not run a program yet.").wait_for()
    ana.click("#side_virtual")
    write(ana, "SI|SHOW(RANDOM(1, 1000));\nF(0.3, 80);\nSHOW(7)")
    ana.click("#run")
    ana.locator("html[data-phase=ended]").wait_for(state="attached")
    shown_text = ana.locator("#trace").inner_text()
    tile(teacher, "Ana").hover()
    play.click()
    teacher.locator("#doing", has_text="exactly the same again").wait_for()
    assert teacher.locator("#wall").is_hidden() and "SHOW(7)" in teacher.inner_text(".cm-content")
    assert teacher.locator("#trace").inner_text() == shown_text
    teacher.click("#side_class")
    ana.click("#side_real")


@sampled
@pytest.mark.parametrize("erases", [True, False])
def test_the_end_of_a_class_is_shown(browser: Browser, erases: bool) -> None:
    with studio.serve_class([]) as class_:
        pages = Pages(browser, class_.server.address)
        check_class_end(pages, class_, erases)
        pages.close()
        assert not pages.errors


def check_class_end(pages: Pages, class_: Class, erases: bool) -> None:
    ana = join_class(pages, class_, "Ana")
    write(ana, "F(1, 33)")
    ana.click("#my_programs")
    ana.click("#new")
    teacher = open_teacher_page(pages, class_)
    assert class_.server.entrances.token not in teacher.evaluate("location.href")
    teacher.click("#class_settings")
    if erases:
        teacher.check("#class_window input[type=checkbox]")
    end_button = teacher.locator("button[data-text=class_end]")
    end_button.scroll_into_view_if_needed()
    box = end_button.bounding_box()
    end_button.dblclick()
    sure_button = teacher.locator("[data-text=class_end_sure]")
    sure_box = sure_button.bounding_box()
    assert box is not None and sure_box is not None
    assert (sure_box["x"], sure_box["y"]) == (box["x"], box["y"]), "it is pressed where it was"
    sure_button.click()
    teacher.locator("[data-teacher=class_over]").wait_for(state="attached")
    assert teacher.locator("#class_come").is_hidden()
    assert teacher.locator("#class").inner_text().strip() == "The class is over."
    ana.locator(f"[data-pupil={'class_erased' if erases else 'class_kept'}]").wait_for(
        state="attached"
    )
    wait_until_checked(ana)
    kept_text = "JSON.stringify(localStorage) + JSON.stringify(sessionStorage)"
    ended_text = ana.evaluate(kept_text)
    assert ("F(1, 33)" in ended_text) is not erases
    if erases:
        assert "tiniscript." not in ended_text
        write(ana, "F(1, 44)")  # from here on, text is kept in this page only
        ana.click("#my_programs")
        ana.click("#new")
        ana.click("#my_programs")
        assert ana.locator("#versions li:not(:has(#new)) strong").all_inner_texts() == ["F(1, 44)"]
        assert "tiniscript." not in ana.evaluate(kept_text)
    assert class_.room.has_ended
