"""A phone: the program and the robot are a screen each, over one bar with Run and STOP."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import pytest

from tests.support.page_blocks import PROGRAM, box_of, start
from tests.support.page_lessons import choose_lesson
from tests.support.page_robot import wait_for_running
from tests.support.studio import (
    SETTLED_SCRIPT,
    Pages,
    axe,
    speak,
    turn,
    wait_for,
    wait_for_blocks,
    wait_for_phase,
    wait_until_checked,
    write,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from playwright.sync_api import Page

pytestmark = pytest.mark.sampled(files="sides of the page", keep=3)
sampled = pytest.mark.sampled(of="looks of a phone", keep=2)

NINE_BLOCKS = """SI|LOOP(3)
  F(1, 80)
  BEEP(0.1, 440)
  R(0.5, 60)
END_LOOP
F(-2, 80)
B(1, 80)
L(1, 80)"""
# The number of blocks fully visible above the compiler's message.
SEEN_SCRIPT = """() => {
  const sheet = document.querySelector('#messages').getBoundingClientRect();
  const { top, bottom } = document.querySelector('#blocks').getBoundingClientRect();
  const low = sheet.height ? sheet.top : bottom;
  return [...document.querySelectorAll('#blocks .blocklyBlockCanvas .blocklyDraggable')]
    .filter((block) => !block.parentElement.closest('.blocklyDraggable.blocklyShadow')
      && !block.classList.contains('blocklyShadow'))
    .map((block) => block.querySelector(':scope > .blocklyPath').getBoundingClientRect())
    .filter((box) => box.top >= top && box.bottom <= low).length;
}"""


@pytest.fixture
def phone(page: Page) -> Iterator[Page]:
    page.set_viewport_size({"width": 390, "height": 844})
    page.locator("html[data-phone]").wait_for(state="attached")
    turn(page, "program")
    yield page
    page.keyboard.press("Escape")
    page.set_viewport_size({"width": 1366, "height": 768})
    page.locator("html:not([data-phone])").wait_for(state="attached")
    page.click("#view_text")


def shown_half(page: Page) -> str:
    return str(page.evaluate("document.documentElement.dataset.half"))


@sampled
def test_six_blocks_are_visible_beside_a_message(phone: Page) -> None:
    write(phone, NINE_BLOCKS)
    phone.click("#view_blocks")
    wait_for_blocks(phone)
    assert phone.locator("#messages li").is_visible()
    assert phone.evaluate(SEEN_SCRIPT) >= 6
    assert axe(phone) == []


@sampled
def test_the_messages_can_be_collapsed(phone: Page) -> None:
    for wrong_text in ("F(-2, 80)", "F(-3, 80)"):
        write(phone, wrong_text)
        assert phone.locator("#messages li").is_visible() == (wrong_text == "F(-2, 80)")
        if phone.get_attribute("#sheet", "aria-expanded") == "true":
            phone.click("#said", position={"x": 30, "y": 20})  # its words
        assert not phone.locator("#messages li").is_visible()
    assert axe(phone) == []
    phone.click("#run")  # shows the reason
    assert shown_half(phone) == "program"
    assert phone.locator("#messages li").is_visible()
    phone.click("#sheet")
    write(phone, "S")  # once it is corrected, the next mistake is reported
    assert not phone.locator("#sheet").is_visible()
    write(phone, "F(-2, 80)")
    assert phone.locator("#messages li").is_visible()


@pytest.mark.parametrize("size", [(390, 844), (844, 390)], ids=["upright", "lying"])
def test_run_and_stop_are_on_both_phone_screens(phone: Page, size: tuple[int, int]) -> None:
    write(phone, "SI|LOOP(FOREVER); F(1, 80); END_LOOP")
    phone.set_viewport_size({"width": size[0], "height": size[1]})
    for screen_name in ("program", "robot"):
        turn(phone, "program")
        phone.click("#run")
        wait_for_phase(phone, "running")
        assert shown_half(phone) == "robot"
        assert phone.locator("#arena").is_visible() and not phone.locator("#writing").is_visible()
        turn(phone, screen_name)
        phone.click("#stop")
        wait_for_phase(phone, "ended")
        assert shown_half(phone) == screen_name


def test_run_shows_the_virtual_robot_unless_the_real_one_is_shown(phone: Page) -> None:
    write(phone, "SI|F(0.2, 80)")
    turn(phone, "robot")
    phone.click("#side_lessons")
    phone.click("#run")
    assert phone.locator("#arena").is_visible() and phone.locator("#lesson_steps").is_visible()
    phone.keyboard.press("Escape")
    turn(phone, "program")
    write(phone, "SI|F(9, 80)")
    turn(phone, "robot")
    phone.click("#side_real")
    phone.click("#run")
    phone.locator("#link_said", has_text="No robot is connected").wait_for()
    assert phone.locator("html[data-phase=running]").count() == 0
    assert phone.locator("#link").is_visible()
    phone.click("#side_virtual")
    phone.click("#run")
    wait_for_phase(phone, "running")


@sampled
def test_a_phone_begins_with_the_pictures(pages: Pages) -> None:
    """On a tablet, a second tap does not hit the element that replaces the first."""
    page = pages.open("start", viewport={"width": 390, "height": 844}, has_touch=True)
    assert page.locator("#bar button:visible").evaluate_all("all => all.map(e => e.id)") == ["stop"]
    page.tap("[data-begin=dance]")
    wait_for_phase(page, "running")
    assert shown_half(page) == "robot" and page.locator("#arena").is_visible()
    page.tap("#home")
    page.tap("#start_lessons")
    assert page.locator("#lesson_page").is_visible()
    page.tap("#home")
    page.tap("#start_write")
    assert shown_half(page) == "program" and page.locator("#writing").is_visible()
    page.tap("#home")
    page.set_viewport_size({"width": 1366, "height": 768})
    page.locator("html:not([data-phone])").wait_for(state="attached")
    box = page.locator("#start_write").bounding_box()
    assert box
    for _ in range(2):
        page.touchscreen.tap(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    wait_for_blocks(page)
    assert page.get_attribute("#side_real", "aria-pressed") == "false"


@sampled
def test_a_phone_is_turned_while_a_program_runs(phone: Page) -> None:
    write(phone, "SI|LOOP(FOREVER); F(1, 80); END_LOOP")
    phone.click("#run")
    wait_for_phase(phone, "running")
    for width, height in ((844, 390), (390, 844), (844, 390)):
        phone.set_viewport_size({"width": width, "height": height})
        phone.evaluate(SETTLED_SCRIPT)
        ratio = phone.locator("#arena").evaluate(
            "(a) => a.width / a.clientWidth / (a.height / a.clientHeight)"
        )
        assert ratio == pytest.approx(1, abs=0.02)  # the picture is not stretched
        assert phone.evaluate("document.documentElement.dataset.phase") == "running"
    phone.evaluate("scrollTo(0, document.documentElement.scrollHeight)")
    phone.click("#stop")
    wait_for_phase(phone, "ended")


TRANSPARENT = "rgba(0, 0, 0, 0)"


@sampled
def test_selected_and_running_items_are_visible_in_forced_colors(page: Page) -> None:
    write(page, "SI|LOOP(FOREVER); F(1, 80); END_LOOP")
    page.emulate_media(forced_colors="active")
    width = "(e) => parseFloat(getComputedStyle(e).outlineWidth)"
    style = "(e) => getComputedStyle(e).outlineStyle"
    for name, is_chosen in (("#view_text", True), ("#view_blocks", False), ("#side_virtual", True)):
        assert (page.locator(name).evaluate(style) == "solid") == is_chosen, name
        assert not is_chosen or page.locator(name).evaluate(width) >= 3
    page.click("#run")
    wait_for_running(page)
    mark = "(e) => getComputedStyle(e, '::highlight(running)').backgroundColor"
    field = "(e) => getComputedStyle(e.closest('.cm-editor')).backgroundColor"
    part = page.locator(".cm-line").first
    assert part.evaluate(mark) not in (part.evaluate(field), TRANSPARENT)
    page.click("#view_blocks")
    wait_for_blocks(page)
    page.locator("#blocks .running").wait_for()
    assert axe(page) == []
    page.keyboard.press("Escape")
    page.emulate_media(forced_colors="none")
    page.click("#view_text")


# The height of letters in a box of blocks, and the width and height of its touch targets.
TOUCHED_SCRIPT = """all => all.map((e) => {
  const isNumber = e.matches('.blocklyNumberField'); // which is all of its block
  const shape = e.querySelector(':scope > .blocklyFieldRect') ?? e;
  const own = isNumber ? e.closest('.blocklyBlock') : shape;
  const { width, height } = own.getBoundingClientRect();
  return [e.textContent, Math.min(width, height)];
})"""
LETTERS = """all => all.map((e) => parseFloat(getComputedStyle(e).fontSize) * e.getScreenCTM().a)"""
LONG_PROGRAM = """SI|IF(LIGHT_L > LIGHT_R AND DISTANCE < 20 OR TIME > 3);
  L(0.5, 60);
