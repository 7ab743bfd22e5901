"""Pupils of a group in browsers, one of them with blocks: an action on blocks changes these blocks
alone.

`python -m tests.studio.test_page_together_blocks 200` lets four make so many changes, two with
blocks and two with text; a folder after it gets a picture of each page.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from random import Random
from typing import TYPE_CHECKING

import pytest

from tests.support import studio
from tests.support.class_pages import (
    class_of_many,
    go_to_line,
    join_class,
    join_group,
    lines,
    type_slowly,
    wait_for_lines,
)
from tests.support.page_blocks import PROGRAM as PROGRAM_BLOCKS
from tests.support.page_blocks import block, box_of, drag
from tests.support.studio import Class, Pages, image, wait_for_blocks, write
from tests.support.waiting import until
from tiniscript import compile

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

sampled = pytest.mark.sampled(of="blocks of groups", keep=2)

PROGRAM = """F(1.50, (80));  // first
LOOP(3);
  B(1, 40);
  R(0.50, 60);
END_LOOP;  // three
S;
"""
ROWS = [row.strip() for row in PROGRAM.splitlines()]


@pytest.fixture(scope="module")
def shared_class(browser: Browser) -> Iterator[Class]:
    with class_of_many() as taught_class:
        yield taught_class


@pytest.fixture(scope="module")
def pages(browser: Browser, shared_class: Class) -> Iterator[Pages]:
    opened_pages = Pages(browser, shared_class.server.address)
    yield opened_pages
    opened_pages.close()
    assert not opened_pages.errors


@pytest.fixture(scope="module")
def loaded_pair(pages: Pages, shared_class: Class) -> tuple[Page, Page]:
    return group_of(pages, shared_class)


def group_of(pages: Pages, class_: Class) -> tuple[Page, Page]:
    """Ana has blocks, Luz has the text."""
    ana = join_class(pages, class_, "Ana")
    write(ana, PROGRAM)
    luz = join_class(pages, class_, "Luz")
    for page in (ana, luz):
        join_group(page)
    ana.set_viewport_size({"width": 1366, "height": 768})
    ana.click("#view_blocks")
    return ana, luz


def others_of(pages: Pages, class_: Class) -> tuple[Page, Page]:
    """Two more of the group: Teo has blocks, Eva the text. It is full."""
    teo, eva = (join_class(pages, class_, name) for name in ("Teo", "Eva"))
    for page in (teo, eva):
        join_group(page)
    teo.set_viewport_size({"width": 1366, "height": 768})
    teo.click("#view_blocks")
    wait_for_blocks(teo)
    return teo, eva


@pytest.fixture
def page_pair(loaded_pair: tuple[Page, Page]) -> tuple[Page, Page]:
    """Both have the program."""
    ana, luz = loaded_pair
    write(luz, PROGRAM)
    luz.locator(".cm-content").evaluate("(it) => it.blur()")
    wait_for_lines(luz, *ROWS)
    until(lambda: text_of(ana) == PROGRAM, "Ana has the program")
    wait_for_blocks(ana)
    return loaded_pair


def text_of(page: Page) -> str:
    text = page.evaluate("JSON.parse(sessionStorage['tiniscript.work']).text")
    return str(text)


def open_field(page: Page, words: str, field_index: int = 0) -> None:
    """Open a field of a block, with nothing in it."""
    page.locator("html").evaluate("() => getSelection().removeAllRanges()")
    block(page, words).locator(".blocklyNumberField").nth(field_index).click()
    page.locator(".blocklyWidgetDiv input").wait_for()
    page.keyboard.press("Control+a")


def check_both_have(two: tuple[Page, Page], *rows: str) -> None:
    """Both have these lines, as text, and compiled; blocks are those of the text."""
    ana, luz = two
    luz.locator(".cm-content").evaluate("(it) => it.blur()")
    wait_for_lines(luz, *rows)
    until(lambda: text_of(ana) == text_of(luz), "both have the same")
    wait_for_blocks(ana)
    for page in two:
        page.locator("html[data-state=checked]").wait_for(state="attached")
        until(lambda page=page: image(page) == compile(text_of(luz)).image, "compiled")  # type: ignore[misc]


def change_power(page: Page, row: str) -> None:
    """Write 95 in place of a power in the text."""
    go_to_line(page, row)
    for _ in range(4):
        page.keyboard.press("Backspace")
    type_slowly(page, "95)")
    page.keyboard.press("ArrowDown")


def change_rows(*pairs: tuple[str, str]) -> list[str]:
    return [dict(pairs).get(row, row) for row in ROWS]


def test_a_changed_field_changes_only_its_line(page_pair: tuple[Page, Page]) -> None:
    ana, _ = page_pair
    open_field(ana, "back")
    type_slowly(ana, "7\n")
    check_both_have(page_pair, *change_rows(("B(1, 40);", "B(7, 40);")))


@sampled
def test_a_half_typed_field_is_not_a_change_and_stays_open(page_pair: tuple[Page, Page]) -> None:
    ana, luz = page_pair
    open_field(ana, "back")
    type_slowly(ana, "6")
    go_to_line(luz, "S;")
    type_slowly(luz, "\nw(2)\n")
    until(lambda: "W(2);" in text_of(ana), "the others' line arrives after a while")
    assert "B(1, 40);" in text_of(luz)
    type_slowly(ana, "5")  # the field is where it was
    assert "B(1, 40);" in text_of(luz)
    ana.keyboard.press("Enter")
    check_both_have(page_pair, *change_rows(("B(1, 40);", "B(65, 40);")), "W(2);")
    block(ana, "wait").wait_for()


@sampled
def test_a_block_dragged_during_remote_edits_lands_in_its_place(
    page_pair: tuple[Page, Page],
) -> None:
    ana, luz = page_pair
    source_box, target = box_of(block(ana, "stop")), box_of(block(ana, "forward"))
    ana.mouse.move(source_box["x"] + 8, source_box["y"] + 10)
    ana.mouse.down()
    ana.mouse.move(source_box["x"] + 60, source_box["y"] + 40, steps=4)
    go_to_line(luz, "B(1, 40)")
    type_slowly(luz, "\nBEEP(1, 440)\n")
    until(lambda: "BEEP" in text_of(ana), "the others' line arrives after a while")
    ana.mouse.move(target["x"] + 10, target["y"] + target["height"] + 8, steps=8)
    ana.mouse.up()
    first_row, loop, end_loop, *rest = ROWS[:-1]
    check_both_have(page_pair, first_row, "S;", loop, end_loop, "BEEP(1, 440);", *rest)


@sampled
def test_the_later_of_two_changes_of_a_block_wins(page_pair: tuple[Page, Page]) -> None:
    ana, luz = page_pair
    open_field(ana, "back")
    type_slowly(ana, "6")
    change_power(luz, "B(1, 40)")
    until(lambda: "B(1, 95);" in text_of(ana), "the others' value arrives")
    ana.keyboard.press("Enter")
    check_both_have(page_pair, *change_rows(("B(1, 40);", "B(6, 40);")))


@sampled
def test_loose_blocks_exist_only_on_the_local_page(page_pair: tuple[Page, Page]) -> None:
    ana, luz = page_pair
    drag(ana, "Move", "left", None)
    go_to_line(luz, "S;")
    type_slowly(luz, "\nw(2)\n")
    until(lambda: "W(2);" in text_of(ana), "the others' line arrives")
    wait_for_blocks(ana)
    assert block(ana, "left").count() == 1
    assert "///" in text_of(ana)
    assert "///" not in text_of(luz)
    loose_box = box_of(block(ana, "left"))
    ana.mouse.move(loose_box["x"] + 8, loose_box["y"] + 10)
    ana.mouse.down()
    target = box_of(block(ana, "wait"))
    ana.mouse.move(target["x"] + 60, target["y"] + 90, steps=4)
    ana.mouse.move(target["x"] + 10, target["y"] + target["height"] + 8, steps=8)
    ana.mouse.up()
    until(lambda: any(row.strip().startswith("L(") for row in lines(luz)), "it is joined")
    luz.locator(".cm-content").evaluate("(it) => it.blur()")
    until(lambda: text_of(ana) == text_of(luz), "both have the same")


@sampled
def test_undo_in_blocks_reverts_the_local_change(page_pair: tuple[Page, Page]) -> None:
    ana, luz = page_pair
    open_field(ana, "back")
    type_slowly(ana, "7\n")
    wait_for_lines(luz, *change_rows(("B(1, 40);", "B(7, 40);")))
    go_to_line(luz, "S;")
    type_slowly(luz, "\nw(2)\n")
    until(lambda: "W(2);" in text_of(ana), "the others' line arrives")
    wait_for_blocks(ana)
    ana.locator("#speed").focus()
    ana.keyboard.press("Control+z")
    check_both_have(page_pair, *ROWS, "W(2);")
    ana.click("#redo")
    check_both_have(page_pair, *change_rows(("B(1, 40);", "B(7, 40);")), "W(2);")
    change_power(luz, "B(7, 40)")
    until(lambda: "B(7, 95);" in text_of(ana), "the others' value arrives")
    wait_for_blocks(ana)
    ana.click("#undo")  # his block has a new owner
    check_both_have(page_pair, *change_rows(("B(1, 40);", "B(7, 95);")), "W(2);")


@sampled
def test_each_pupil_sees_the_others_block(page_pair: tuple[Page, Page]) -> None:
    ana, luz = page_pair
    go_to_line(luz, "B(1, 40)")
    mark = block(ana, "back").locator("> .mate_mark")
    mark.filter(has_text="Luz").wait_for()
    type_slowly(luz, " ")
    mark.filter(has_text="Luz …").wait_for()
    luz.keyboard.press("ArrowDown")
    block(ana, "right").locator("> .mate_mark").filter(has_text="Luz").wait_for()
    assert mark.count() == 0
    block(ana, "stop").click(position={"x": 6, "y": 6})
    name = luz.locator(".cm-line", has_text="S;").locator(".cm-mate")
    name.filter(has_text="Ana").wait_for()


def random_change(page: Page, has_blocks: bool, rng: Random) -> bool:
    """Do something as a person does it: in blocks to a number, in text to a line. Return whether
    it was still there."""
    from playwright.sync_api import Error

    if has_blocks:
        number_fields = page.locator(f"{PROGRAM_BLOCKS} .blocklyNumberField")
        field_index = rng.randrange(max(1, number_fields.count()))
        try:
            number_fields.nth(field_index).click(timeout=3000)
        except Error:  # others have taken it away meanwhile
            return False
        page.keyboard.press("Control+a")
        type_slowly(page, f"{rng.randrange(1, 60)}\n")
        return True
    rows = [row for row in lines(page) if row.strip()]
    row = rng.choice(rows)
    line = page.locator(".cm-line").filter(has_text=row.strip()).first
    try:
        line.click(timeout=3000)
    except Error:  # others have changed it meanwhile
        return False
    page.keyboard.press("End")
    if rng.random() < 0.3 and len(rows) > 5 and not row.strip().startswith(("LOOP", "END_")):
        for key in ("Home", "Shift+End", "Delete"):
            page.keyboard.press(key)
    else:
        type_slowly(page, f"\n{rng.choice('FBRL')}({rng.randrange(1, 9)}, {rng.randrange(20, 99)})")
    page.keyboard.press("ArrowUp")
    return True


def race(members: Sequence[Page], count: int, seed: int) -> None:
    """Let all members make changes, and check that they end with one program; every other one uses
    blocks.
    """
    with_blocks, with_text = members[::2], members[1::2]
    rng = Random(seed)
    change_count = tries = 0
    while change_count < count:  # a click may be late, after others have changed its target
        assert tries < 10 * count
        tries += 1
        page = rng.choice(members)
        change_count += random_change(page, page in with_blocks, rng)
    for page in with_text:
        page.locator(".cm-content").evaluate("(it) => it.blur()")
    until(lambda: len({text_of(page).strip() for page in members}) == 1, "all have the same", 60)
    text = text_of(with_text[0])
    for page in members:
        page.locator("html[data-state=checked]").wait_for(state="attached")
        until(lambda page=page: image(page) == compile(text).image, "compiled")  # type: ignore[misc]
    for page in with_blocks:
        wait_for_blocks(page)
        block_count = page.locator(f"{PROGRAM_BLOCKS} .blocklyBlock").count()
        assert block_count >= len([row for row in text.splitlines() if row and "END_" not in row])


def test_two_pages_end_with_the_same_program(page_pair: tuple[Page, Page]) -> None:
    race(page_pair, 12, 1)


@pytest.mark.long
def test_four_pages_end_with_the_same_program(
    page_pair: tuple[Page, Page], pages: Pages, shared_class: Class
) -> None:
    other_pages = others_of(pages, shared_class)
    race((*page_pair, *other_pages), 16, 2)
    for page in other_pages:
        page.click("[data-text=group_leave]")
        page.locator("[data-text=group_join]").wait_for()


def main() -> None:
    """Let pupils make so many changes in four browsers: 200, say."""
    count = int(sys.argv[1])
    with (
        class_of_many() as taught_class,
        studio.driver() as playwright,
        studio.browser(playwright) as browser,
    ):
        opened_pages = Pages(browser, taught_class.server.address)
        members = (*group_of(opened_pages, taught_class), *others_of(opened_pages, taught_class))
        for k in range(count // 20):
            race(members, 20, k)
            print(f"{20 * (k + 1)} changes: text, blocks and image are one", flush=True)
        for page, name in zip(members, ("ana", "luz", "teo", "eva"), strict=True):
            if len(sys.argv) > 2:
                page.screenshot(path=f"{sys.argv[2]}/{name}.png")
        opened_pages.close()
        assert not opened_pages.errors


if __name__ == "__main__":
    main()
