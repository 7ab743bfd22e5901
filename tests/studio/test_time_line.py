"""The record of a virtual robot's run, for looking back.

Each stored moment is unchanged, with all values shown until then; only the oldest events of a run
that is too long are forgotten; the second run is independent of the first.
"""

from __future__ import annotations

import json
from pathlib import Path

from tests.support.node import in_node

SCRIPT = Path(__file__).with_name("moments_in_node.mjs")
SEEDS = 60


def test_each_past_moment_is_reproduced() -> None:
    rows = [json.loads(row) for row in in_node(SCRIPT, str(SEEDS))]
    assert len(rows) == SEEDS
    for seed, row in enumerate(rows, 1):
        assert not row["wrong"], f"seed {seed}: {row}"
    assert any(0 < row["kept"] < row["states"] / 4 for row in rows)
    assert sum(row["kept"] for row in rows) > 1000
