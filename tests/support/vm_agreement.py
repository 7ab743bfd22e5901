"""Compares two machines."""

from __future__ import annotations

from tests.support.random_programs import MAX_MS


def are_equivalent(want: str, actual: str) -> bool:
    """Return whether two traces are equivalent; the place of a cut by `max-steps` does not
    count.
    """
    if want == actual:
        return True
    ours, theirs = actual.splitlines(), want.splitlines()
    if not any(_is_cut(lines[-1]) for lines in (ours, theirs)):
        return False
    shorter = min(len(ours), len(theirs)) - 1
    return ours[:shorter] == theirs[:shorter]


def _is_cut(line: str) -> bool:
    return line.endswith(" LIMIT") and line != f"{MAX_MS} LIMIT"
