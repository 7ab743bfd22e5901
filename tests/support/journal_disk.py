"""The disk of a journal: what happens before each of its writes."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable
from typing import Any

import pytest

from tiniscript.base import files
from tiniscript.together import journal


def full_disk(*_: object) -> int:
    raise OSError(errno.ENOSPC, "full")


def before_each_write(monkeypatch: pytest.MonkeyPatch, check: Callable[[], object]) -> None:
    """Call `check` before a journal writes or replaces its file; what it raises prevents that."""

    def checked(call: Callable[..., Any]) -> Callable[..., Any]:
        def check_and_call(*arguments: Any, **keywords: Any) -> Any:
            check()
            return call(*arguments, **keywords)

        return check_and_call

    monkeypatch.setattr(os, "write", checked(os.write))
    monkeypatch.setattr(journal, "replace", checked(files.replace))
