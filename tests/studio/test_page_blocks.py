"""The program as blocks in the page: used with a mouse, a finger or keys."""

from __future__ import annotations

import json
import random
import re
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests.oracle import programs as oracle_programs
from tests.studio.programs import programs
from tests.studio.random_in_page import compare, round_trip, without_places
from tests.support.block_words import program_with_word
from tests.support.casefile import ROOT
from tests.support.kits import KITS
from tests.support.needs import need
from tests.support.page_blocks import (
    FLYOUT,
    PATIENCE_MS,
    PROGRAM,
    block,
    box_of,
    drag,
    list_offered_blocks,
    meet,
    path_of,
    start,
    text_of,
    wait_for_other_text,
    wait_for_text,
)
from tests.support.page_screens import SCREENS
from tests.support.sampling import sample_of
from tests.support.studio import (
    SETTLED_SCRIPT,
    Pages,
    finger,
    image,
    speak,
    wait_for,
    wait_for_blocks,
    wait_for_note,
    wait_for_phase,
    wait_until_checked,
    write,
)
from tiniscript import check, compile, robots
from tiniscript.base.languages import languages
from tiniscript.base.limits import PARAMETERS
from tiniscript.base.words import WORDS
from tiniscript.lessons import catalogue
from tiniscript.studio.block_form import data_of, kinds_in
from tiniscript.studio.block_kinds import KINDS, PLAIN_TEXTS
from tiniscript.studio.block_reading import read_blocks
from tools.builds.page_texts import page_texts
from tools.builds.studio import BLOCKLY, unusable_reason

if TYPE_CHECKING:
    from collections.abc import Callable

    from playwright.sync_api import Page

sampled = pytest.mark.sampled(of="details of blocks", keep=4)

SAMPLE_SIZE = 8  # random programs
# Whether a text field handles the undo key itself.
KEPT_KEY = """field => field.dispatchEvent(new KeyboardEvent('keydown',
  {key: 'z', ctrlKey: true, bubbles: true, cancelable: true, composed: true}))"""


@pytest.fixture
def page(page: Page) -> Page:
    """A page with blocks of a small program."""
    page.set_default_timeout(PATIENCE_MS)
    start(page, "SI|F(2, 80);\nS;\n")
    return page


@pytest.mark.sampled("part")
@pytest.mark.parametrize("part", range(10))
def test_blocks_of_the_page_match_python(pages: Pages, part: int) -> None:
    """Every tenth program of the documents and 30 random ones: the visible blocks are those read.

    It gets its own page: its test blocks would take the undo keys from the page's blocks. And
    random programs get the image of the command.
    """
    page = pages.open()
    start(page, "SI|LOOP(6)\n  F(FOREVER, 80) UNTIL(DISTANCE < 15)\n  BEEP(0.1, 880)\nEND_LOOP\n")
    first_box = box_of(block(page, "when it starts"))  # a program is seen from its beginning
    pane, words = (
        page.locator(selector).bounding_box() for selector in ("#blocks", ".blocklyToolbox")
    )
    assert pane is not None and words is not None
    assert first_box["x"] > words["x"] + words["width"] and first_box["y"] > pane["y"]
    forms = [
        read_blocks(program.text, robots.load(program.robot).kit)
        for program in programs()[part::10]
    ]
    for seed in range(part, 300, 10):
        oracle_kit, kit = KITS[seed % len(KITS)]
        forms.append(read_blocks(oracle_programs.program(random.Random(seed), oracle_kit), kit))
    data = json.loads(json.dumps([without_places(data_of(form)) for form in forms]))
    for k, (expected_form, actual) in enumerate(zip(data, round_trip(page, data), strict=True)):
        assert actual == expected_form, k
    assert compare(page, SAMPLE_SIZE, seed=1000) > SAMPLE_SIZE * 0.9


def test_a_program_can_be_built_and_run_with_blocks_alone(pages: Pages) -> None:
    """It works with the mouse, and on a small screen with a finger."""
    page = pages.open(view="blocks", locale="es-PE", has_touch=True)
    page.locator("#level").wait_for()
    assert block(page, "al empezar").count() == 1
    drag(page, "Moverse", "avanza", block(page, "gira a la derecha"))
    wait_for_text(page, "SI|F(2, 80);\nR(0.5, 60);\nF(2, 80);\nF(1, 80);\n")
    number = page.locator(f"{PROGRAM} .blocklyNumberField").nth(5)
    number.click()
    assert page.locator(".blocklyWidgetDiv input").get_attribute("inputmode") == "decimal"
    page.keyboard.press("Control+a")
    page.keyboard.type("150")
    box_before = page.locator("#panes").bounding_box()
    page.keyboard.press("Enter")
    # The power cannot be larger.
    wait_for_text(page, "SI|F(2, 80);\nR(0.5, 60);\nF(2, 100);\nF(1, 80);\n")
    wait_for_note(page, "150 pasó a ser 100.")
    assert page.locator("#panes").bounding_box() == box_before, "the note moves the blocks"
    wait_for_note(page, "un número de 0 a 100: 150 pasó a ser 100")
    page.select_option("#speed", "20")
    page.locator(".blocklyWidgetDiv input").wait_for(state="detached")
    wait_for_blocks(page)
    page.click("#run")
    wait_for_phase(page, "ended")
    assert image(page) == compile(text_of(page)).image
    page.set_viewport_size({"width": 1024, "height": 600})
    page.evaluate(SETTLED_SCRIPT)
    page.locator(".blocklyToolboxCategory", has_text="Moverse").tap()
    source = page.locator(FLYOUT).nth(1)
    source.wait_for()
    page.evaluate(SETTLED_SCRIPT)
    source_box, target = box_of(source), box_of(block(page, "gira a la derecha"))
    x, y = source_box["x"] + 8, source_box["y"] + 10
    to_x, to_y = target["x"] + 10, target["y"] + target["height"] + 8
    finger(page, [(x + (to_x - x) * k / 12, y + (to_y - y) * k / 12) for k in range(13)])
    page.locator("#blocks[data-state=shown]").wait_for()
    wait_for(page, lambda: "B(2, 80)" in text_of(page), "a finger has dragged a block")


