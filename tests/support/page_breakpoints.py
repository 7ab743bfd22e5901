"""Breakpoints on the page, and a program that counts."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from playwright.sync_api import Page


COUNTING_PROGRAM = """SI|X = 0;
LOOP(3);
  X = X + 1; W(0.1);
  // a note
  SHOW(X * X);

END_LOOP"""


def press_margin(page: Page, line: int) -> None:
    numbers = page.locator(".cm-lineNumbers .cm-gutterElement")
    numbers.filter(has_text=str(line)).last.click()
