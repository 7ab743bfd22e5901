"""The record of a virtual robot's run, for looking back.

Each moment that is kept is what it was, with all that had been shown until then; no event is
forgotten, but for the oldest ones of a run that is too long; the second run knows nothing of the
first one.
"""

from __future__ import annotations

import json
from pathlib import Path

from tests.support.node import in_node

SCRIPT = Path(__file__).with_name("moments_in_node.mjs")
SEEDS = 60


def test_each_moment_is_what_it_was() -> None:
    rows = [json.loads(row) for row in in_node(SCRIPT, str(SEEDS))]
    assert len(rows) == SEEDS
    for seed, row in enumerate(rows, 1):
        assert not row["wrong"], f"seed {seed}: {row}"
    assert any(0 < row["kept"] < row["states"] / 4 for row in rows)
    assert sum(row["kept"] for row in rows) > 1000
