"""Compares two machines."""

from __future__ import annotations

from tests.support.random_programs import MAX_MS


def are_equivalent(expected_trace: str, actual: str) -> bool:
    """Return whether two traces are equivalent; the place of a cut by `max-steps` does not
    count.
    """
    if expected_trace == actual:
        return True
    actual_lines, expected_lines = actual.splitlines(), expected_trace.splitlines()
    if not any(_is_cut(lines[-1]) for lines in (actual_lines, expected_lines)):
        return False
    shorter = min(len(actual_lines), len(expected_lines)) - 1
    return actual_lines[:shorter] == expected_lines[:shorter]


def _is_cut(line: str) -> bool:
    return line.endswith(" LIMIT") and line != f"{MAX_MS} LIMIT"
