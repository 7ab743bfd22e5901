"""Blocks that are tried with a click, found by a word, tuned on a piano and put in by keys."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests.support.node import in_node
from tests.support.page_blocks import (
    FLYOUT,
    PROGRAM,
    block,
    box_of,
    meet,
    path_of,
    start,
    text_of,
    wait_for_other_text,
    wait_for_text,
)
from tests.support.page_runs import run_names
from tests.support.studio import (
    SETTLED_SCRIPT,
    Pages,
    axe,
    speak,
    wait_for,
    wait_for_blocks,
    wait_for_note,
    wait_for_phase,
    write,
)

if TYPE_CHECKING:
    from playwright.sync_api import Locator, Page

sampled = pytest.mark.sampled(of="touched blocks", keep=3)

SCRIPT = Path(__file__).with_name("tones_in_node.mjs")
LARGEST_GAP_PX = 30  # pixels between a block and its message


@pytest.fixture
def page(page: Page) -> Page:
    page.select_option("#speed", "20")
    return page


def touch(page: Page, words: str) -> None:
    """Click a block if no field is."""
    box = box_of(block(page, words))
    page.mouse.click(box["x"] + 4, box["y"] + 26)


def switch_robot_off(page: Page) -> None:
    """Switch the virtual robot off."""
    world = page.input_value("#world")
    page.select_option("#world", "light" if world == "obstacles" else "obstacles")
    wait_for_phase(page, "off")


def list_actions(page: Page) -> list[str]:
    """Return the virtual robot's actions, once it has ended."""
    wait_for_phase(page, "ended")
    lines = (page.locator("#trace").text_content() or "").splitlines()
    return [line.partition(" ")[2] for line in lines]


# -- a block alone ---------------------------------------------------------------------------------


LONG_PROGRAM = """SI|F(2, 80);
LOOP(2);
  HOP;
END_LOOP;
SHOW(DISTANCE);
B(X, 50);
WHEN(DISTANCE < 0);
  BEEP(0.1, 880);
END_WHEN;
DEF HOP;
  BEEP(0.2, 440);
END_DEF;
"""


def test_a_clicked_block_runs_alone_with_its_contents(page: Page) -> None:
    """Its defined words work too; a value is shown, and a hat runs the blocks below it."""
    runs = run_names(page)
    page.click("#runs_close")
    start(page, LONG_PROGRAM)
    text = text_of(page)
    for words, sounds, show_count in (
        ("forward", 0, 0), ("do", 1, 0), ("repeat", 2, 0), ("each time", 1, 0), ("new word", 1, 0),
        ("show", 0, 1),
    ):  # fmt: skip
        switch_robot_off(page)
        touch(page, words)
        events = list_actions(page)
        assert sum(line.startswith("BEEP") for line in events) == sounds, (words, events)
        assert sum(line.startswith("SHOW") for line in events) == show_count, (words, events)
    switch_robot_off(page)
    box = box_of(page.locator(f"{PROGRAM} .blocklyBlock.sensor").first)
    page.mouse.click(box["x"] + 6, box["y"] + 4)
    assert any(line.startswith("SHOW") for line in list_actions(page))
    assert text_of(page) == text
    assert run_names(page) == runs  # a tried block does not create a run
    page.click("#runs_close")


@sampled
def test_a_block_that_cannot_run_alone_gives_the_reason(page: Page) -> None:
    start(page, LONG_PROGRAM)
    page.select_option("#speed", "1")
    touch(page, "forward")
    page.locator(f"{PROGRAM} .alone").wait_for()
    page.locator(f"{PROGRAM} .alone").wait_for(state="detached")
    touch(page, "back")
    wait_for_note(page, "does not run alone: ")
    assert "X" in page.inner_text("#note")
    assert page.locator(f"{PROGRAM} .alone").count() == 0


