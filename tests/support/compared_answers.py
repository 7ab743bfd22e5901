"""Compares the answers of two robots without their own counters."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from tiniscript.link.connection import PendingRequest
from tiniscript.link.requests import OK

COMMON_COUNT = 20  # items before a difference that are shown
RUN_FIELDS = ("run", "damaged", "dropped", "nonce", "reset", "count", "epoch")


def answer_without_counts(request: PendingRequest[Any] | None, *but: str) -> object:
    """Return the result of a request, and its values without some fields and without counts."""
    if request is None or request.outcome is None:
        return None
    outcome = request.outcome
    return outcome.status, without_counts(outcome.values, *but) if outcome.status == OK else None


def without_counts(values: Any, *but: str) -> object:
    """Return values without some fields, and without counters since power-on."""
    if not hasattr(values, "_asdict"):
        return values
    return [
        (name, value) for name, value in values._asdict().items() if name not in (*RUN_FIELDS, *but)
    ]


def first_difference(actual: Sequence[object], expected_items: Sequence[object]) -> str:
    """Return the last items that both have in common, and how each goes on after them."""
    alike = 0
    while actual[alike : alike + 1] == expected_items[alike : alike + 1]:
        alike += 1
    common_items = actual[max(0, alike - COMMON_COUNT) : alike]
    return f"{common_items}\n{actual[alike:][:4]}\nnot\n{expected_items[alike:][:4]}"
