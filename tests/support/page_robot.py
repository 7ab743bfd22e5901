"""The page's view of a running robot."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from playwright.sync_api import Page

# A highlight's range is static, so its content is read through a live one.
RUNNING_SCRIPT = """() => [...CSS.highlights.get('running')].map((mark) => {
  const range = document.createRange();
  range.setStart(mark.startContainer, mark.startOffset);
  range.setEnd(mark.endContainer, mark.endOffset);
  return range.toString();
})"""


def value(page: Page, name: str) -> str:
    return (
        page.locator("#values div")
        .filter(has=page.get_by_text(name, exact=True))
        .locator("dd")
        .inner_text()
    )


def running(page: Page) -> str:
    """Return the marked part of the text."""
    return " ".join(page.evaluate(RUNNING_SCRIPT))


def wait_for_running(page: Page, part: str = "") -> None:
    """Wait until a part with this in its text is marked."""
    page.wait_for_function(
        f"(part) => ({RUNNING_SCRIPT})().some((it) => it.includes(part))", arg=part
    )


def wait_for_nothing_running(page: Page) -> None:
    """Wait until no part of the text is marked."""
    page.wait_for_function(f"() => !({RUNNING_SCRIPT})().length")