def test_blocks_and_text_share_one_undo_history(page: Page) -> None:
    drag(page, "Move", "back", block(page, "forward"))
    text_after = text_of(page)
    assert text_after == "SI|F(2, 80);\nB(2, 80);\nS;\n"
    page.mouse.move(600, 300)
    page.mouse.wheel(40, 30)
    box_before = box_of(block(page, "forward"))
    page.click("#undo")
    wait_for_text(page, "SI|F(2, 80);\nS;\n")
    assert block(page, "back").count() == 0
    page.click("#redo")
    wait_for_text(page, text_after)
    assert block(page, "back").count() == 1
    assert box_of(block(page, "forward")) == pytest.approx(box_before, abs=1)
    page.locator("#speed").focus()  # wherever the focus is
    page.keyboard.press("Control+z")
    wait_for_text(page, "SI|F(2, 80);\nS;\n")
    page.keyboard.press("Control+Shift+z")
    wait_for_text(page, text_after)
    assert page.locator("#link_line").evaluate(KEPT_KEY)  # keys in a text field do not count
    block(page, "stop").click(position={"x": 6, "y": 6})
    page.keyboard.press("Delete")
    wait_for_text(page, "SI|F(2, 80);\nB(2, 80);\n")
    page.keyboard.press("Control+z")
    block(page, "stop").wait_for()
    wait_for_text(page, text_after)
    page.click("#view_text")
    page.locator(".cm-content").focus()
    page.keyboard.press("Control+z")
    page.click("#view_blocks")
    wait_for_text(page, "SI|F(2, 80);\nS;\n")


@sampled
def test_an_undo_keeps_the_scroll_position(page: Page) -> None:
    """Also where the focus is on a block, which goes with all others and comes again."""
    long_program = "SI|" + "".join(f"F({k % 9 + 1}, 80);\n" for k in range(30))
    start(page, long_program)
    page.locator(".zoom button").nth(1).click()
    page.mouse.move(600, 300)
    page.mouse.wheel(0, 500)
    page.evaluate(SETTLED_SCRIPT)
    locator = page.locator(f"{PROGRAM} .blocklyNumberField").nth(30)
    place = locator.bounding_box()
    assert place is not None and 150 < place["y"] < 400
    page.mouse.click(place["x"] + 8, place["y"] + 8)
    page.keyboard.type("77")
    page.keyboard.press("Enter")
    new_lines = long_program.splitlines()
    new_lines[15] = "F(77, 80);"
    wait_for_text(page, "\n".join(new_lines) + "\n")
    for _ in range(2):
        box_before = box_of(page.locator(f"{PROGRAM} .blocklyBlock").nth(15))
        page.keyboard.press("Control+z")
        wait_for_text(page, long_program)
        page.locator(f"{PROGRAM} .blocklyActiveFocus").wait_for(state="attached")
        # Blockly scrolls to the focused block, and the page scrolls back
        page.evaluate(SETTLED_SCRIPT)
        assert box_of(page.locator(f"{PROGRAM} .blocklyBlock").nth(15)) == pytest.approx(
            box_before, abs=2
        )
        assert page.locator("#editor .cm-activeLine").inner_text() == long_program.splitlines()[15]
        page.keyboard.press("Control+y")
        wait_for_text(page, "\n".join(new_lines) + "\n")
    block_height = box_of(block(page, "forward"))["height"]
    page.click("#words")
    wait_for_blocks(page)
    assert box_of(block(page, "forward"))["height"] == pytest.approx(block_height, abs=1)
    page.click("#words")
    page.locator(".zoom button").nth(0).click()
    wait_for_blocks(page)


def test_viewing_blocks_does_not_change_the_text(page: Page) -> None:
    text = "// mine\nsi|f( 2,80 )\n\n\n  s // stop"
    start(page, text)
    page.click("#view_text")
    page.click("#view_blocks")
    wait_for_text(page, text)
    block(page, "forward").click(position={"x": 6, "y": 6})
    wait_for_text(page, text)


def test_an_undo_while_a_block_is_dragged_does_nothing(page: Page) -> None:
    """Blocks of the text before would take the place of the one that is in the hand."""
    place = box_of(block(page, "stop"))
    page.mouse.move(place["x"] + 8, place["y"] + 12)
    page.mouse.down()
    page.mouse.move(500, 400, steps=6)
    page.keyboard.press("Control+z")
    page.mouse.move(520, 420, steps=3)
    page.wait_for_timeout(300)
    page.mouse.move(500, 430, steps=3)
    page.mouse.up()
    wait_for_text(page, "SI|F(2, 80)\n\n/// S\n")
    page.keyboard.press("Control+z")
    wait_for_text(page, "SI|F(2, 80);\nS;\n")


@sampled
def test_a_block_snaps_near_a_connection_and_otherwise_stays_loose(page: Page) -> None:
    """Also one without values."""
    drag(page, "Move", "back", block(page, "stop"), off=(20, 24))
    wait_for_text(page, "SI|F(2, 80);\nS;\nB(2, 80);\n")
    page.click("#undo")
    wait_for_text(page, "SI|F(2, 80);\nS;\n")
    drag(page, "Repeat", "forever", None)
    place = box_of(block(page, "forever"))
    page.click("#undo")
    wait_for_text(page, "SI|F(2, 80);\nS;\n")
    page.click("#redo")
    block(page, "forever").wait_for()
    assert box_of(block(page, "forever")) == pytest.approx(place, abs=1)