def test_a_click_ends_no_run_and_moves_no_hidden_robot(page: Page) -> None:
    start(page, "SI|LOOP(FOREVER);\n  F(1, 80);\nEND_LOOP;\n")
    page.click("#run")
    wait_for_phase(page, "running")
    touch(page, "forward")
    page.wait_for_timeout(300)
    page.locator(f"{PROGRAM} .running").wait_for()
    wait_for_phase(page, "running")
    page.keyboard.press("Escape")
    wait_for_phase(page, "ended")
    page.click("#side_real")
    touch(page, "forward")
    page.wait_for_timeout(300)
    wait_for_phase(page, "ended")


@pytest.mark.sampled("try_action")
@pytest.mark.parametrize("try_action", ["keys", "menu"])
def test_keyboard_and_menu_also_try_a_block_on_a_phone(pages: Pages, try_action: str) -> None:
    page = pages.open(viewport={"width": 390, "height": 844})
    start(page, "SI|BEEP(0.2, 440);\nS;\n")
    touch(page, "beep")  # the block stays in the program
    page.locator("html[data-peek]").wait_for(state="attached")
    assert page.locator("html[data-half=program]").count() == 1
    if try_action == "keys":
        page.keyboard.press("Shift+Enter")
    else:
        path_of(block(page, "beep")).click(button="right", position={"x": 6, "y": 6})
        page.locator(".blocklyMenuItem", has_text="Try this block alone").click()
    page.locator("html[data-half=robot]").wait_for(state="attached")
    assert [line.split()[0] for line in list_actions(page) if "BEEP" in line] == ["BEEP"]


def test_a_phone_shows_the_robot_in_a_corner_while_a_block_is_tried(pages: Pages) -> None:
    """The robot continues where it is; no block moves, and touches pass through it."""
    page = pages.open(viewport={"width": 390, "height": 844})
    start(page, "SI|F(1, 60);\n")
    box_before = box_of(block(page, "forward"))
    poses = []
    for _ in range(3):
        touch(page, "forward")
        page.locator("html[data-peek]").wait_for(state="attached")
        assert page.locator("#arena").is_visible()
        assert page.locator("#side button:visible, #side select:visible").count() == 0
        assert box_of(block(page, "forward")) == box_before
        box = page.locator("#driving").bounding_box()
        assert box is not None
        assert page.evaluate(
            "([x, y]) => document.elementFromPoint(x, y).closest('#blocks') !== null",
            [box["x"] + box["width"] / 2, box["y"] + box["height"] / 2],
        )
        wait_for_phase(page, "running")
        wait_for_phase(page, "ended")
        poses.append(page.locator("#where").text_content())
    assert len(set(poses)) == 3
    page.locator("html:not([data-peek])").wait_for(state="attached")
    assert not page.locator("#arena").is_visible()
    page.click("#other")
    page.click("#side_real")
    page.click("#other")
    touch(page, "forward")
    page.evaluate(SETTLED_SCRIPT)
    assert page.locator("html[data-peek]").count() == 0


def test_a_tried_block_starts_at_the_robots_current_pose(page: Page) -> None:
    """It goes on until it touches something; the program begins at the start."""
    start(page, "SI|F(0.5, 60);\n")
    page.select_option("#world", "obstacles")
    page.select_option("#speed", "0.5")
    wait_for_phase(page, "off")

    def measure_distance() -> float:
        wait_for_phase(page, "ended")
        row = page.locator("#values div", has_text="distance").inner_text()
        return float(row.replace("distance sensor", "").split()[0])

    def try_block() -> None:
        touch(page, "forward")
        page.locator(f"{PROGRAM} .alone").wait_for(state="attached")
        page.locator(f"{PROGRAM} .alone").wait_for(state="detached")

    places = []
    for _ in range(3):
        try_block()
        places.append(measure_distance())
    assert places[0] > places[1] + 4 > places[2] + 8
    page.click("#run")
    wait_for(page, lambda: measure_distance() == places[0], "the program begins at the start")
    start(page, "SI|F(5, 60);\n")
    page.hover("#blocks")
    for bumps in ("1", "1"):  # the robot does not pass through obstacles
        try_block()
        assert page.locator("#values div", has_text="Collisions").inner_text().split()[-1] == bumps


