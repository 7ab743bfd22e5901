"""What no text says: a page makes operations of its own."""

from __future__ import annotations

from collections.abc import Iterable

from tiniscript.together.form import Operation
from tiniscript.together.page import Page


def does(page: Page, operations: Iterable[Operation]) -> bool:
    page.leave()
    was_done = page.apply(operations)
    page.leave()
    page._show(page.caret)
    return was_done
