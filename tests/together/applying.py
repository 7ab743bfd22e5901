"""Checks of operations that a page makes itself and no text contains."""

from __future__ import annotations

from collections.abc import Iterable

from tiniscript.together.form import Operation
from tiniscript.together.page import Page


def apply_edits(page: Page, operations: Iterable[Operation]) -> bool:
    page.leave()
    is_done = page.apply(operations)
    page.leave()
    page._show(page.caret)
    return is_done
