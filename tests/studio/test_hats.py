"""The place of a WHEN, a TASK or a DEF of the blocks in the text.

Viewing a text's blocks changes nothing; whatever is moved, nothing is lost, and a DEF is before its
calls.
"""

from __future__ import annotations

import json
from pathlib import Path

from tests.support.node import in_node

SCRIPT = Path(__file__).with_name("hats_in_node.mjs")
SEEDS = 3000


def test_hat_blocks_are_written_in_place_and_before_their_calls() -> None:
    rows = [json.loads(row) for row in in_node(SCRIPT, str(SEEDS))]
    assert len(rows) == SEEDS
    for seed, row in enumerate(rows, 1):
        assert not row["wrong"], f"seed {seed}: {row}"
    assert sum(row["moved"] > 0 for row in rows) > SEEDS / 3
    assert sum(row["excused"] > 0 for row in rows) > SEEDS / 20