def test_a_block_with_a_body_encloses_following_blocks(page: Page) -> None:
    """The preview before the drop shows it; a block that already has content does not do this."""
    text_before = "SI|F(2, 80);\nL(1, 60);\nBEEP(0.5, 440);\n"
    start(page, text_before)
    page.locator(".blocklyToolboxCategory", has_text="Repeat").click()
    source = page.locator(FLYOUT).filter(has_text="times").first
    source.wait_for()
    source_box = box_of(source)
    page.mouse.move(source_box["x"] + 8, source_box["y"] + 10)
    page.mouse.down()
    marker = page.locator(f"{PROGRAM} .blocklyInsertionMarker")
    moves_and_beeps = ".move, .beep"
    for words_above, field_count in (("forward", 2), ("turn left", 1), ("beep", 0), ("forward", 2)):
        page.mouse.move(700, 330, steps=8)  # away from all others: no block is lost
        assert block(page, "when it starts").locator(moves_and_beeps).count() == 3
        place = box_of(block(page, words_above))
        page.mouse.move(place["x"] + 10, place["y"] + place["height"] + 8, steps=8)
        assert marker.locator(moves_and_beeps).count() == field_count
    page.mouse.up()
    wrapped = "SI|F(2, 80);\nLOOP(3);\n  L(1, 60);\n  BEEP(0.5, 440);\nEND_LOOP;\n"
    wait_for_text(page, wrapped)
    page.click("#undo")
    wait_for_text(page, text_before)
    page.click("#redo")
    wait_for_text(page, wrapped)
    place, top = box_of(block(page, "times")), box_of(block(page, "when it starts"))
    page.mouse.move(place["x"] + 8, place["y"] + 12)
    page.mouse.down()
    page.mouse.move(place["x"] + 30, place["y"] + 40, steps=4)
    page.mouse.move(top["x"] + 8, top["y"] + top["height"] + 8, steps=8)
    page.mouse.up()
    wait_for_text(page, "SI|LOOP(3);\n  L(1, 60);\n  BEEP(0.5, 440);\nEND_LOOP;\nF(2, 80);\n")


def test_a_loose_block_is_kept(page: Page) -> None:
    drag(page, "Move", "forward", None)
    wait_for_text(page, "SI|F(2, 80);\nS;\n\n/// F(2, 80)\n")
    assert image(page) == compile("SI|F(2, 80);S").image
    assert page.inner_text("#status") == "1 loose block does not run"
    loose_block = block(page, "forward")
    path = path_of(loose_block)
    grey = path.evaluate("e => getComputedStyle(e).fill")
    white = "all => all.filter((e) => getComputedStyle(e).fill === 'rgb(255, 255, 255)').length"
    assert page.locator(f"{PROGRAM} > .loose .blocklyText").evaluate_all(white) == 0
    place = box_of(loose_block)
    page.click("#undo")
    wait_for_text(page, "SI|F(2, 80);\nS;\n")
    assert page.inner_text("#status").startswith("Ready to run")
    assert path.evaluate("e => getComputedStyle(e).fill") != grey
    page.click("#redo")
    wait_for_text(page, "SI|F(2, 80);\nS;\n\n/// F(2, 80)\n")
    assert path.evaluate("e => getComputedStyle(e).fill") == grey
    assert box_of(loose_block) == pytest.approx(place, abs=1)
    page.click("#view_text")
    page.click("#view_blocks")
    assert page.locator("#blocks .blocklyDraggable", has_text="forward").count() >= 2


def test_a_line_that_does_not_parse_is_grey_and_not_lost(page: Page) -> None:
    start(page, "SI|F(2, 80)\nF(1; 80) // hm\nS\n")
    assert block(page, "F(1; 80)").count() == 1
    drag(page, "Move", "turn right", block(page, "stop"))
    wait_for_text(page, "SI|F(2, 80);\nF(1; 80) // hm\nS;\nR(0.5, 60);\n")


def test_blocks_wait_while_a_text_is_being_typed(page: Page) -> None:
    page.locator(".cm-content").focus()
    page.keyboard.press("Control+End")
    page.keyboard.type("F(1")
    page.locator("#blocks[data-state=stale]").wait_for()
    page.locator("#blocks_note", has_text="wait").wait_for()
    assert block(page, "stop").count() == 1
    page.keyboard.type(", 50)")
    page.locator("#blocks[data-state=shown]").wait_for()
    assert page.inner_text("#blocks_note") == ""
    assert block(page, "50").count() == 1
    page.keyboard.type("\nF(")
    page.locator("#blocks_note", has_text="wait").wait_for()
    page.mouse.click(600, 330)  # typed text is not undone
    page.locator("#blocks[data-state=shown]").wait_for()
    assert block(page, "F(").count() == 1
    assert text_of(page).endswith("F(1, 50)\nF(")


def test_compiler_messages_are_shown_at_their_block(page: Page) -> None:
    """When blocks are shown, it names code as blocks do."""
    start(page, "SI|S;\nLOOP(2);\n  F(-2, 80);\nEND_LOOP;\n")
    icons = page.locator("#blocks .blocklyWarningIcon, #blocks .blockly-icon-warning")
    assert icons.count() == 1
    assert "forward" in str(page.locator(f"{PROGRAM} .wrong").text_content())
    message = check("F(-2, 80)")[0]
    bubble = page.locator("#blocks .blocklyBubble")
    bubble.wait_for()
    icons.first.click()  # puts it away
    bubble.wait_for(state="detached")
    page.click("#view_text")
    row, first_message = page.locator("#messages li"), page.locator("#first_message")
    for place in (row, first_message):
        row_text = place.text_content() or ""
        assert message.message in row_text and message.fix in row_text
    page.locator("#messages .repair").wait_for()
    page.click("#view_blocks")
    wait_for_blocks(page)
    assert bubble.count() == 0
    icons.first.click()
    bubble.wait_for()
    named_text, mended_text = "here “forward” takes 0", "Try: “back 2 s at 80 %”"
    bubble_text = "".join((bubble.text_content() or "").split())
    assert (
        "".join(named_text.split()) in bubble_text and "".join(mended_text.split()) in bubble_text
    )
    assert named_text in (first_message.text_content() or "")
    assert row.locator(".on_block").all_inner_texts() == ["forward", "back 2 s at 80 %"]
    assert page.locator("#messages .repair").count() == 1
    assert page.locator("#messages .place").inner_text() == "forward -2 s at 80 %"
    for name in page.locator("#messages button").all():
        assert "forward -2 s at 80 %" in (name.get_attribute("aria-label") or "")
    page.locator("#messages .place").click()
    focused = page.evaluate("document.activeElement.closest('.blocklyDraggable')?.textContent")
    assert "back" in focused or "forward" in focused.replace("\xa0", " ")
    page.locator("#messages .repair").click()
    wait_for_blocks(page)
    wait_for_text(page, "SI|S;\nLOOP(2);\n  B(2, 80);\nEND_LOOP;\n")
    assert icons.count() == 0


