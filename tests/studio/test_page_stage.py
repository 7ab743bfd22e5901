"""The size and view of the virtual robot."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest

from tests.support.page_blocks import PROGRAM, block, box_of, wait_for_text
from tests.support.studio import (
    SETTLED_SCRIPT,
    Pages,
    axe,
    finger,
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

FOREVER = "SI|LOOP(FOREVER);\n  F(1, 60);\n  R(0.5, 60);\nEND_LOOP;\n"
AREA_SCRIPT = (
    "(() => { const { width, height } = arena.getBoundingClientRect(); return width * height; })()"
)
# How long the robot is on the screen: its green does not occur on any floor.
ROBOT_LENGTH_SCRIPT = """() => {
  const { width, height } = arena;
  const pen = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true });
  pen.drawImage(arena, 0, 0);
  const { data } = pen.getImageData(0, 0, width, height);
  const at = [];
  for (let k = 0; k < data.length; k += 4) {
    if (data[k] === 42 && data[k + 1] === 157 && data[k + 2] === 111) at.push([(k / 4) % width, Math.floor(k / 4 / width)]);
  }
  let most = 0;
  for (let angle = 0; angle < Math.PI; angle += 0.1) {
    const along = at.map(([x, y]) => x * Math.cos(angle) + y * Math.sin(angle));
    most = Math.max(most, along.reduce((a, b) => Math.max(a, b), -1e9) - along.reduce((a, b) => Math.min(a, b), 1e9));
  }
  return most / devicePixelRatio;
}"""  # noqa: E501


COLORS_SCRIPT = """() => {
  const { width, height } = arena;
  const pen = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true });
  pen.drawImage(arena, 0, 0);
  const { data } = pen.getImageData(0, 0, width, height);
  return [...new Set(Array.from({ length: data.length / 4 }, (_, k) => data.slice(4 * k, 4 * k + 3).join()))];
}"""  # noqa: E501


@pytest.fixture
def page(page: Page) -> Iterator[Page]:
    yield page
    page.keyboard.press("Escape")
    wait_for(page, lambda: page.evaluate("!document.fullscreenElement"), "no full screen")


def choose(page: Page, camera: str) -> None:
    for _ in range(3):
        if camera in (page.locator("#camera").get_attribute("aria-label") or ""):
            return
        page.click("#camera")
    raise AssertionError(camera)


@pytest.mark.sampled("world")
@pytest.mark.parametrize("world", ["obstacles", "light", "delivery", "free"])
def test_the_robot_view_takes_a_third_of_the_page(page: Page, world: str) -> None:
    page.reload()  # a chosen camera is kept
    page.select_option("#world", world)
    write(page, FOREVER)
    small_area = page.evaluate(AREA_SCRIPT)
    page.click("#run")
    wait_for_large_run(page, 1366 * 768 / 3)
    page.keyboard.press("Escape")
    wait_for_phase(page, "ended")
    assert page.evaluate(AREA_SCRIPT) >= 1366 * 768 / 3  # until someone continues to write
    page.hover("#editor")
    wait_for(page, lambda: page.evaluate(AREA_SCRIPT) == small_area, "as before")


def wait_for_large_run(page: Page, min_area: float = 0) -> None:
    wait_for_phase(page, "running")
    wait_for(page, lambda: page.evaluate(AREA_SCRIPT) >= min_area, "a large part of the page")
    wait_for(
        page,
        lambda: page.evaluate(ROBOT_LENGTH_SCRIPT) >= 65,
        "a robot of 70 pixels, its edge apart",
    )


def see_last_step(page: Page, size: tuple[int, int]) -> float:
    """Open the task of a lesson, with a program that drives on; return how many px of the page the
    arena is to have at least while it does."""
    page.reload()  # a chosen camera is kept
    wait_until_checked(page)
    page.set_viewport_size({"width": size[0], "height": size[1]})
    turn(page, "program")
    write(page, FOREVER)
    turn(page, "robot")
    page.click("#side_lessons")
    page.locator("#lesson:enabled").wait_for()
    page.select_option("#lesson", "3")
    page.locator("#lesson_page[data-lesson='3']").wait_for()
    page.locator("#lesson_steps button").last.click()
    return size[0] * size[1] * (1 / 3 if size[0] == 1366 else 0.2)


# The boxes of the choice of a lesson and of the visible tabs.
CHOICE_AND_TABS_SCRIPT = """() => {
  const all = [...document.querySelectorAll('#lesson, #sides button:not([hidden])')];
  const sorted = all.sort((a, b) => Number(b.id === 'lesson') - Number(a.id === 'lesson'));
  return sorted.map((each) => each.getBoundingClientRect().toJSON());
}"""


def do_overlap(a: dict[str, float], b: dict[str, float]) -> bool:
    return (
        a["left"] < b["right"] and b["left"] < a["right"]
        and a["top"] < b["bottom"] and b["top"] < a["bottom"]
    )  # fmt: skip


@pytest.mark.sampled("size")
@pytest.mark.parametrize("size", [(1366, 768), (1024, 600), (390, 844)], ids=str)
def test_in_a_lesson_the_robot_view_is_large_until_the_next_step(
    page: Page, size: tuple[int, int]
) -> None:
    """The step comes back by the lesson's own buttons, and once the run is over; the check is in
    reach all the time. No tab comes to where lessons are chosen, or goes from there."""
    large_area = see_last_step(page, size)
    small_area = page.evaluate(AREA_SCRIPT)
    choice, *tabs = page.evaluate(CHOICE_AND_TABS_SCRIPT)
    for is_ended in (False, True):
        page.click("#run")
        wait_for_large_run(page, large_area)
        assert not page.locator("#lesson_page").is_visible()
        large_choice, *large_tabs = page.evaluate(CHOICE_AND_TABS_SCRIPT)
        assert not any(do_overlap(choice, tab) for tab in large_tabs)
        assert not any(do_overlap(large_choice, tab) for tab in tabs)
        assert page.locator("#lesson_check").is_visible() and page.locator("#stop").is_visible()
        if is_ended:
            page.keyboard.press("Escape")
            wait_for_phase(page, "ended")
        else:
            page.locator("#lesson_steps button").last.click()
        assert (
            page.locator("#lesson_page").is_visible() and page.evaluate(AREA_SCRIPT) == small_area
        )
        page.click("#stop")
    page.click("#run")
    wait_for_phase(page, "running")
    page.click("#lesson_check")
    page.locator("#lesson_said[data-verdict]").wait_for()
    assert page.evaluate(AREA_SCRIPT) <= small_area and page.locator("#lesson_page").is_visible()
    page.click("#side_virtual")
    turn(page, "program")


@pytest.mark.sampled("size")
@pytest.mark.parametrize("size", [(1366, 768), (1024, 600), (390, 844)], ids=str)
def test_a_judged_run_is_large_until_its_verdict(page: Page, size: tuple[int, int]) -> None:
    large_area = see_last_step(page, size)
    for is_still in (False, True):
        page.emulate_media(reduced_motion="reduce" if is_still else "no-preference")
        page.click("#lesson_check")
        if not is_still:
            wait_for_large_run(page, large_area)
            page.click("#lesson_end")  # the button leads to the lesson's result
        page.locator("#lesson_said[data-verdict]").wait_for()
        assert page.locator("html[data-big]").count() == 0
        assert page.locator("#lesson_page").is_visible() and page.evaluate(AREA_SCRIPT) < large_area
    page.emulate_media(reduced_motion="no-preference")
    page.click("#side_virtual")
    turn(page, "program")


def test_a_finger_drags_the_touched_block_after_a_run(pages: Pages) -> None:
    """The program gets its room back once the finger has left: a group would come under it, which
    takes blocks away."""
    page = pages.open(viewport={"width": 1024, "height": 768}, has_touch=True)
    page.select_option("#world", "free")
    write(page, "SI|F(0.1, 60);\nBEEP(0.1, 440);\n")
    page.click("#view_blocks")
    wait_for_blocks(page)
    page.tap("#run")
    wait_for_phase(page, "ended")
    narrow = page.evaluate("blocks.clientWidth")
    box = box_of(block(page, "beep"))
    x, y = box["x"] + 8, box["y"] + 12
    finger(page, [(x + 5 * k, y + 20 * k) for k in range(9)])
    wait_for(page, lambda: page.evaluate("blocks.clientWidth") > narrow, "the room that it had")
    wait_for_text(page, "SI|F(0.1, 60)\n\n/// BEEP(0.1, 440)\n")
    page.tap("#run")
    wait_for_phase(page, "ended")
    field = page.locator(f"{PROGRAM} .blocklyNumberField", has_text="60")
    at = field.evaluate("e => e.querySelector('text').getBoundingClientRect().toJSON()")
    page.touchscreen.tap(at["x"] + at["width"] / 2, at["y"] + at["height"] / 2)
    wait_for(page, lambda: page.evaluate("blocks.clientWidth") > narrow, "the room that it had")
    editor = page.locator(".blocklyWidgetDiv input")
    editor.wait_for()
    page.evaluate(SETTLED_SCRIPT)
    editor_box = editor.evaluate("e => e.getBoundingClientRect().toJSON()")
    text_box = field.evaluate("e => e.querySelector('text').getBoundingClientRect().toJSON()")
    assert (
        editor_box["left"] <= text_box["left"] + 1 and editor_box["right"] >= text_box["right"] - 1
    )


# Running blocks that the edges of the program cut off.
UNSEEN_BLOCKS_SCRIPT = """() => {
  const seen = document.querySelector('#blocks .blocklySvg').getBoundingClientRect();
  const left = document.querySelector('#blocks .blocklyToolbox').getBoundingClientRect().right;
  return [...document.querySelectorAll('#blocks .running')].filter((each) => {
    const box = each.querySelector(':scope > .blocklyPath').getBoundingClientRect();
    return box.left < left || box.right > seen.right || box.top < seen.top || box.top + 24 > seen.bottom;
  }).map((each) => each.textContent);
}"""  # noqa: E501
# Stacks whose hat is cut off.
CUT_HATS_SCRIPT = UNSEEN_BLOCKS_SCRIPT.replace(
    "'#blocks .running'", "`${PROGRAM} > .blocklyBlock`"
).replace("PROGRAM", "'#blocks .blocklySvg > .blocklyWorkspace > .blocklyBlockCanvas'")
AFTER_RUN_MS = 700  # time after which blocks have their old size
HATS = """SI|LOOP(FOREVER);
  F(1, 60);