ELSE;
  M(30, 60);
ENDIF;
F(5, 60) UNTIL(DISTANCE < 10);
"""


@sampled
@pytest.mark.parametrize("language", ["en", "es", "pt"])
def test_blocks_on_a_phone_are_readable_and_touchable(pages: Pages, language: str) -> None:
    """Letters are 12 pixels high, touch targets 24, and a long question has more rows: the whole
    program is visible, except for a question in a question.
    """
    page = pages.open(viewport={"width": 390, "height": 844})
    speak(page, language)
    write(page, LONG_PROGRAM)
    page.click("#view_blocks")
    wait_for_blocks(page)
    canvas = "#blocks .blocklySvg > .blocklyWorkspace > .blocklyBlockCanvas"
    letters = page.locator(f"{canvas} .blocklyText").evaluate_all(LETTERS)
    assert letters and min(letters) >= 11.99
    fields = ".blocklyDropdownField, .blocklyNumberField, .blocklyImageField"
    for name, height in page.locator(f"{canvas} :is({fields})").evaluate_all(TOUCHED_SCRIPT):
        assert height >= 23, name
    rows = page.locator(f"{canvas} .compare > .blocklyPath:not(.blocklyPathSelected)")
    width = page.evaluate("document.querySelector('#blocks').getBoundingClientRect().right")
    last_right = rows.last.evaluate("e => e.getBoundingClientRect()['right']")
    assert last_right <= width
    assert rows.first.evaluate("e => e.getBoundingClientRect().height") > 60  # two rows
    page.set_viewport_size({"width": 1366, "height": 768})
    speak(page, "en" if language != "en" else "es")  # blocks are made anew
    wait_for_blocks(page)
    assert rows.first.evaluate("e => e.getBoundingClientRect().height") < 60


@sampled
@pytest.mark.parametrize("language", ["en", "es", "pt"])
def test_moves_and_messages_on_a_phone_are_fully_visible(pages: Pages, language: str) -> None:
    """They are below one row of buttons: a move gets a second row if it needs one, and no scrollbar
    covers a message."""
    for size in ((390, 844), (360, 740)):
        page = pages.open(viewport={"width": size[0], "height": size[1]})
        speak(page, language)
        start(page, "SI|F(0.5, 60);\nB(0.5, 60);\nLOOP(2);\n  F(2, 80);\n  R(1, 60);\nEND_LOOP;\n")
        rows = page.locator("#views > :is(button, select)").evaluate_all(
            "all => all.map((e) => e.getBoundingClientRect().toJSON())"
        )
        assert len({row["top"] for row in rows}) == 1 and rows[-1]["right"] <= size[0]
        edge = page.evaluate("blocks.getBoundingClientRect().right")
        for move in page.locator(f"{PROGRAM} .move").all():
            assert box_of(move)["right"] <= edge, (size, move.text_content())
        if size != (390, 844):
            continue  # a lower one has its messages in the list alone
        start(
            page, "SI|F(2, 80);\nLOOP(FOREVER);\n  IF(DISTANCE < X);\n    S;\n  ENDIF;\nEND_LOOP;\n"
        )
        bubble = page.locator("#blocks .blocklyBubble rect").first
        bubble.wait_for()
        page.evaluate(SETTLED_SCRIPT)
        bubble_box = bubble.evaluate("e => e.getBoundingClientRect().toJSON()")
        bar = page.locator("#blocks .blocklyMainWorkspaceScrollbar.blocklyScrollbarVertical")
        assert 0 < bubble_box["right"] <= bar.evaluate("e => e.getBoundingClientRect().left")


# Touch targets below STOP; those scrolled out at the top are not below anything.
UNDER_STOP_SCRIPT = """() => {
  const stop = document.querySelector('#stop').getBoundingClientRect();
  const top = document.querySelector('body > header').getBoundingClientRect().bottom;
  return [...document.querySelectorAll('button, select')].filter((each) => {
    if (each.id === 'stop' || !each.checkVisibility()) return false;
    const box = each.getBoundingClientRect();
    const from = each.closest('header') ? box.top : Math.max(box.top, top);
    return box.left < stop.right && box.right > stop.left
      && from < stop.bottom && box.bottom > stop.top;
  }).map((each) => each.id || each.textContent);
}"""


@sampled
def test_a_new_program_can_be_started_from_the_bar_of_a_phone(phone: Page) -> None:
    """Its button shares one row with the rest of the bar, in every language."""
    bar = phone.locator("body > header")
    for language in ("en", "es", "pt"):
        speak(phone, language)
        boxes = bar.locator("button:visible, select:visible").evaluate_all(
            "all => all.map((e) => e.getBoundingClientRect().toJSON())"
        )
        assert len({box["top"] for box in boxes}) == 1 and boxes[-1]["right"] <= 390
        assert all(a["right"] <= b["left"] for a, b in pairwise(boxes))
        name = phone.locator("#language")
        assert name.evaluate("e => e.scrollWidth <= e.clientWidth"), language
    speak(phone, "en")
    write(phone, "SI|F(1, 80)")
    phone.click("#bar_new")
    wait_until_checked(phone)
    assert phone.locator(".cm-content").inner_text().strip() == ""


@sampled
def test_stop_is_as_wide_as_a_phone_only_where_something_may_move(pages: Pages) -> None:
    page = pages.open(viewport={"width": 390, "height": 844}, view="start")

    def width() -> float:
        box = page.locator("#stop").bounding_box()
        assert box is not None and box["height"] >= 44
        return float(box["width"])

    assert width() < 130
    assert page.evaluate(UNDER_STOP_SCRIPT) == []
    page.evaluate("scrollTo(0, document.documentElement.scrollHeight)")
    assert page.evaluate(UNDER_STOP_SCRIPT) == []
    for need in ("link", "run", "link run"):
        page.evaluate("(need) => { document.documentElement.dataset.stop = need; }", need)
        assert width() > 360
    page.evaluate("delete document.documentElement.dataset.stop")
    assert width() < 130


# A STOP, and what is then in the place of Run, where a second tap goes.
STOPPED_SCRIPT = """() => {
  const { left, top, width, height } = document.querySelector('#run').getBoundingClientRect();
  document.querySelector('#stop').click();
  const { id } = document.elementFromPoint(left + width / 2, top + height / 2);
  return [document.documentElement.dataset.phase, id];
}"""


@sampled
@pytest.mark.parametrize("language", ["en", "es", "pt"])
def test_stop_takes_the_place_of_run_while_something_runs(phone: Page, language: str) -> None:
    """The other screen is a tap away, and all is where it was once the run is over."""
    speak(phone, language)
    write(phone, "SI|LOOP(FOREVER); F(1, 80); END_LOOP")

    def boxes() -> dict[str, dict[str, float]]:
        found = phone.locator("#bar button").evaluate_all(
            "all => all.map((e) => [e.id, e.getBoundingClientRect().toJSON()])"
        )
        return dict(found)

    boxes_before = boxes()
    assert phone.locator("#bar button").evaluate_all(
        "all => all.every((e) => e.scrollWidth <= e.clientWidth)"
    )
    phone.dblclick("#run")  # a double click, as children do
    wait_for_phase(phone, "running")
    wait_for(phone, lambda: not phone.locator("#run").is_visible(), "STOP in its place")
    for step in ("program", "robot", "paused"):
        phone.click("#pause") if step == "paused" else turn(phone, step)
        if step == "paused":
            wait_for_phase(phone, "paused")
        boxes_now = boxes()
        assert boxes_now["stop"]["width"] > 0.75 * 390
        assert boxes_now["run"] == boxes_before["run"], "nothing moves"
        assert axe(phone, within="#bar") == []
    assert phone.evaluate(STOPPED_SCRIPT) == ["ended", "stop"]
    phone.locator("html:not([data-stop])").wait_for(state="attached")
    turn(phone, "program")
    assert boxes() == boxes_before
    speak(phone, "en")


# The lowest height of the blocks beside the step of a lesson, by the size of the phone.
LESSON_SIZES = {(390, 844): 400, (320, 640): 200, (844, 390): 150}
SMALLEST_TARGET = 24
# Whether the first words of what is to be done are seen, and whether the last ones are.
READ_SCRIPT = """() => {
  const step = document.querySelector('#lesson_step');
  const strip = document.querySelector('#lesson_page').getBoundingClientRect();
  const paragraphs = [...step.querySelectorAll('p')].filter((each) => each.checkVisibility());
  const isSeen = (text, end) => {
    const range = document.createRange();
    range.selectNodeContents(text);
    const boxes = [...range.getClientRects()];
    const { top, bottom } = boxes.at(end);
    return top >= strip.top && bottom <= strip.bottom;
  };
  return [isSeen(paragraphs[0], 0), isSeen(paragraphs.at(-1), -1)];
}"""
BOXES_SCRIPT = """() => Object.fromEntries(['lessons', 'blocks', 'said', 'views', 'run']
  .map((id) => [id, document.getElementById(id).getBoundingClientRect().toJSON()]))"""
UNDER_SCRIPT = """(id) => {
  const { left, top, width, height } = document.getElementById(id).getBoundingClientRect();
  return document.elementFromPoint(left + width / 2, top + height / 2)?.id;
}"""


@sampled
@pytest.mark.parametrize("size", LESSON_SIZES, ids=lambda size: "x".join(map(str, size)))
def test_the_step_of_a_lesson_is_above_its_program(phone: Page, size: tuple[int, int]) -> None:
    """It is two lines until somebody taps on it. Nothing moves then, and nothing with a run."""
    write(phone, "SI|LOOP(FOREVER); F(1, 80); END_LOOP")
    phone.click("#view_blocks")
    phone.set_viewport_size({"width": size[0], "height": size[1]})
    turn(phone, "robot")
    phone.click("#side_lessons")
    choose_lesson(phone, 4)
    turn(phone, "program")
    wait_for_blocks(phone)
    phone.evaluate(SETTLED_SCRIPT)
    boxes = phone.evaluate(BOXES_SCRIPT)
    line_height = phone.locator("#lesson_step").evaluate(
        "e => parseFloat(getComputedStyle(e).lineHeight)"
    )
    assert boxes["lessons"]["height"] <= 3 * line_height
    assert boxes["blocks"]["height"] >= LESSON_SIZES[size]
    assert phone.evaluate(READ_SCRIPT) == [True, False]
    assert phone.get_attribute("#lesson_unfold", "aria-expanded") == "false"
    target = phone.locator("#lesson_unfold").bounding_box()
    assert target and min(target["width"], target["height"]) >= SMALLEST_TARGET
    phone.click("#lessons", position={"x": 30, "y": 20})  # its words
    assert phone.get_attribute("#lesson_unfold", "aria-expanded") == "true"
    phone.locator("#lesson_page").evaluate("e => { e.scrollTop = e.scrollHeight; }")
    assert phone.evaluate(READ_SCRIPT)[1] and phone.evaluate(BOXES_SCRIPT) == boxes
    assert phone.evaluate(UNDER_SCRIPT, "stop") == "stop"
    assert axe(phone, within="#lessons") == []
    phone.click("#lesson_unfold")
    phone.click("#run")
    wait_for_phase(phone, "running")
    turn(phone, "program")
    running_boxes = phone.evaluate(BOXES_SCRIPT)
    assert phone.evaluate(READ_SCRIPT)[0] and running_boxes == boxes
    phone.click("#stop")
    wait_for_phase(phone, "ended")
    assert phone.evaluate(BOXES_SCRIPT) == boxes
    phone.evaluate("document.documentElement.dataset.peek = ''")  # a block is tried
    assert phone.locator("#arena").is_visible() and phone.evaluate(BOXES_SCRIPT) == boxes
    phone.evaluate("delete document.documentElement.dataset.peek")
    assert not phone.locator("#arena").is_visible()
    turn(phone, "robot")
    phone.click("#side_virtual")
    turn(phone, "program")
    assert not phone.locator("#lesson_step").is_visible()


@sampled
def test_the_first_lines_above_a_program_are_an_instruction(phone: Page) -> None:
    """What introduces the lesson is above it once all is shown."""
    turn(phone, "robot")
    phone.click("#side_lessons")
    choose_lesson(phone, 1)
    phone.locator("#lesson_steps button").first.click()
    intro = phone.locator("#lesson_step .intro")
    assert intro.is_visible() and phone.locator("#lesson_step .program").is_visible()
    turn(phone, "program")
    assert phone.locator("#lesson_step p").last.is_visible() and not intro.is_visible()
    assert not phone.locator("#lesson_step .program").is_visible()
    phone.click("#lesson_unfold")
    assert intro.is_visible() and phone.locator("#lesson_step .program button").is_visible()
    phone.click("#lesson_step .program button")
    wait_until_checked(phone)
    assert phone.locator(".cm-content").inner_text().startswith("SI|F(1, 80)")
