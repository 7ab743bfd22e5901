"""A tapped block goes where a child expects it: behind the block that was touched last, or to the
end of the program. What cannot be joined covers no other block."""

from __future__ import annotations

import json
from pathlib import Path

from tests.support.node import in_node, page_data

__all__ = ["page_data"]  # a fixture
SCRIPT = Path(__file__).with_name("insert_in_node.mjs")
SEEDS = 200


def test_a_tapped_block_goes_where_it_is_expected(page_data: Path) -> None:
    rows = [json.loads(row) for row in in_node(SCRIPT, str(page_data), str(SEEDS))]
    for seed, row in enumerate(rows, 1):
        assert not row["wrong"], f"seed {seed}: {row}"
    for where in ("joined", "loose"):
        assert sum(row["where"] == where for row in rows) > SEEDS / 4
    assert {"when", "sensor", "forever"} <= {row["kind"] for row in rows}
