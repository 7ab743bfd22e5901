"""Boards whose firmware is tested."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import pytest

Test = TypeVar("Test", bound=Callable[..., None])
BOARDS = pytest.mark.parametrize("board", ["uno", "mega"])


def each_board(test: Test) -> Test:
    """Run a test on both; a commit draws one of them for each row."""
    marked_test: Test = pytest.mark.sampled("board")(BOARDS(test))
    return marked_test
