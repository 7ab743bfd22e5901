"""Runs that the page keeps."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from playwright.sync_api import Page


def run_names(page: Page) -> list[str]:
    """Open the window of the runs; return their names."""
    page.click("#runs_open")
    return page.locator("#runs_list button:first-child").all_inner_texts()