END_LOOP;
TASK;
  LOOP(FOREVER);
    BEEP(0.1, 440);
    W(1);
  END_LOOP;
END_TASK;
WHEN(DISTANCE < 5);
  B(1, 60);
END_WHEN;
"""


@pytest.mark.sampled("size")
@pytest.mark.parametrize("size", [(1366, 768), (1024, 600)], ids=str)
def test_each_running_block_is_scrolled_into_view(page: Page, size: tuple[int, int]) -> None:
    """However narrow a large robot leaves the program, and wherever somebody has put a hat; then
    all is as it was."""
    page.set_viewport_size({"width": size[0], "height": size[1]})
    page.select_option("#world", "free")
    write(page, HATS)
    page.click("#view_blocks")
    wait_for_blocks(page)
    canvas = page.locator("#blocks .blocklySvg > .blocklyWorkspace > .blocklyBlockCanvas")
    if size[0] == 1366:  # otherwise it is below the others, out of sight
        hat = canvas.locator("> .blocklyDraggable", has_text="each time")
        box = hat.locator("> .blocklyPath").first.bounding_box()
        assert box
        page.mouse.move(box["x"] + 10, box["y"] + 20)
        page.mouse.down()
        page.mouse.move(560, 330, steps=8)
        page.mouse.up()
        wait_for_blocks(page)

    def place() -> list[int]:
        transform = canvas.get_attribute("transform") or ""
        return [round(100 * float(number)) for number in re.findall(r"[-\d.e]+(?=[,)])", transform)]

    start_place, cut_hats = place(), page.evaluate(CUT_HATS_SCRIPT)
    assert size[0] != 1366 or cut_hats == []
    page.click("#run")
    wait_for_phase(page, "running")
    wait_for(page, lambda: page.locator("#blocks .running").count() == 3, "all hats run")
    wait_for(page, lambda: not page.evaluate(UNSEEN_BLOCKS_SCRIPT), "all are seen")
    page.click("#stop")
    wait_for_phase(page, "ended")
    page.locator("#blocks .running").first.wait_for(state="detached")
    # The view stays for someone who looks at the robot.
    assert page.locator("html[data-big]").count()
    page.wait_for_timeout(AFTER_RUN_MS)
    assert page.evaluate(CUT_HATS_SCRIPT) == cut_hats, "what was seen before the run is seen"
    page.hover("#views")
    wait_for(page, lambda: place() == start_place, "as before")
    page.click("#view_text")


def test_a_pressed_block_stays_under_the_mouse_after_a_run(page: Page) -> None:
    """However the mouse comes there. Once it lets go, or rests on no block, the room is there
    again."""
    page.select_option("#world", "free")
    write(page, HATS)
    page.click("#view_blocks")
    wait_for_blocks(page)
    canvas = page.locator(PROGRAM)
    name = canvas.locator("> .blocklyDraggable", has_text="each time").get_attribute("data-id")
    hat = page.locator(f"#blocks [data-id='{name}']")  # dragging moves it away from the others

    def scale() -> str:
        return (canvas.get_attribute("transform") or "").rpartition("scale")[2]

    def drag(x_shift: float, down: float, steps: int) -> tuple[float, float]:
        box = box_of(hat)
        x, y = box["x"] + 20, box["y"] + 20
        page.mouse.move(x, y, steps=steps)
        page.evaluate(SETTLED_SCRIPT)
        page.mouse.down()
        page.mouse.move(x + x_shift, y + down, steps=4)
        page.wait_for_timeout(AFTER_RUN_MS)
        moved_box = box_of(hat)
        page.mouse.up()
        wait_for_blocks(page)
        return moved_box["x"] - box["x"], moved_box["y"] - box["y"]

    drag(200, 60, 1)
    full_scale, width = scale(), page.evaluate("blocks.clientWidth")
    for steps, end_action, x_shift in (
        (1, "click", -30),
        (9, "Escape", 30),
        (0, "click", -30),
        (1, "Escape", 30),
    ):
        page.click("#run")
        wait_for_phase(page, "running")
        wait_for(page, lambda: scale() != full_scale, "smaller beside the robot")
        page.click("#stop") if end_action == "click" else page.keyboard.press(end_action)
        wait_for_phase(page, "ended")
        page.wait_for_timeout(AFTER_RUN_MS)
        if not steps:
            page.hover("#views")
            wait_for(page, lambda: page.evaluate("blocks.clientWidth") == width, "its room")
            assert scale() == full_scale
        assert drag(x_shift, 20, steps or 1) == pytest.approx((x_shift, 20), abs=4)
        wait_for(page, lambda: page.evaluate("blocks.clientWidth") == width, "the room that it had")
        wait_for(page, lambda: scale() == full_scale, "as before")
    page.click("#view_text")


def test_scrolling_during_a_run_is_respected(page: Page) -> None:
    """This lasts beyond the end of the run; the next run scrolls into view again."""
    page.select_option("#world", "free")
    write(page, "SI|LOOP(FOREVER)\n" + "F(0.1, 60)\n" * 30 + "END_LOOP")
    page.click("#view_blocks")
    wait_for_blocks(page)
    canvas = page.locator("#blocks .blocklySvg > .blocklyWorkspace > .blocklyBlockCanvas")
    page.click("#run")
    wait_for_phase(page, "running")
    text_before = canvas.get_attribute("transform")
    wait_for(page, lambda: canvas.get_attribute("transform") != text_before, "it is scrolled")
    page.hover("#blocks")
    page.mouse.wheel(0, 40)
    page.wait_for_timeout(300)
    chosen_text = canvas.get_attribute("transform")
    page.wait_for_timeout(2500)
    assert canvas.get_attribute("transform") == chosen_text
    page.click("#stop")
    wait_for_phase(page, "ended")
    page.wait_for_timeout(1000)
    assert canvas.get_attribute("transform") == chosen_text
    page.click("#run")
    wait_for(page, lambda: canvas.get_attribute("transform") != chosen_text, "it is scrolled again")
    page.click("#stop")
    page.click("#view_text")


def test_a_newly_chosen_world_is_fully_visible_and_moves_no_button(page: Page) -> None:
    """The world's goal would be out of sight, and the next press would miss its button."""
    write(page, "SI|F(0.1, 20);\n")
    page.select_option("#world", "free")
    page.click("#run")
    wait_for_phase(page, "ended")
    camera, run = page.locator("#camera"), page.locator("#run")
    near_text, box = camera.get_attribute("title"), run.bounding_box()
    page.select_option("#world", "light")
    assert camera.get_attribute("title") != near_text
    assert run.bounding_box() == box