def test_a_message_names_what_its_reader_works_with(page: Page) -> None:
    """Whoever types a line reads what to type there; whoever touches blocks reads of blocks."""
    start(page, "SI|S;\nTURN(2);\n")
    message = check("S;\nTURN(2)")[0]
    rows = page.locator("#messages li")
    editor = page.locator("#editor .cm-content")

    def choose_view_again() -> None:
        page.click("#view_text")
        page.click("#view_blocks")

    steps: tuple[tuple[Callable[[], object], bool], ...] = (
        (lambda: editor.press("Control+End"), False),
        (lambda: editor.press_sequentially("S;"), True),
        (lambda: page.click("#undo"), True),
        (choose_view_again, False),
        (lambda: editor.press("Backspace"), True),
        (lambda: page.locator(f"{PROGRAM} .blocklyBlock .blocklyText").first.click(), False),
        (lambda: editor.press("Enter"), True),
    )
    for step, is_typed in steps:
        step()
        wait_until_checked(page)
        rows.filter(has_text=message.fix if is_typed else "turn left 2 s at 80 %").wait_for()


@sampled
def test_a_message_covers_no_block(page: Page) -> None:
    """A message without room is hidden."""
    bubble = page.locator("#blocks .blocklyBubble")
    for width, height in ((1366, 768), (1024, 600), (390, 844)):
        page.set_viewport_size({"width": width, "height": height})
        start(page, "SI|S;\nF(-2);\nF(2, 80);\n")  # the block below it is wider
        bubble.wait_for()
        page.evaluate(SETTLED_SCRIPT)
        bubble_box = bubble.locator("rect").first.evaluate(
            "e => e.getBoundingClientRect().toJSON()"
        )
        paths = page.locator(f"{PROGRAM} .blocklyBlock > .blocklyPath:not(.blocklyPathSelected)")
        boxes = paths.evaluate_all("all => all.map((e) => e.getBoundingClientRect().toJSON())")
        assert not [box for box in boxes if meet(box, bubble_box)], (width, height)
    page.set_viewport_size({"width": 1366, "height": 768})
    start(page, "SI|S;\nF(-2, 80);\n" + 9 * "F(2, 80);\n")
    bubble.wait_for()
    page.set_viewport_size({"width": 900, "height": 560})
    bubble.wait_for(state="detached")


@sampled
def test_the_block_of_each_task_that_runs_is_marked(page: Page) -> None:
    start(page, "SI|S;\nF(FOREVER, 20) UNTIL(FALSE);\nW(1);\n", "all")
    page.click("#run")
    running_block = page.locator("#blocks .blocklyDraggable.running")
    running_block.wait_for()
    assert "until" in (running_block.text_content() or "")
    page.click("#stop")
    wait_for_phase(page, "ended")
    page.select_option("#robot", "tinibot32")
    start(page, "SI|W(9);\nTASK;\n  LOOP(9);\n    W(9);\n  END_LOOP;\nEND_TASK;\n", "all")
    page.click("#run")
    running_block.nth(1).wait_for()
    assert running_block.count() == 2
    page.click("#stop")
    running_block.first.wait_for(state="detached")


def flyout(page: Page, group: str) -> str:
    page.locator(".blocklyToolboxCategory", has_text=group).click()
    page.locator(".blocklyFlyout:visible .blocklyDraggable").first.wait_for()
    locator_after = page.locator(".blocklyFlyout:visible .blocklyFlyoutBackground")
    assert locator_after.evaluate("e => getComputedStyle(e).fillOpacity") == "1"
    return (page.locator(".blocklyFlyout:visible").text_content() or "").replace("\xa0", " ")


@sampled
def test_the_words_of_the_robot_are_blocks(page: Page, pytestconfig: pytest.Config) -> None:
    for name in sample_of(pytestconfig, "words of robots", robots.names(), 3):
        page.select_option("#robot", name)
        wait_for_blocks(page)
        text = flyout(page, "Robot")
        profile = robots.load(name)
        for device in (*profile.kit.sensors, *profile.kit.actuators):
            assert profile.labels["en"][device.name] in text
        page.keyboard.press("Escape")


def texts_on_blocks(page: Page) -> set[str]:
    """Return the texts on blocks, except for numbers."""
    texts = page.locator(f"{PROGRAM} .blocklyText").all_text_contents()
    return {" ".join(text.split()) for text in texts if not text.isdigit()}


@sampled
def test_blocks_can_show_the_keywords(page: Page) -> None:
    start(page, "SI|LOOP(3)\n  IF(DISTANCE < 20)\n    S\n  ELSE\n    F(1, 80)\n  ENDIF\nEND_LOOP\n")
    assert texts_on_blocks(page) == {
        "when it starts", "repeat", "times", "if", "distance sensor", "<", "stop", "else",
        "forward", "s", "at", "%",
    }  # fmt: skip
    speak(page, "es")
    wait_for_blocks(page)
    assert {"al empezar", "repite", "veces", "si", "si no"} <= texts_on_blocks(page)
    page.click("#words")
    wait_for_blocks(page)
    assert {"SI al empezar", "LOOP repite", "IF si", "ELSE si no", "F avanza"} <= texts_on_blocks(
        page
    )
    speak(page, "en")
    wait_for_blocks(page)
    worded = texts_on_blocks(page)
    assert {"SI when it starts", "IF", "DISTANCE sensor", "S stop", "ELSE"} <= worded
    page.click("#words")
    wait_for_blocks(page)
    assert "stop" in texts_on_blocks(page)


@sampled
def test_a_move_has_a_time_or_a_distance(page: Page) -> None:
    start(page, "SI|F(2, 80);\n")
    for field, choice, block_texts, text in (
        ("s", "cm", {"forward", "cm"}, "F(2 CM, 80)"),
        ("forward", "turn right", {"turn right", "°"}, "R(2 DEG, 80)"),
        ("°", "s", {"turn right", "s"}, "R(2, 80)"),
        ("s", "°", {"turn right", "°"}, "R(2 DEG, 80)"),
    ):
        page.locator(f"{PROGRAM} .blocklyDropdownText", has_text=re.compile(f"^{field}")).click()
        page.locator(".blocklyMenuItem", has_text=re.compile(rf"^{choice}$")).click()
        wait_for_text(page, f"SI|{text}\n")
        assert texts_on_blocks(page) == {"when it starts", "at", "%", *block_texts}


