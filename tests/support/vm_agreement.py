"""How two machines are compared."""

from __future__ import annotations

from tests.support.random_programs import MAX_MS


def same(want: str, actual: str) -> bool:
    """Whether two traces mean the same: where `max-steps` cuts is not part of the meaning."""
    if want == actual:
        return True
    ours, theirs = actual.splitlines(), want.splitlines()
    if not any(_is_cut(lines[-1]) for lines in (ours, theirs)):
        return False
    shorter = min(len(ours), len(theirs)) - 1
    return ours[:shorter] == theirs[:shorter]


def _is_cut(line: str) -> bool:
    return line.endswith(" LIMIT") and line != f"{MAX_MS} LIMIT"