@pytest.mark.sampled("language")
@pytest.mark.parametrize("language", ["en", "es", "pt"])
def test_the_block_selector_stays_in_one_row_beside_a_large_robot(
    page: Page, language: str
) -> None:
    page.set_viewport_size({"width": 1280, "height": 768})
    speak(page, language)
    page.click("#view_blocks")
    page.click("#run")
    page.locator("html[data-big]").wait_for(state="attached")
    for level in ("few", "usual", "all"):
        page.select_option("#level", level)
        style_script = "getComputedStyle(document.querySelector('#level'), '::picker-icon').display"
        assert page.evaluate(style_script) != "none"
        rows = "new Set([...views.children].map((each) => each.getBoundingClientRect().top)).size"
        assert page.evaluate(rows) == 1, (language, level)
    page.click("#stop")
    page.click("#view_text")


def test_a_key_toggles_full_screen(page: Page) -> None:
    """The button works as well, and typing an F does not. STOP stays in reach, Escape leaves it."""
    write(page, FOREVER)
    page.locator(".cm-content").focus()
    page.keyboard.type("f")
    assert page.locator("html[data-full]").count() == 0
    page.keyboard.press("Backspace")
    page.locator("#run").focus()
    for trigger in ("f", "F", "click"):
        for is_full in (True, False):
            page.click("#full") if trigger == "click" else page.keyboard.press(trigger)
            page.locator("html[data-full]" if is_full else "html:not([data-full])").wait_for(
                state="attached"
            )
            assert page.locator("#writing").is_visible() != is_full
            assert page.locator("#stop").is_visible() and page.locator("#run").is_visible()
            assert not is_full or page.evaluate(AREA_SCRIPT) > 0.8 * 1366 * 768
            assert page.locator("#full").get_attribute("aria-pressed") == str(is_full).lower()
    page.click("#full")
    page.click("#run")
    wait_for_phase(page, "running")
    assert axe(page, within="#driving") == []
    page.keyboard.press("Escape")
    page.locator("html:not([data-full])").wait_for(state="attached")
    wait_for_phase(page, "ended")