# -- the content of a block ------------------------------------------------------------------------


# The word of each move, and its arrow.
ARROWS_SCRIPT = """all => all.map((arrow) => {
  const block = arrow.closest('.blocklyBlock');
  const word = [...block.children].find((each) => each.matches('.blocklyDropdownField'));
  return [word.textContent.replace(/[^a-z ]|\\u00a0/g, ' ').trim(), arrow.getAttribute('d')];
})"""


@sampled
def test_each_move_has_its_arrow(page: Page) -> None:
    start(page, "SI|F(1, 80);\nB(1, 80);\nL(1, 80);\nR(1, 80);\nW(1);\nM(10, 20);\n")
    arrows = page.locator(f"{PROGRAM} path.arrow")
    evaluate_all_before = dict(arrows.evaluate_all(ARROWS_SCRIPT))
    assert len(evaluate_all_before) == len(set(evaluate_all_before.values())) == 4 and all(
        evaluate_all_before.values()
    )
    page.locator(f"{PROGRAM} .blocklyDropdownText", has_text="forward").click()
    page.locator(".blocklyMenuItem", has_text="turn left").click()
    wait_for_text(page, "SI|L(1, 80);\nB(1, 80);\nL(1, 80);\nR(1, 80);\nW(1);\nM(10, 20);\n")
    evaluate_all_after = arrows.evaluate_all(ARROWS_SCRIPT)
    assert [evaluate_all_before[text] for text, _ in evaluate_all_after] == [
        drawn_moves for _, drawn_moves in evaluate_all_after
    ]
    assert [text for text, _ in evaluate_all_after].count("turn left") == 2
    gap = arrows.first.evaluate(
        "e => e.getBoundingClientRect().x - e.closest('.blocklyBlock').getBoundingClientRect().x"
    )
    assert 0 < gap < 14


@sampled
def test_an_editor_opens_over_its_own_field(page: Page) -> None:
    start(page, "SI|F(2, 80);\nBEEP(0.5, 440);\nF(1, 60);\n")
    for k in range(6):
        field = page.locator(f"{PROGRAM} .blocklyNumberField").nth(k)
        block_box = field.evaluate(
            "e => e.closest('.blocklyBlock').getBoundingClientRect().toJSON()"
        )
        field.click()
        editor = page.locator(".blocklyWidgetDiv input")
        editor.wait_for()
        editor_box = editor.evaluate("e => e.getBoundingClientRect().toJSON()")
        assert editor_box["top"] == pytest.approx(block_box["top"], abs=4)
        assert editor_box["bottom"] == pytest.approx(block_box["bottom"], abs=4)
        page.keyboard.press("Escape")
        editor.wait_for(state="detached")


@sampled
def test_a_message_is_at_its_block(page: Page) -> None:
    """It is as near as possible without covering another block, with a line from the block."""
    wide_program = "IF(DISTANCE < 10 AND DISTANCE > 20 AND DISTANCE < 10);\n  S;\nENDIF;\n"
    for text, isolated in (
        (f"SI|{wide_program}S;\nS;\nF(-2);\n", True), (f"SI|F(-2);\nS;\nS;\n{wide_program}", True),
        (f"SI|{wide_program}F(-2);\n{wide_program}", False),
    ):  # fmt: skip
        start(page, text)
        bubble = page.locator("#blocks .blocklyBubble")
        bubble.wait_for()
        page.evaluate(SETTLED_SCRIPT)
        bubble_box = bubble.locator("rect").first.evaluate(
            "e => e.getBoundingClientRect().toJSON()"
        )
        block_box = box_of(page.locator(f"{PROGRAM} .wrong").last)
        other_blocks = page.locator(
            f"{PROGRAM} .blocklyBlock > .blocklyPath:not(.blocklyPathSelected)"
        )
        boxes = other_blocks.evaluate_all(
            "all => all.map((e) => e.getBoundingClientRect().toJSON())"
        )
        if isolated:
            assert 0 < bubble_box["left"] - block_box["right"] < LARGEST_GAP_PX
            assert not [box for box in boxes if meet(box, bubble_box)]
        tail = page.locator("#blocks .blocklyBubbleTail")
        tail_left = tail.evaluate("e => e.getBoundingClientRect().left")
        assert tail_left > block_box["right"] - 14 and tail.is_visible()


