"""A lesson provides the blocks that it teaches, and matches the pupil's form: blocks or text."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest

from tests.support.page_blocks import drag, list_offered_blocks, start
from tests.support.sampling import sample_of
from tests.support.studio import SETTLED_SCRIPT, Pages, axe, speak, wait_for_blocks
from tests.support.text_only_words import has_line_on_floor, text_only_words
from tiniscript.base.words import WORDS
from tiniscript.lessons import catalogue
from tiniscript.studio import page_lessons
from tiniscript.studio.block_kinds import KINDS, piece_of

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = pytest.mark.sampled(files="sides of the page", keep=3)
sampled = pytest.mark.sampled(of="blocks of lessons", keep=1)

LESSONS = range(1, len(catalogue.folders()) + 1)
LEVELS = ["few", "usual", "all"]
FRESH_CATEGORY = ".blocklyToolboxCategory.fresh"


@pytest.fixture
def page(pages: Pages) -> Page:
    page = pages.open(view="blocks")
    page.click("#side_lessons")
    page.locator("#lesson:enabled").wait_for()
    return page


def open_lesson(page: Page, number: int, step: int = 0) -> None:
    page.select_option("#lesson", str(number))
    page.locator(f"#lesson_page[data-lesson='{number}']").wait_for()
    page.locator("#lesson:enabled").wait_for()
    page.locator("#lesson_steps button").nth(step).click()


@pytest.mark.parametrize("language", ["en", "es", "pt"])
def test_each_kind_of_block_is_introduced_by_the_first_lesson_that_names_it(language: str) -> None:
    """Each lesson has a block to look for; no later lesson removes a block."""
    taught_words: set[str] = set()
    for number in LESSONS:
        known_kinds, new_kinds = (
            f(number, language) for f in (page_lessons.taught_kinds, page_lessons.new_pieces)
        )
        kinds = {piece.partition(" ")[0] for piece in new_kinds}
        assert new_kinds and kinds <= set(known_kinds)
        assert set(known_kinds) - taught_words <= kinds
        assert set(page_lessons.needed_kinds(number, language)) <= set(known_kinds) <= KINDS.keys()
        taught_words |= set(known_kinds)
        assert set(page_lessons.offered_kinds(number, language)) == taught_words


def test_similar_blocks_count_as_one_piece() -> None:
    assert piece_of("move", "L DEG") == "move L"
    assert piece_of("sensor", "KEY_A") == piece_of("sensor", "KEY_UP") == "sensor KEY"
    assert piece_of("sensor", "BUTTON") == "sensor BUTTON"
    assert piece_of("compare", "LT") == "compare"


def test_the_level_rises_to_a_lessons_needs_and_never_falls(
    page: Page, pytestconfig: pytest.Config
) -> None:
    """Each kind that it needs is there without the lesson, one level below some are missing. A page
    that has more keeps it, even after a reload."""
    kinds: dict[str, set[str]] = {}
    for level in LEVELS:
        page.select_option("#level", level)
        kinds[level] = list_offered_blocks(page)
    page.select_option("#level", "few")
    level = "few"
    for number in sample_of(pytestconfig, "levels of lessons", LESSONS, 4):
        open_lesson(page, number)
        needed_names = set(page_lessons.needed_kinds(number, "en")) & kinds["all"]
        needed_level = next(level for level in LEVELS if needed_names <= kinds[level] | {"set"})
        level = max(level, needed_level, key=LEVELS.index)
        assert page.input_value("#level") == level, number
    page.select_option("#level", "few")
    open_lesson(page, 1)
    assert page.input_value("#level") == "few"
    open_lesson(page, 5)
    open_lesson(page, 1)
    assert page.input_value("#level") == "usual"
    page.reload()
    page.locator("#lesson").wait_for(state="attached")
    assert page.input_value("#level") == "usual"


def test_each_lesson_highlights_a_block_at_the_first_visit(page: Page) -> None:
    for number in LESSONS:
        open_lesson(page, number)
        page.locator(FRESH_CATEGORY).first.wait_for()
        page.locator(FRESH_CATEGORY).first.click()
        page.locator(".blocklyFlyout:visible .blocklyBlockCanvas > .fresh").first.wait_for()


def test_a_lesson_removes_no_block(page: Page) -> None:
    """The best solution of lesson 13 uses a block of lesson 7."""
    open_lesson(page, 13)
    page.select_option("#level", "few")
    assert "endless" in list_offered_blocks(page)


@sampled
def test_a_new_block_is_highlighted_until_it_is_used(page: Page) -> None:
    start(page, "SI|F(1, 80);\n")
    open_lesson(page, 6)
    locator = page.locator(FRESH_CATEGORY)
    assert locator.all_inner_texts() == ["Wait, sound", "Robot"]
    locator.first.click()
    glowing = page.locator(".blocklyFlyout:visible .blocklyBlockCanvas > .fresh")
    assert "show" in (glowing.text_content() or "")
    assert axe(page) == []
    page.keyboard.press("Escape")
    drag(
        page, "Wait, sound", "show", page.locator("#blocks .blocklyBlock", has_text="forward").last
    )
    page.locator("#blocks[data-state=shown]").wait_for()
    locator.filter(has_text="Wait").wait_for(state="detached")
    assert locator.all_inner_texts() == ["Robot"]
    open_lesson(page, 7)
    open_lesson(page, 6)
    assert locator.all_inner_texts() == ["Robot"]


@sampled
def test_the_highlight_respects_reduced_motion(pages: Pages) -> None:
    page = pages.open(view="blocks", reduced_motion="reduce")
    page.click("#side_lessons")
    page.locator("#lesson:enabled").wait_for()
    open_lesson(page, 4)
    page.locator(FRESH_CATEGORY).click()
    path = page.locator(".blocklyFlyout:visible .blocklyBlockCanvas > .fresh > .blocklyPath").first
    assert path.evaluate("e => getComputedStyle(e).animationName") == "none"


@sampled
def test_a_lesson_matches_its_readers_blocks_or_text(page: Page) -> None:
    """Its programs are drawn, and its words are those on blocks, while blocks are seen; a screen
    reader has the text of both."""
    for language, label, word in (
        ("en", "repeat 4 times", "LOOP repeat 4 times"),
        ("es", "repite 4 veces", "LOOP repite 4 veces"),
    ):
        speak(page, language)
        wait_for_blocks(page)
        open_lesson(page, 4, 1)
        named_element = page.locator("#lesson_step .on_block")
        named_element.filter(has_text=re.compile(f"^{label}$")).wait_for()
        program = page.locator("#lesson_step .program")
        program.locator("img").wait_for()
        assert program.locator("pre.heard").text_content() == (
            "SI|LOOP(4)\n  F(1, 60)\n  L(0.42, 60)\nEND_LOOP"
        )
        assert axe(page) == []
        page.click("#words")
        named_element.filter(has_text=re.compile(f"^{word}$")).wait_for()
        page.click("#words")
        page.click("#view_text")
        assert named_element.count() == program.locator("img").count() == 0
        assert program.locator("pre:not(.heard)").is_visible()
        assert page.locator("#lesson_step code").first.inner_text() == "LOOP(4)"
        page.click("#view_blocks")
        program.locator("img").wait_for()
    program.locator("button").click()
    page.locator("#blocks .blocklyBlock", has_text="repite").first.wait_for()


# The text of a step, and its code that is not on a block.
READ_STEP_SCRIPT = """() => {
  const page = document.querySelector('#lessons').cloneNode(true);
  for (const each of page.querySelectorAll('.program, #lesson')) each.remove();
  const codes = [...page.querySelectorAll('code')].map((each) => each.textContent);
  const onBlocks = [...page.querySelectorAll('.on_block')].map((each) => each.textContent);
  for (const each of page.querySelectorAll('code, .on_block')) each.replaceWith('``');
  const names = [...document.querySelectorAll('#lesson option')].map((each) => each.textContent);
  return [page.textContent, codes, onBlocks, names.join('; ')];
}"""
# Labels left over from a place of the table, an empty text, a call or the end of a line in a text.
NO_LABEL = re.compile(r"%\d|\{|undefined|\w\(|;|\bEND|^\s*$")


@pytest.mark.sampled("language")
@pytest.mark.parametrize("language", ["en", "es", "pt"])
def test_lessons_use_the_texts_of_the_blocks(
    page: Page, language: str, pytestconfig: pytest.Config
) -> None:
    """It contains no program text, except for names that a program defines."""
    speak(page, language)
    wait_for_blocks(page)
    count = 0
    lessons = sample_of(pytestconfig, "words of lessons", LESSONS, 4)
    for number in lessons:
        open_lesson(page, number)
        is_line_on_floor = has_line_on_floor(number)
        for k in range(page.locator("#lesson_steps button").count()):
            page.locator("#lesson_steps button").nth(k).click()
            texts, codes, on_blocks, names = page.evaluate(READ_STEP_SCRIPT)
            assert text_only_words(texts, language, is_line_on_floor=is_line_on_floor) == []
            assert text_only_words(names, language, is_line_on_floor=True) == []
            assert not [code for code in codes if code in WORDS or not code.isidentifier()], codes
            assert not [row for row in on_blocks if NO_LABEL.search(row)], on_blocks
            count += len(on_blocks)
    assert count > len(lessons)


@pytest.mark.sampled("language")
@pytest.mark.parametrize("language", ["en", "es"])
def test_findings_match_their_readers_blocks_or_text(page: Page, language: str) -> None:
    speak(page, language)
    start(page, "SI|W(1)\n")
    open_lesson(page, 1)
    page.locator("#lesson_steps button").last.click()
    page.click("#lesson_check")
    page.locator("#lesson_said[data-verdict=failed]").wait_for()
    finding = page.locator("#lesson_findings li")
    assert "F(2, 80)" not in finding.inner_text()
    assert finding.locator(".on_block").inner_text() == (
        "forward 2 s at 80 %" if language == "en" else "avanza 2 s al 80 %"
    )
    page.click("#view_text")
    assert "F(2, 80)" in finding.inner_text() and "`" not in finding.inner_text()
    page.click("#view_blocks")
    assert finding.locator(".on_block").count() == 1


@pytest.mark.long
@pytest.mark.sampled("size")
@pytest.mark.parametrize("size", [(1366, 768), (1024, 600), (390, 844)], ids=str)
def test_a_shadow_indicates_more_text_below(page: Page, size: tuple[int, int]) -> None:
    page.set_viewport_size({"width": size[0], "height": size[1]})
    page.evaluate(SETTLED_SCRIPT)
    if page.locator("html[data-phone]").count():
        page.click("#other")
    for number in (1, 7, 13):
        open_lesson(page, number, 0 if number == 1 else 1)
        place = page.locator("#lesson_page")
        for _ in range(2):
            page.evaluate(SETTLED_SCRIPT)
            hidden_px = place.evaluate("e => e.scrollHeight - e.clientHeight - e.scrollTop")
            page.locator(f"#lesson_page{'.more' if hidden_px >= 4 else ':not(.more)'}").wait_for()
            place.evaluate("e => e.scrollTo(0, e.scrollHeight)")
