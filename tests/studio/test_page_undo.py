"""A single undo for the program's text and the places of its blocks."""

from __future__ import annotations

import random
from typing import TYPE_CHECKING, Any

import pytest

from tests.support.page_blocks import PROGRAM, block, box_of, drag, start, text_of, wait_for_text
from tests.support.studio import SETTLED_SCRIPT, Pages, speak, wait_for, wait_for_blocks, write

if TYPE_CHECKING:
    from collections.abc import Callable

    from playwright.sync_api import Page

# The content of each stack, with its parts in any order, and its place relative to the program.
STACKS = """all => {
  const boxes = all.map((each) => [each.textContent, each.querySelector('.blocklyPath')
    .getBoundingClientRect()]);
  const [, own] = boxes.find(([said]) => /when\\s+it\\s+starts/.test(said));
  return boxes.map(([said, { x, y }]) => [[...said].sort().join(''), x - own.x, y - own.y])
    .map(([said, x, y]) => [said, Math.round(x), Math.round(y)]).sort();
}"""
# One hat at most: those that nobody has moved are lined up anew whenever a text is typed.
PROGRAMS = (
    "SI|F(2, 80);\nS;\n",
    "SI|F(2, 80);\nWHEN(DISTANCE < 20);\n  B(1, 60);\nEND_WHEN;\n",
    "SI|DEF HOP;\n  F(1, 50);\nEND_DEF;\nHOP;\n\n/// W(2)\n",
)
BlocksState = tuple[str, list[Any]]


@pytest.fixture
def page(only_page: tuple[Pages, Page]) -> Any:
    pages, current_page = only_page
    current_page.bring_to_front()
    current_page.set_viewport_size({"width": 1366, "height": 768})
    speak(current_page, "en")
    yield current_page
    errors, pages.errors[:] = pages.errors[:], []
    assert not errors


def state_of(page: Page) -> BlocksState:
    page.evaluate(SETTLED_SCRIPT)  # Blockly reports a change a moment later
    text = text_of(page)
    return text, page.locator(f"{PROGRAM} > .blocklyBlock").evaluate_all(STACKS)


def wait_for_state(page: Page, expected_state: BlocksState) -> None:
    wait_for(page, lambda: state_of(page) == expected_state, str(expected_state))


def move(page: Page, words: str, target: tuple[float, float]) -> None:
    box = box_of(block(page, words))
    page.mouse.move(box["x"] + 8, box["y"] + 20)
    page.mouse.down()
    page.mouse.move(*target, steps=6)
    page.mouse.up()
    page.locator("#blocks[data-state=shown]").wait_for()


def _move_block(page: Page, rng: random.Random) -> None:
    """A hat, or a loose stack, to an empty place at the right."""
    words = [word for word in ("same time", "each time", "new word", "wait")
             if block(page, word).count()]  # fmt: skip
    if words:
        move(page, rng.choice(words), (rng.randint(480, 560), rng.randint(330, 560)))


def _add_block(page: Page, rng: random.Random) -> None:
    drag(page, *rng.choice((("Events", "same time"), ("Events", "each time"), ("Move", "back"))),
         None)  # fmt: skip


def _type_text(page: Page, rng: random.Random) -> None:
    text = text_of(page)
    page.click("#view_text")
    write(page, text.replace("SI|", f"SI|W({rng.randint(1, 9)});\n"))
    page.click("#view_blocks")


ACTIONS: tuple[Callable[[Page, random.Random], None], ...] = (
    _move_block,
    _move_block,
    _add_block,
    _type_text,
)


@pytest.mark.sampled("seed", keep=2)
@pytest.mark.parametrize("seed", range(12))
def test_each_undo_restores_the_text_and_every_position(page: Page, seed: int) -> None:
    """Each redo does the same, even if only the text or a place had changed."""
    rng = random.Random(seed)
    page.select_option("#robot", "tinibot32")
    start(page, rng.choice(PROGRAMS), "usual")
    past_states = [state_of(page)]
    for act in (_move_block, *rng.choices(ACTIONS, k=5)):
        act(page, rng)
        if (state := state_of(page)) != past_states[-1]:
            past_states.append(state)
    for expected_state in past_states[-2::-1]:
        page.click("#undo")
        wait_for_state(page, expected_state)
    for expected_state in past_states[1:]:
        page.click("#redo")
        wait_for_state(page, expected_state)


def test_undo_moves_a_hat_block_back(page: Page) -> None:
    """After it was dragged in, or the program was written as text: in the blocks and by the key."""
    start(page, "SI|F(2, 80);\n")
    drag(page, "Events", "each time", None)
    text = "SI|F(2, 80);\nWHEN(DISTANCE < 20);\nEND_WHEN;\n"
    wait_for_text(page, text)
    for trigger in ("dragged", "written"):
        if trigger == "written":
            start(page, text)
        state_before = state_of(page)
        move(page, "each time", (520, 560))
        state_after = state_of(page)
        assert state_after[0] == text and state_after != state_before
        page.click("#undo")
        wait_for_state(page, state_before)
        page.click("#redo")
        wait_for_state(page, state_after)
        page.click("#view_text")
        page.locator(".cm-content").focus()
        page.keyboard.press("Control+z")
        page.click("#view_blocks")
        wait_for_blocks(page)
        assert state_of(page) == state_before