@sampled
def test_warnings_stay_collapsed_until_opened(pages: Pages) -> None:
    """An unfinished program has many of them, so blocks keep their size."""
    for size in ((1366, 768), (390, 844)):
        page = pages.open(viewport={"width": size[0], "height": size[1]})
        start(page, "SI|S;\n")
        blocks_height = page.evaluate("blocks.clientHeight")
        page.click("#view_text")
        write(page, "SI|LOOP(FOREVER);\nEND_LOOP;\n")
        page.click("#view_blocks")
        wait_for_blocks(page)
        list_of_all = page.locator("#messages li")
        assert list_of_all.count() and not list_of_all.first.is_visible()
        assert (
            page.evaluate("blocks.clientHeight") >= blocks_height - 24
        )  # a phone's status has two lines
        assert page.locator(f"{PROGRAM} .blocklyIconGroup").is_visible()
        page.click("#sheet")
        assert list_of_all.first.is_visible()
        page.click("#sheet")
        assert not list_of_all.first.is_visible()
        start(page, "SI|S;\n")
        start(page, "SI|F(-2);\n")  # a mistake is reported immediately
        assert list_of_all.first.is_visible()
        assert axe(page) == []


# -- a piano ---------------------------------------------------------------------------------------


def test_the_tone_editor_has_piano_keys() -> None:
    """Each has its whole hertz, in equal steps around A at 440; an arrow leads to the next tone."""
    (row,) = in_node(SCRIPT)
    tones = json.loads(row)
    keys = tones["keys"]
    assert [key["back"] for key in keys] == [key["key"] for key in keys]
    assert {key["name"]: key["hertz"] for key in keys if 69 <= key["key"] < 81}["A"] == 440
    octave = ["C", "C♯", "D", "D♯", "E", "F", "F♯", "G", "G♯", "A", "A♯", "B"]
    for key in keys:
        assert key["name"] == octave[key["key"] % 12]
        assert key["hertz"] == round(440 * 2 ** ((key["key"] - 69) / 12))
    hertz = [key["hertz"] for key in keys]
    for step in tones["steps"]:
        next_keys = [
            hertz_there for hertz_there in hertz if (hertz_there - step["hertz"]) * step["way"] > 0
        ]
        nearest = (
            min(next_keys, key=lambda frequency: abs(frequency - step["hertz"]))
            if next_keys
            else None
        )
        outer_keys = (hertz[-1],) if step["way"] > 0 else (hertz[0],)
        assert step["to"] == (nearest if nearest is not None else outer_keys[0]), step


def pitch(page: Page, hertz: str = "440") -> Locator:
    field = page.locator(f"{PROGRAM} .blocklyNumberField", has_text=hertz)
    field.first.wait_for()
    return field