def test_a_camera_follows_from_above_and_from_behind(page: Page) -> None:
    page.select_option("#world", "free")
    write(page, "SI|F(0.1, 20);\nS;\n")
    page.click("#run")
    wait_for_phase(page, "ended")
    lengths = {}
    for camera in ("whole", "above", "behind"):
        choose(page, camera)
        lengths[camera] = page.evaluate(ROBOT_LENGTH_SCRIPT)
        assert page.locator("#arena.behind").count() == (camera == "behind")
    assert lengths["whole"] < 60 < lengths["above"] < lengths["behind"]
    page.click("#world_draw:enabled")  # all of the floor is seen to be changed
    assert page.evaluate(ROBOT_LENGTH_SCRIPT) < lengths["behind"]
    page.click("#world_done")
    choose(page, "whole")


def test_objects_have_sides_in_the_view_from_behind(page: Page) -> None:
    write(page, "SI|S;\n")
    for world, raised_text in (("obstacles", "156,115,70"), ("maze", "138,101,68")):
        page.select_option("#world", world)
        wait_for_phase(page, "off")
        for camera in ("whole", "above", "behind"):
            choose(page, camera)
            assert (raised_text in page.evaluate(COLORS_SCRIPT)) == (camera == "behind"), (
                world,
                camera,
            )
    choose(page, "whole")


