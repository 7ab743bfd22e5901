"""Blocks on the page: dragged, read and offered."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from tests.support.studio import wait_for, wait_for_blocks, write

if TYPE_CHECKING:
    from playwright.sync_api import Locator, Page


PROGRAM = "#blocks .blocklySvg > .blocklyWorkspace > .blocklyBlockCanvas"  # no toolbox
FLYOUT = ".blocklyFlyout:visible .blocklyBlockCanvas > .blocklyDraggable"  # no numbers in blocks
PATIENCE_MS = 90_000


def start(page: Page, text: str, level: str = "few") -> None:
    page.click("#view_text")
    write(page, text)
    page.click("#view_blocks")
    page.select_option("#level", level)
    wait_for_blocks(page)


def text_of(page: Page) -> str:
    """Return the program's text, which is next to or below the blocks."""
    wait_for_blocks(page)
    kept_text: str = page.evaluate("JSON.parse(sessionStorage['tiniscript.work']).text")
    return kept_text


def wait_for_text(page: Page, text: str) -> None:
    """Wait until the blocks have become this text; the page hears of a change a moment later."""
    for _ in range(PATIENCE_MS // 50):
        if text_of(page) == text:
            return
        page.wait_for_timeout(50)
    assert text_of(page) == text


def wait_for_other_text(page: Page, text: str) -> None:
    wait_for(page, lambda: text_of(page) != text, f"another text than {text}")


def block(page: Page, words: str) -> Locator:
    """Return the innermost block with these words on it."""
    locator = page.locator(f"{PROGRAM} .blocklyBlock")
    return locator.filter(has_text=words).last


def box_of(block: Locator) -> Any:
    """Return the box of a block without those that hang below it, from the page: Playwright's box
    of a path is inaccurate.
    """
    return path_of(block).evaluate("e => e.getBoundingClientRect().toJSON()")


def path_of(block: Locator) -> Locator:
    return block.locator("> .blocklyPath:not(.blocklyPathSelected)")


def drag(
    page: Page, group: str, words: str, target: Locator | None, off: tuple[int, int] = (0, 0)
) -> None:
    """Drag a block out of a group of the toolbox, below another one at this offset in pixels, or,
    without a target, to a free place."""
    page.locator(".blocklyToolboxCategory", has_text=group).click()
    source = page.locator(FLYOUT).filter(has_text=words).first
    source.wait_for()
    a = box_of(source)
    page.mouse.move(a["x"] + 8, a["y"] + 10)
    page.mouse.down()
    page.mouse.move(700, 330, steps=8)
    if target is not None:
        b = box_of(target)  # once the toolbox is no longer over it
        page.mouse.move(b["x"] + 10 + off[0], b["y"] + b["height"] + 8 + off[1], steps=8)
    page.mouse.up()
    page.locator("#blocks[data-state=shown]").wait_for()


def meet(a: dict[str, float], b: dict[str, float]) -> bool:
    """Return whether two boxes overlap by more than a notch."""
    are_apart = a["left"] > b["right"] - 1 or b["left"] > a["right"] - 1
    return not (are_apart or a["top"] > b["bottom"] - 8 or b["top"] > a["bottom"] - 8)


# Opens one group after the other: the kinds of the blocks that can be dragged out.
OFFERED_SCRIPT = """() =>
  [...document.querySelectorAll('.blocklyToolboxCategory')].flatMap((row) => {
  row.scrollIntoView({ block: 'center' });
  const { x, y, width, height } = row.getBoundingClientRect();
  const words = document.elementFromPoint(x + width / 2, y + height / 2);
  const press = () => ['pointerdown', 'pointerup'].forEach((type) =>
    words.dispatchEvent(new PointerEvent(type, { bubbles: true, cancelable: true })));
  press();
  const list = '.blocklyFlyout .blocklyBlockCanvas > .blocklyDraggable';
  const blocks = [...document.querySelectorAll(list)].filter((block) => block.checkVisibility());
  press();
  return blocks.map((block) => block.classList[0]);
})"""


def list_offered_blocks(page: Page) -> set[str]:
    wait_for_blocks(page)
    return set(page.evaluate(OFFERED_SCRIPT))