@sampled
def test_a_tone_is_chosen_by_its_name_and_written_in_hertz(page: Page) -> None:
    for language, name in (("en", "E"), ("es", "mi"), ("pt", "mi")):
        speak(page, language)
        start(page, "SI|BEEP(0.5, 440);\nF(5, 80);\n")
        page.locator(f"{PROGRAM} .blocklyNumberField", has_text="80").click()
        page.locator(".blocklyWidgetDiv input").wait_for()
        assert page.locator(".piano").count() == 0
        page.keyboard.press("Escape")
        pitch(page).first.click()
        piano = page.locator(".piano")
        piano.wait_for()
        assert piano.locator("[aria-pressed=true]").count() == 1
        shade = page.locator(".blocklyDropDownDiv")
        shade.evaluate("e => Promise.all(e.getAnimations().map((each) => each.finished))")
        assert axe(page, within=".blocklyDropDownDiv") == []
        piano.get_by_text(name, exact=True).click()
        wait_for_text(page, "SI|BEEP(0.5, 330);\nF(5, 80);\n")
        assert pitch(page, "330").text_content() == "330"  # the number as typed
        page.keyboard.press("Enter")
        pitch(page, f"{name} 330").first.click()
        piano.wait_for()
        piano.locator("button").last.click()  # higher
        piano.locator(".white").first.click()
        wait_for_text(page, "SI|BEEP(0.5, 523);\nF(5, 80);\n")
        page.keyboard.press("Escape")  # takes back no key that was pressed
        piano.wait_for(state="detached")
        wait_for_text(page, "SI|BEEP(0.5, 523);\nF(5, 80);\n")
    speak(page, "en")


def test_escape_reverts_a_field_in_block_and_text(page: Page) -> None:
    """Otherwise a later change would bring it back."""
    text = "// one\nSI|BEEP(0.5, 440);\nF(5, 80);\n"
    start(page, text)
    for new_text, typed_text in (("80", "12"), ("one", "two"), ("440", "330")):
        page.locator(f"{PROGRAM} .blocklyField", has_text=new_text).last.click()
        page.locator(".blocklyWidgetDiv input").wait_for()
        page.keyboard.type(typed_text)
        wait_for_text(page, text.replace(new_text, typed_text))
        page.keyboard.press("Escape")
        wait_for_text(page, text)
    pitch(page).first.click()
    page.locator(".piano").get_by_text("E", exact=True).click()
    wait_for_other_text(page, text)
    chosen_text = text_of(page)
    page.keyboard.press("Escape")  # a pressed key has been chosen: it was heard
    assert text_of(page) == chosen_text


@sampled
def test_arrow_keys_move_between_tones(page: Page) -> None:
    start(page, "SI|BEEP(0.5, 440);\nS;\n")
    pitch(page).first.click()
    page.keyboard.press("ArrowUp")
    page.keyboard.press("ArrowUp")
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Enter")
    wait_for_text(page, "SI|BEEP(0.5, 466);\nS;\n")
    page.locator(f"{PROGRAM} .blocklyNumberField", has_text="466").click()
    page.keyboard.press("Control+a")
    page.keyboard.type("1234")  # a frequency between piano notes stays
    page.keyboard.press("Enter")
    wait_for_text(page, "SI|BEEP(0.5, 1234);\nS;\n")
    assert pitch(page, "1234").text_content() == "1234"


# -- searching ------------------------------------------------------------------------------------