def test_each_start_picture_leads_to_its_world(page: Page) -> None:
    """A dance floor has tiles that light, and lamps shine in the dark."""
    for start_name, world in (
        ("dance", "dance"), ("light", "light"), ("line", "line"), ("obstacle", "obstacles"),
        ("square", "free"),
    ):  # fmt: skip
        page.click("#home")
        page.click(f"[data-begin={start_name}]")
        wait_for_phase(page, "running")
        assert page.input_value("#world") == world
        if start_name == "dance":
            assert {"251,238,252", "227,240,253", "255,243,207"} <= set(
                page.evaluate(COLORS_SCRIPT)
            )
        if start_name == "light":
            assert "39,50,75" in set(page.evaluate(COLORS_SCRIPT))
            assert "255,253,246" not in set(page.evaluate(COLORS_SCRIPT))
        if start_name == "square":  # a camera that follows shows that it drives
            assert "230,220,196" in set(page.evaluate(COLORS_SCRIPT))
        page.click("#stop")
        wait_for_phase(page, "ended")


def test_a_city_has_lawns_and_streets_with_a_centre_line(page: Page) -> None:
    lawn, street = "207,227,194", "223,226,230"
    for world in ("delivery", "free"):
        page.select_option("#world", world)
        wait_for_phase(page, "off")
        colors = set(page.evaluate(COLORS_SCRIPT))
        assert ({lawn, street} <= colors) == (world == "delivery")
        assert (lawn in colors or street in colors) == (world == "delivery")


