"""What the page shows of a running robot."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from playwright.sync_api import Page


def value(page: Page, name: str) -> str:
    return (
        page.locator("#values div")
        .filter(has=page.get_by_text(name, exact=True))
        .locator("dd")
        .inner_text()
    )


def running(page: Page) -> str:
    """Return which part of the text is marked."""
    return " ".join(page.locator(".cm-running").all_inner_texts())
