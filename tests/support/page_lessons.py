"""The lessons on the page: chosen and checked."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tests.support.studio import write

if TYPE_CHECKING:
    from playwright.sync_api import Page


PATIENCE_MS = 240_000  # a busy computer drives through all worlds of a lesson


def choose_lesson(page: Page, number: int) -> None:
    """See the task of a lesson."""
    page.select_option("#lesson", str(number))
    page.locator(f"#lesson_page[data-lesson='{number}']").wait_for()
    page.locator("#lesson_steps button").last.click()
    page.locator("#lesson_check:enabled").wait_for()


def check_answer(page: Page, program: str) -> tuple[str, list[str]]:
    """Check a program on the page; return its verdict and its sentences."""
    write(page, program)
    page.click("#lesson_check")
    page.locator("#lesson_said[data-verdict]").wait_for(timeout=PATIENCE_MS)
    verdict = page.locator("#lesson_said").get_attribute("data-verdict")
    return str(verdict), page.locator("#lesson_findings li").all_inner_texts()
