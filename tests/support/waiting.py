"""Waiting for something in real time. The limit ends a test that hangs, and no other."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

HANG_LIMIT_S = 120.0


def until(
    is_reached: Callable[[], bool], description: str, timeout_s: float = HANG_LIMIT_S
) -> None:
    """Wait until something is so."""
    end_s = time.monotonic() + timeout_s
    while not is_reached():
        assert time.monotonic() < end_s, f"not after {timeout_s} s: {description}"
        time.sleep(0.01)


def has_ended(number: str) -> bool:
    """Return whether a process of Linux is gone, or a zombie."""
    try:
        stat = Path(f"/proc/{number}/stat").read_text()
    except (FileNotFoundError, ProcessLookupError):
        return True
    return stat.rpartition(")")[2].split()[0] == "Z"