@pytest.mark.sampled("language", "words")
@pytest.mark.parametrize(
    ("language", "words"),
    [
        ("en", {"repeat": "repeat", "WHILE": "repeat while", "beep": "beep", "distance": "distance",
                "LEFT": "turn left", "hertz": "beep", "music": "beep", "event": "each time",
                "spin": "turn right", "wait": "wait"}),
        ("es", {"repite": "repite", "SÍ": "sí", "si": "si", "gira derecha": "gira a la derecha",
                "girar": "gira a la izquierda", "avanzar": "avanza", "esperar": "espera",
                "repetir": "repite", "bucle": "repite para siempre", "sonido": "pita",
                "música": "pita", "evento": "cada vez que", "variable": "=",
                "girar derecha": "gira a la derecha"}),
        ("pt", {"girar": "vire", "avançar": "avance", "esperar": "espere", "repetir": "repita",
                "som": "apite"}),
    ],
)  # fmt: skip
def test_a_block_is_found_by_its_words(page: Page, language: str, words: dict[str, str]) -> None:
    """At every level; with and without accents, by a word of the text, its effect, a common name,
    or its group.
    """
    speak(page, language)
    start(page, "SI|S;\n", "few")
    for typed_text, text in words.items():
        page.fill(".search input", typed_text)
        page.locator(FLYOUT).filter(has_text=text).first.wait_for()
    page.fill(".search input", "xyzzy")
    none_label = page.locator(".blocklyFlyout:visible .blocklyFlyoutLabel")
    none_label.wait_for()
    assert page.locator(FLYOUT).count() == 0
    for word in re.findall("“(.+?)”", none_label.text_content() or "“”"):
        page.fill(".search input", word)
        page.locator(FLYOUT).first.wait_for()
    page.fill(".search input", "xyzzy")
    page.keyboard.press("Escape")
    page.locator(".blocklyFlyout:visible").wait_for(state="detached")
    assert page.input_value(".search input") == ""
    assert axe(page, within="#writing") == []
    speak(page, "en")


@pytest.mark.sampled("flyout_action")
@pytest.mark.parametrize("flyout_action", ["search", "group"])
def test_a_flyout_closes_when_a_block_is_dragged_out(page: Page, flyout_action: str) -> None:
    start(page, "SI|S;\n", "few")
    if flyout_action == "search":
        page.fill(".search input", "repeat")
    else:
        page.locator(".blocklyToolboxCategory", has_text="Repeat").click()
    source = page.locator(FLYOUT).filter(has_text="repeat").first
    source.wait_for()
    box = box_of(source)
    page.mouse.move(box["x"] + 8, box["y"] + 10)
    page.mouse.down()
    page.mouse.move(700, 400, steps=8)
    page.mouse.up()
    page.locator(".blocklyFlyout:visible").wait_for(state="detached")
    assert page.input_value(".search input") == ""
    wait_for_other_text(page, "SI|S;\n")


# Whether no other pile covers the middle of a block.
IS_SEEN_SCRIPT = """(path) => {
  const {left, top, width, height} = path.getBoundingClientRect();
  const front = document.elementFromPoint(left + width / 2, top + height / 2);
  return path.parentNode.contains(front);
}"""


@sampled
def test_a_tried_stack_hides_no_smaller_one(page: Page) -> None:
    start(page, "SI|S\n\nDEF A_LONG_WORD\n  BEEP(1, 440)\nEND_DEF\n\n/// SHOW(DISTANCE);\n", "all")
    value, pile = block(page, "distance"), block(page, "new word")
    a, b = box_of(value), box_of(pile)
    page.mouse.move(a["x"] + 5, a["y"] + a["height"] / 2)
    page.mouse.down()
    page.mouse.move(b["x"] + 25, b["y"] + b["height"] / 2 + 8, steps=8)
    page.mouse.up()
    wait_for_blocks(page)
    assert abs(box_of(value)["x"] - b["x"]) < 40  # the value lies on the hat, unattached
    page.mouse.click(b["x"] + 6, b["y"] + b["height"] - 8)
    page.locator("#blocks .alone").first.wait_for(state="attached")
    wait_for_phase(page, "ended")
    assert path_of(value).evaluate(IS_SEEN_SCRIPT)


# -- no overlays on blocks -------------------------------------------------------------------------