@pytest.mark.sampled("size")
@pytest.mark.parametrize("is_lesson", [False, True], ids=["own program", "lesson"])
@pytest.mark.parametrize("size", [(1024, 600), (390, 844)], ids=str)
def test_cameras_and_full_page_view_work_on_small_screens(
    page: Page, size: tuple[int, int], is_lesson: bool
) -> None:
    if is_lesson:
        see_last_step(page, size)
    else:
        write(page, FOREVER)
        page.set_viewport_size({"width": size[0], "height": size[1]})
        turn(page, "robot")
    small_area = page.evaluate(AREA_SCRIPT)
    for button in ("#camera", "#full"):
        box = page.locator(button).bounding_box()
        assert box is not None and min(box["width"], box["height"]) >= 44
    page.click("#full")
    wait_for(page, lambda: page.evaluate(AREA_SCRIPT) > small_area, "more of the robot")
    page.click("#run")
    wait_for_phase(page, "running")
    shown_buttons = "all => all.filter((e) => e.checkVisibility()).map((e) => e.id)"
    assert page.locator("body > header button").evaluate_all(shown_buttons) in ([], ["stop"])
    assert page.evaluate(AREA_SCRIPT) > 0.6 * size[0] * size[1]
    page.click("#stop")
    page.click("#full")
    choose(page, "above")  # the default position
    page.click("#run")
    wait_for_large_run(page)
    page.keyboard.press("Escape")
    turn(page, "program")
