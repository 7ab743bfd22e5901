"""Changes of other rooms than the machine that change nothing, so that no test can notice them: the
line, what it becomes, and why."""

from __future__ import annotations

# fmt: off
_REASONS: dict[str, tuple[tuple[str, str], ...]] = {
    "no byte is being written when a save comes to its first step that waits": (
        ("bool Store::is_committing() const { return is_busy_ && !nvm_is_ready() && step_ > waits_from_; }",
         "bool Store::is_committing() const { return is_busy_ && !nvm_is_ready() && step_ >= waits_from_; }"),
    ),
}
# fmt: on

EQUIVALENT = {pair for pairs in _REASONS.values() for pair in pairs}