@sampled
def test_the_names_of_the_program_are_blocks_unless_it_is_too_long(page: Page) -> None:
    page.click("#view_text")
    write(page, "S;" * 1600)
    page.click("#view_blocks")
    page.locator("#blocks_note", has_text="too long").wait_for()
    start(page, "SI|SPEED = 5;\nDEF HOP;\n  F(1, SPEED);\nEND_DEF;\nHOP;\n", "usual")
    assert page.inner_text("#blocks_note") == ""
    assert "HOP" in flyout(page, "My words")
    assert "SPEED" in flyout(page, "Variables")
    for number in (2, 3):  # a new word has a name that no other one has
        drag(page, "My words", f"HOP_{number}", None)
        page.locator(".cm-content", has_text=f"DEF HOP_{number}").wait_for()
    wait_until_checked(page)
    assert page.locator("#messages .mistake").count() == 0


# Opens one group after the other and measures how many pixels its lowest block is below the pane,
# and its widest one beyond the side.
LOWEST_SCRIPT = """() => [...document.querySelectorAll('.blocklyToolboxCategory')].map((row) => {
  const { x, y, width, height } = row.getBoundingClientRect();
  const words = document.elementFromPoint(x + width / 2, y + height / 2);
  const press = () => ['pointerdown', 'pointerup'].forEach((type) =>
    words.dispatchEvent(new PointerEvent(type, { bubbles: true, cancelable: true })));
  const open = () => [...document.querySelectorAll('.blocklyFlyout .blocklyDraggable')]
    .filter((block) => block.checkVisibility());
  press();
  if (open().length === 0) press(); // the group was open before
  const boxes = open().map((block) => block.getBoundingClientRect());
  press();
  const { bottom, right } = document.querySelector('#blocks').getBoundingClientRect();
  const below = Math.max(...boxes.map((box) => box.bottom)) - bottom;
  const beside = Math.max(...boxes.map((box) => box.right)) - right;
  return [row.textContent, boxes.length, below, beside, height];
})"""


@pytest.mark.long
def test_no_group_of_the_toolbox_scrolls(page: Page) -> None:
    for screen in SCREENS[:2]:
        page.set_viewport_size({"width": screen[0], "height": screen[1]})
        for name in ("tinibot", "liner", "grabber"):
            page.select_option("#robot", name)
            for level in ("few", "usual", "all"):
                page.select_option("#level", level)
                wait_for_blocks(page)
                rows = page.locator(".blocklyToolbox")
                assert rows.evaluate("e => e.scrollHeight <= e.clientHeight"), (screen, level)
                groups = page.evaluate(LOWEST_SCRIPT)
                assert len(groups) > 3
                for words, count, hidden_px, _, height in groups:
                    assert count and hidden_px <= 1 and height >= 40, (screen, name, level, words)


@pytest.mark.long
@pytest.mark.parametrize("screen", SCREENS[:3])
def test_no_block_of_the_toolbox_is_cut(pages: Pages, screen: tuple[int, int]) -> None:
    width, height = screen
    page = pages.open(view="blocks", viewport={"width": width, "height": height})
    page.select_option("#level", "all")
    for language in languages():
        speak(page, language)
        for name in robots.names():
            page.select_option("#robot", name)
            wait_for_blocks(page)
            for words, _, hidden_px, overhang, _ in page.evaluate(LOWEST_SCRIPT):
                assert hidden_px <= 1 and overhang <= 1, (language, name, words)


def test_every_word_that_has_a_block_can_be_dragged_out(
    page: Page, pytestconfig: pytest.Config
) -> None:
    """This includes starting blocks with several parts. A grey block is unreadable text."""
    kinds = set(KINDS) - {"grey"} - ({"plain"} if not PLAIN_TEXTS else set())
    with_names = "SI|SPEED = 5;\nDEF HOP;\n  F(1, SPEED);\nEND_DEF;\nHOP;\n"
    page.select_option("#robot", "grabber")
    start(page, with_names, "all")
    assert list_offered_blocks(page) == kinds
    for word in (name for name, entry in WORDS.items() if entry.role.name != "later"):
        assert (
            kinds_in(read_blocks(program_with_word(word), robots.load("grabber").kit)) <= kinds
        ), word
    for name in sample_of(pytestconfig, "toolboxes", robots.names(), 2):
        page.select_option("#robot", name)
        start(page, with_names, "all")
        has_actuators = bool(robots.load(name).kit.actuators)
        assert list_offered_blocks(page) == kinds - (set() if has_actuators else {"set"}), name
        page.select_option("#level", "few")
        assert {"when", "task"} <= list_offered_blocks(page), name


def test_a_lesson_offers_its_words_while_it_is_open(
    pages: Pages, pytestconfig: pytest.Config
) -> None:
    """A beginner gets enough blocks for one of the lesson's answers. Blocks of other lessons
    stay.
    """
    page = pages.open(view="blocks")
    page.locator("#level").wait_for()
    offered_before = list_offered_blocks(page)
    assert page.input_value("#level") == "few" and "show" not in offered_before
    page.click("#side_lessons")
    page.locator("#lesson:enabled").wait_for()
    folders = catalogue.folders()
    few_before = offered_before
    for folder in sample_of(pytestconfig, "offers", folders, 4):
        number, lesson = folders.index(folder) + 1, catalogue.load(folder)
        kit = robots.load(lesson.robot).kit
        page.select_option("#lesson", str(number))
        page.locator(f"#lesson_page[data-lesson='{number}']").wait_for()
        page.locator("#lesson:enabled").wait_for()
        words = list_offered_blocks(page)
        assert few_before - {"set"} <= words, number  # the robot may have no actuator to switch
        few_before = set(words)
        words |= {"call"} if "def" in words else set()  # a word defined by the pupil
        answers = [
            kinds_in(read_blocks(answer.program, kit)) for answer in catalogue.answers(folder)[0]
        ]
        assert any(kinds <= words for kinds in answers), (number, answers, words)
    page.select_option("#lesson", "1")
    page.locator("#lesson_page[data-lesson='1']").wait_for()
    assert list_offered_blocks(page) - {"set"} == few_before - {"set"}
    page.click("#view_text")
    page.select_option("#lesson", "6")
    page.locator("#lesson_page[data-lesson='6']").wait_for()
    page.click("#view_blocks")
    assert "show" in list_offered_blocks(page)
    speak(page, "es")
    wait_for_blocks(page)
    page.locator("#lesson_page[data-lesson='6']").wait_for()
    assert "show" in list_offered_blocks(page)