WIDE_BLOCK = "IF(DISTANCE < 20 AND LIGHT_L > 10 AND LIGHT_R > 10)\n  BEEP(0.1, 440)\nENDIF\n"
# Each control that lies over a block of the program, as far as that one is seen.
COVERED_SCRIPT = """() => {
  const inside = (a, b) => a.left < b.right - 1 && b.left < a.right - 1
    && a.top < b.bottom - 1 && b.top < a.bottom - 1;
  const box = (each) => each.getBoundingClientRect();
  const {top, right, bottom} = box(document.querySelector('#blocks .injectionDiv > .blocklySvg'));
  const view = {left: box(document.querySelector('.blocklyToolbox')).right, top, right, bottom};
  const program = '#blocks .blocklySvg > .blocklyWorkspace > .blocklyBlockCanvas .blocklyPath';
  const blocks = [...document.querySelectorAll(program)]
    .map(box).filter((each) => inside(each, view)).map(({left, top, right, bottom}) => ({
      left: Math.max(left, view.left), top: Math.max(top, view.top),
      right: Math.min(right, view.right), bottom: Math.min(bottom, view.bottom)}));
  const kinds = 'button, select, input, .blocklyZoom, .blocklyTrash';
  return [...document.querySelectorAll(kinds)]
    .filter((each) => each.checkVisibility({visibilityProperty: true}))
    .filter((each) => blocks.some((block) => inside(box(each), block)))
    .map((each) => each.id || each.outerHTML.slice(0, 60));
}"""


@pytest.mark.sampled("size")
@pytest.mark.parametrize("size", [(1366, 768), (1024, 600), (820, 1180), (390, 844)], ids=str)
def test_no_control_covers_a_block_of_the_program(page: Page, size: tuple[int, int]) -> None:
    """This also holds if the blocks fill the visible area."""
    page.set_viewport_size({"width": size[0], "height": size[1]})
    page.evaluate(SETTLED_SCRIPT)
    if page.locator("html[data-phone][data-half=robot]").count():
        page.click("#other")
    start(page, "SI|" + 8 * WIDE_BLOCK, "all")
    assert page.evaluate(COVERED_SCRIPT) == []
    if page.locator(".zoom").is_visible():
        width = box_of(block(page, "beep"))["width"]
        page.locator(".zoom button").nth(1).click()
        page.evaluate(SETTLED_SCRIPT)
        assert box_of(block(page, "beep"))["width"] > width
        assert page.evaluate(COVERED_SCRIPT) == []
        page.locator(".zoom button").nth(0).click()
        page.evaluate(SETTLED_SCRIPT)
        assert box_of(block(page, "beep"))["width"] == pytest.approx(width, abs=1)
    assert page.locator(".zoom").is_visible() == (size[0] >= 1000)


# -- the keyboard alone ----------------------------------------------------------------------------


def take_block(page: Page, words: str) -> None:
    """Look for a block with the keyboard, and take it."""
    page.locator(".search input").focus()
    page.keyboard.press("Control+a")
    page.keyboard.type(words)
    page.locator(FLYOUT).filter(has_text=words).first.wait_for()
    page.keyboard.press("Enter")
    page.wait_for_timeout(100)
    page.keyboard.press("Enter")


def test_a_block_inserted_by_keyboard_goes_to_the_focus(page: Page) -> None:
    start(page, "SI|F(1, 80);\nB(1, 80);\n")
    touch(page, "forward")
    wait_for_phase(page, "ended")
    take_block(page, "wait")
    wait_for_text(page, "SI|F(1, 80);\nW(1);\nB(1, 80);\n")
    assert "wait" in page.evaluate("document.activeElement.closest('.blocklyBlock').textContent")
    take_block(page, "repeat forever")  # dropped below that block
    wait_for_text(page, "SI|F(1, 80);\nW(1);\nLOOP(FOREVER);\nEND_LOOP;\nB(1, 80);\n")
    take_block(page, "beep")  # into an empty place
    wait_for_text(
        page, "SI|F(1, 80);\nW(1);\nLOOP(FOREVER);\n  BEEP(0.5, 440);\nEND_LOOP;\nB(1, 80);\n"
    )
    take_block(page, "distance")  # a value into its first place
    wait_for_text(
        page, "SI|F(1, 80);\nW(1);\nLOOP(FOREVER);\n  BEEP(DISTANCE, 440);\nEND_LOOP;\nB(1, 80);\n"
    )
    wait_for_blocks(page)
