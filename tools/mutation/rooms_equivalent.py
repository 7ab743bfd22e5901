"""Changes of other rooms than the machine that change nothing, so that no test can notice them: the
line, what it becomes, and why."""

from __future__ import annotations

# fmt: off
_REASONS: dict[str, tuple[tuple[str, str], ...]] = {}
# fmt: on

EQUIVALENT = {pair for pairs in _REASONS.values() for pair in pairs}