@pytest.mark.long
def test_a_condition_dragged_out_checks_the_distance(page: Page) -> None:
    """If the robot can measure it: in the first world it stops before the wall."""
    for robot in robots.names():
        page.select_option("#robot", robot)
        asks_distance = "DISTANCE" in robots.load(robot).kit.names
        for group, words in (
            ("Move", "or until"), ("Wait", "or until"), ("Repeat", "while"), ("Decide", "if"),
            ("Events", "each time"),
        ):  # fmt: skip
            start(page, "SI|S;\n", "usual")
            drag(page, group, words, block(page, "stop"))
            wait_for_other_text(page, "SI|S;\n")
            question = "DISTANCE > 20" if words == "while" else "DISTANCE < 20"
            assert (question in text_of(page)) == asks_distance, (robot, words, text_of(page))
            assert not [
                message for message in check(text_of(page), robot) if message.severity == "mistake"
            ]
    page.select_option("#robot", "tinibot")
    page.select_option("#world", "obstacles")
    start(page, "SI|S;\n", "usual")
    drag(page, "Move", "or until", block(page, "stop"))
    wait_for_text(page, "SI|S;\nF(5, 60) UNTIL(DISTANCE < 20);\n")
    page.select_option("#speed", "20")
    page.click("#run")
    wait_for_phase(page, "ended")
    assert page.locator("#values div", has_text="Collisions").inner_text().split()[-1] == "0"


@sampled
def test_switchable_devices_have_a_yes_no_choice(page: Page) -> None:
    """Dragged out, chosen later, and back; a number stays where it still fits."""
    page.select_option("#robot", "grabber")
    start(page, "SI|S;\n")
    drag(page, "Robot", "lamp", block(page, "stop"))
    wait_for_text(page, "SI|S;\nLED(TRUE);\n")
    for device, text in (("gripper", "GRIPPER(0)"), ("lamp", "LED(TRUE)")):
        page.locator(f"{PROGRAM} .blocklyDropdownText", has_text=re.compile("lamp|gripper")).click()
        page.locator(".blocklyMenuItem", has_text=device).click()
        wait_for_text(page, f"SI|S;\n{text};\n")
    start(page, "SI|LED(0);\n")  # text stays unchanged, and the compiler reports its mistakes
    assert text_of(page) == "SI|LED(0);\n"
    assert page.locator(f"{PROGRAM} .wrong").count() == 1


@sampled
def test_a_hat_block_cannot_be_nested_or_stacked(page: Page) -> None:
    page.select_option("#robot", "tinibot32")
    for group, words, hat_text in (
        ("Events", "each time", "WHEN(DISTANCE < 20);\nEND_WHEN;\n"),
        ("Events", "at the same time", "TASK;\nEND_TASK;\n"),
        ("My words", "new word", "DEF HOP;\nEND_DEF;\n"),
    ):
        start(page, "SI|LOOP(3);\nEND_LOOP;\n", "usual")
        loop = block(page, "repeat")
        y_offset = 20 - round(box_of(loop)["height"])
        drag(page, group, words, loop, off=(12, y_offset))
        wait_for_other_text(page, "SI|LOOP(3);\nEND_LOOP;\n")
        loops = "LOOP(3);\nEND_LOOP;\n"
        wait_for_text(
            page, f"SI|{hat_text}{loops}" if hat_text.startswith("DEF") else f"SI|{loops}{hat_text}"
        )
        hat, program = box_of(block(page, words)), box_of(block(page, "repeat"))
        assert hat["y"] > program["bottom"] or hat["x"] > program["right"], (words, hat, program)


@sampled
def test_hat_blocks_are_written_from_top_to_bottom_after_a_move(page: Page) -> None:
    first_hat, second_hat = (f"WHEN(DISTANCE < {n});\n  W(3);\nEND_WHEN;\n" for n in (10, 20))
    text = f"SI|S;\nDEF SPIN;\n  L(1, 50);\nEND_DEF;\nW(2);\nSPIN;\n{first_hat}{second_hat}"
    start(page, text, "usual")
    assert text_of(page) == text
    drag(page, "Move", "back", block(page, "stop"))
    moved_text = text.replace("W(2);\n", "B(2, 80);\nW(2);\n")
    wait_for_text(page, moved_text)  # a hat that was not moved stays after its block
    upper, last_hat = (
        page.locator(f"{PROGRAM} > .blocklyDraggable", has_text=text) for text in ("10", "20")
    )
    box, upper_box = box_of(last_hat), box_of(upper)
    page.mouse.move(box["x"] + 12, box["y"] + 16)
    page.mouse.down()
    page.mouse.move(box["right"] + 24, upper_box["y"] - 40, steps=8)
    page.mouse.up()
    moved = moved_text.replace(first_hat + second_hat, second_hat + first_hat)
    wait_for_text(page, moved)
    place = box_of(last_hat)
    assert place["x"] > upper_box["right"] and place["y"] < upper_box["y"]
    page.click("#undo")
    wait_for_text(page, moved_text)
    page.click("#redo")
    wait_for_text(page, moved)
    assert box_of(last_hat)["x"] == pytest.approx(place["x"], abs=1)


