"""Pages of a class: pupils who have joined it, a group of them, and their teacher."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from tests.support import studio
from tests.support.studio import Class, Pages
from tests.support.waiting import until
from tiniscript.studio.class_keeping import MAX_PUPILS

if TYPE_CHECKING:
    from playwright.sync_api import Page


@contextmanager
def class_of_many() -> Iterator[Class]:
    """A class without a robot, with room for all at one address."""
    with studio.serve_class([]) as taught_class:
        taught_class.room.teach({"do": "class_places", "places": MAX_PUPILS})
        yield taught_class


def wait_for_status(page: Page, text: str) -> None:
    page.locator("#class_pupil [role=status]").filter(has_text=text).wait_for()


def join_class(pages: Pages, class_: Class, name: str) -> Page:
    page = pages.open()
    page.click("#side_real")
    page.locator("#class_pupil input").nth(0).fill(class_.room.code.lower())
    page.locator("#class_pupil input").nth(1).fill(name)
    page.dblclick("[data-text=class_join]")
    wait_for_status(page, "You are in the class, ")
    assert f"{name} (2)" not in json.dumps(class_.room.teach({"do": "class"})["pupils"])
    return page


def open_teacher_page(pages: Pages, class_: Class) -> Page:
    page = pages.visit(class_.server.entrance(), "wall")
    page.locator("[data-teacher=class_count]").wait_for(state="attached")
    return page


def join_group(page: Page) -> None:
    page.click("#side_class")
    page.locator("#class_group input").fill("Red")
    page.click("[data-text=group_join]")
    page.locator("html[data-group=in]").wait_for(state="attached")


def lines(page: Page) -> list[str]:
    texts = page.evaluate("""() => { const root = document.querySelector('#editor').shadowRoot;
        return [...root.querySelectorAll('.cm-line')].map((line) => {
          const copy = line.cloneNode(true);
          for (const name of copy.querySelectorAll('.cm-mate')) name.remove();
          return copy.textContent; }); }""")
    return [str(row) for row in texts]


def wait_for_lines(page: Page, *rows: str) -> None:
    until(lambda: [row.strip() for row in lines(page) if row.strip()] == list(rows),
          f"{rows}, but {lines(page)}", 30)  # fmt: skip


def go_to_line(page: Page, row: str) -> None:
    """Press at the end of a line."""
    page.locator(".cm-line").filter(has_text=row).first.click()
    page.keyboard.press("End")


def type_slowly(page: Page, text: str) -> None:
    page.keyboard.type(text, delay=20)
