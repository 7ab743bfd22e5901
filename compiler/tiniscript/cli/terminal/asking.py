"""Asking the person at the terminal for a yes."""

from __future__ import annotations

import sys

YES = ("1", "y", "yes", "s", "si", "sí")


def can_ask() -> bool:
    """Whether somebody reads a question, and can answer."""
    return sys.stdin is not None and sys.stdin.isatty() and sys.stderr.isatty()


def agreed(question: str) -> bool:
    """Ask, and return whether the answer is a yes: an empty one is none."""
    print(question, end="", file=sys.stderr, flush=True)
    return sys.stdin.readline().strip().lower() in YES