@sampled
def test_a_restored_hat_block_is_placed_in_view(page: Page) -> None:
    """An existing hat stays if somebody put it, even out of sight."""
    word = "SI|DEF HOP;\n  F(1, 50);\nEND_DEF;\nHOP;\n"

    def end() -> float:
        pane: float = page.locator("#blocks").evaluate("e => e.getBoundingClientRect().bottom")
        return pane

    start(page, word, "usual")
    hat = page.locator(f"{PROGRAM} > .blocklyDraggable", has_text="new word")
    box = box_of(hat)
    page.mouse.move(box["x"] + 8, box["y"] + 24)
    page.mouse.down()
    page.mouse.move(box["x"] + 8, end() - 60, steps=8)
    page.mouse.up()
    assert text_of(page) == word
    place = box_of(hat)["bottom"]
    page.set_viewport_size({"width": 1366, "height": 600})
    start(page, f"{word}S;\n", "usual")
    assert box_of(hat)["bottom"] == pytest.approx(place, abs=1) and place > end()
    start(page, "SI|S;\n", "usual")
    start(page, word, "usual")
    assert box_of(hat)["bottom"] < end()


NUMBERS = """all => all.map((field, k) => ({field, k, box: field.getBoundingClientRect()}))
  .map(({field, k, box}) => {
    const top = field.closest('.blocklyBlockCanvas > *');
    return [/when\\s+it\\s+starts/.test(top.textContent) ? 0 : 1, box.y, box.x, k];
  })
  .sort((a, b) => a[0] - b[0] || Math.round(a[1] - b[1]) || a[2] - b[2]).map((row) => row[3])"""


def numbers_of(page: Page) -> list[int]:
    """Return the fields of numbers as a person reads them: the program's, then those of hats."""
    values: list[int] = page.locator(f"{PROGRAM} .blocklyNumberField").evaluate_all(NUMBERS)
    return values


# The dragged blocks with their targets, and the numbers typed: the first one is number 0.
BLOCKS_BY_LESSON = {
    13: ([("Repeat", "forever", "when it starts", "below"), ("Move", "forward", "forever", "in"),
          ("Events", "each time", "forever", "below"), ("Move", "turn right", "each time", "below"),
          ("Move", "back", "each time", "below")],
         {1: "60", 2: "30", 3: "0.4", 4: "60"}),
    14: ([("Move", "forward", "when it starts", "below"), ("Move", "turn left", "forward", "below"),
          ("Move", "forward", "turn left", "below"), ("Events", "same time", "forward", "below"),
          ("Repeat", "times", "same time", "below"), ("Wait", "wait", "times", "in"),
          ("Robot", "lamp", "times", "in"), ("Wait", "wait", "times", "in"),
          ("Robot", "lamp", "times", "in")],
         {0: "5", 1: "60", 2: "0.51", 4: "3.33", 5: "60", 6: "15", 7: "0.3", 8: "0.3"}),
}  # fmt: skip


@pytest.mark.long
@pytest.mark.sampled("number")
@pytest.mark.parametrize("number", BLOCKS_BY_LESSON)
def test_a_lesson_about_tasks_can_be_solved_with_blocks(pages: Pages, number: int) -> None:
    """A beginner can do it by dragging."""
    page = pages.open(view="blocks", viewport={"width": 1366, "height": 900})
    page.locator("#level").wait_for()
    page.click("#side_lessons")
    page.locator("#lesson:enabled").wait_for()
    page.select_option("#lesson", str(number))
    page.locator(f"#lesson_page[data-lesson='{number}']").wait_for()
    page.locator("#lesson_steps button").last.click()
    start(page, "SI|")
    dragged, numbers = BLOCKS_BY_LESSON[number]
    for group, words, target, place in dragged:
        text_before, target_block = text_of(page), block(page, target)
        y_offset = 40 - round(box_of(target_block)["height"])
        drag(page, group, words, target_block, off=(12, y_offset) if place == "in" else (0, 0))
        wait_for_other_text(page, text_before)
    if number == 14:  # every second time the lamp goes out
        page.locator(f"{PROGRAM} .blocklyDropdownText", has_text="yes").last.click()
        page.locator(".blocklyMenuItem", has_text="no").click()
    for k, typed_text in numbers.items():
        page.locator(f"{PROGRAM} .blocklyNumberField").nth(numbers_of(page)[k]).click()
        page.keyboard.press("Control+a")
        page.keyboard.type(typed_text)
        page.keyboard.press("Enter")
        page.locator(".blocklyWidgetDiv input").wait_for(state="detached")
        wait_for_blocks(page)
    page.select_option("#speed", "20")
    page.click("#lesson_check")
    page.locator("#lesson_said[data-verdict]").wait_for(timeout=240_000)
    assert page.locator("#lesson_said").get_attribute("data-verdict") == "passed", text_of(page)


@sampled
def test_an_if_block_can_get_more_branches(page: Page) -> None:
    start(page, "SI|IF(DISTANCE < 10);\n  S;\nENDIF;\n")
    for name, expected_text in (
        ("Add a case", "IF(DISTANCE < 10);\n  S;\nELSE;\nENDIF;\n"),
        ("Add a case", "IF(DISTANCE < 10);\n  S;\nELSEIF(TRUE);\nELSE;\nENDIF;\n"),
        ("Remove the last case", "IF(DISTANCE < 10);\n  S;\nELSE;\nENDIF;\n"),
    ):
        href = "more.svg" if name.startswith("Add") else "less.svg"
        page.locator(f"#blocks .blocklyBlockCanvas image[*|href$='{href}']").first.click()
        page.locator("#blocks[data-state=shown]").wait_for()
        wait_for_text(page, f"SI|{expected_text}")


@sampled
def test_the_calls_of_a_word_follow_its_values(page: Page) -> None:
    start(page, "SI|DEF HOP(A);\n  F(A, 50);\n  A = A + 1;\nEND_DEF;\nHOP(2);\nHOP(3);\n", "usual")
    canvas = page.locator("#blocks .blocklyBlockCanvas")
    canvas.locator("image[*|href$='more.svg']").first.click()
    page.locator("#blocks[data-state=shown]").wait_for()
    hop_text = (
        "SI|DEF HOP({}, C);\n  F({}, 50);\n  {} = {} + 1;\nEND_DEF;\nHOP(2, 1);\nHOP(3, 1);\n"
    )
    wait_for_text(page, hop_text.format(*"AAAA"))
    canvas.locator(".blocklyEditableField", has_text=re.compile("^A$")).last.click()
    page.keyboard.type("size")
    page.keyboard.press("Enter")
    wait_for_text(page, hop_text.format(*["SIZE"] * 4))
    texts = {text.strip() for text in canvas.locator(".blocklyText").all_text_contents()}
    assert {"SIZE", "C"} <= texts
    body = "  F(SIZE, 50);\n  SIZE = SIZE + 1;\nEND_DEF;\n"
    for head, calls in (("HOP(SIZE)", "HOP(2);\nHOP(3);\n"), ("HOP", "HOP;\nHOP;\n")):
        canvas.locator("image[*|href$='less.svg']").first.click()
        page.locator("#blocks[data-state=shown]").wait_for()
        wait_for_text(page, f"SI|DEF {head};\n{body}{calls}")


@sampled
def test_a_defined_word_has_at_most_the_languages_number_of_values(page: Page) -> None:
    text = "SI|DEF A{};\n  F(1, 50);\nEND_DEF;\n"
    start(page, text.format(""), "usual")
    names = [*"CDEGH"][:PARAMETERS]
    counts = [*range(1, PARAMETERS + 1), PARAMETERS]
    for href, count in [*(("more.svg", count) for count in counts), ("less.svg", PARAMETERS - 1)]:
        page.locator(f"#blocks .blocklyBlockCanvas image[*|href$='{href}']").first.click()
        page.locator("#blocks[data-state=shown]").wait_for()
        wait_for_text(page, text.format(f"({', '.join(names[:count])})"))


def test_a_block_can_be_added_by_keyboard(page: Page) -> None:
    page.locator(".search input").focus()
    page.keyboard.press("Tab")
    page.keyboard.press("t")
    for key in ("ArrowRight", "Enter", "ArrowDown", "Enter"):
        page.keyboard.press(key)
        page.wait_for_timeout(100)  # the delay of fast fingers
    wait_for(page, lambda: text_of(page).count("F(2, 80)") == 2, "another block")


# -- sentences -------------------------------------------------------------------------------------


# things that no page has; names of shortcuts, which only a plugin shows; keys
UNUSED_MESSAGE = re.compile(
    "SHORTCUT|VARIABLE|PROCEDURE|COLLAPSE|EXPAND_|ABLE_BLOCK|(IN|EX)[A-Z]+_INPUTS|MUTATOR|CHECKBOX"
    "|(ADD|REMOVE|DUPLICATE)_COMMENT|ARIA_LABEL_COMMENT|CONTENTS_COMMENTS"
    "|/(UNDO|REDO|HELP|HELP_PROMPT|UNKNOWN|UNNAMED_KEY|ESCAPE)$"
    "|/(PAUSE|CAPS_LOCK|INSERT|TAB|SHIFT|CONTEXT_MENU|SPACE|PAGE_UP|PAGE_DOWN|END|HOME)_KEY"
)


def test_all_blockly_texts_are_in_the_catalogue() -> None:
    """It has all names in Blockly's core except LACKS: the page uses none of Blockly's ready-made
    blocks."""
    need("" if BLOCKLY.is_dir() else unusable_reason() or f"there is no {BLOCKLY}")
    core = (BLOCKLY / "blockly_compressed.js").read_text(encoding="utf-8")
    names = set(re.findall(r"[A-Z][A-Z0-9_]+", core))
    messages = (BLOCKLY / "msg" / "en.js").read_text(encoding="utf-8")
    rows = re.findall(r'^Blockly\.Msg\["(\w+)"\] = ("(?:[^"\\]|\\.)*");$', messages, re.MULTILINE)
    expected_texts = {f"blockly/{name}": json.loads(text) for name, text in rows if name in names}
    texts = page_texts("en")
    blockly_texts = {key: texts[key] for key in texts if key.startswith("blockly/")}
    assert blockly_texts == {
        key: expected_texts[key]
        for key in expected_texts
        if key in blockly_texts or not UNUSED_MESSAGE.search(key)
    }


def test_the_sources_contain_no_emoji_faces() -> None:
    for path in filter(Path.is_file, (ROOT / "tools" / "studio" / "src").rglob("*")):
        assert not re.search("[\U0001f000-\U0001faff]", path.read_text(encoding="utf-8")), path.name


@sampled
def test_a_fault_is_reported_at_its_block(page: Page) -> None:
    start(page, "X = 0;\nSHOW(1 / X);\nS;\n")
    page.select_option("#speed", "20")
    page.click("#run")
    fault = page.locator(f"{PROGRAM} .blocklyDraggable.fault")
    fault.wait_for()
    assert fault.count() == 1 and "show" in str(fault.text_content())
    assert fault.locator(".blocklyIconGroup").count() == 1
    speak(page, "es")
    page.locator("#doing", has_text="“muestra 1 ÷ X”: algo se divide entre 0.").wait_for()
    wait_for_blocks(page)
    fault.wait_for()  # the blocks are others now
    page.click("#view_text")
    write(page, "X = 1;\nSHOW(1 / X);\n")
    page.click("#view_blocks")
    wait_for_blocks(page)
    assert fault.count() == 0 and page.locator(f"{PROGRAM} .blocklyIconGroup").count() == 0


def test_changing_a_block_changes_only_its_line(page: Page) -> None:
    head = "SI|F(1.50, (80));  // first\n\n"
    end = "IF((X) > 2);\n  S;\nELSE;  // else\n  W(2.0);\nENDIF;  // end\n"
    start(page, f"{head}B(1.50, 80);\n{end}")
    block(page, "back").locator(".blocklyNumberField").first.click()
    page.keyboard.press("Control+a")
    page.keyboard.type("3")
    page.keyboard.press("Enter")
    wait_for_text(page, f"{head}B(3, 80);\n{end}")
    block(page, "back").locator(".blocklyNumberField").first.click()
    page.keyboard.press("Control+a")
    page.keyboard.type("1.5")
    page.keyboard.press("Enter")
    wait_for_text(page, f"{head}B(1.50, 80);\n{end}")
