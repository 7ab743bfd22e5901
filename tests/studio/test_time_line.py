"""What is kept of a run of the virtual robot, so that a person can look back.

Each moment that is kept is what it was, with all that had been shown until then; no event is
forgotten, but for the oldest ones of a run that is too long; the second run knows nothing of the
first one.
"""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

from tests.support.needs import need
from tiniscript.studio.building import SOURCES
from tools import CannotMake
from tools.builds.studio import found_tools

SCRIPT = Path(__file__).with_name("moments_in_node.mjs")
SEEDS = 60


def test_each_moment_is_what_it_was() -> None:
    try:
        node = found_tools().node
    except CannotMake as why:
        need(str(why))
    words = [*node, str(SCRIPT), str(SOURCES / "src"), str(SEEDS)]
    done = subprocess.run(words, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    rows = [json.loads(row) for row in done.stdout.splitlines()]
    assert len(rows) == SEEDS
    for seed, row in enumerate(rows, 1):
        assert not row["wrong"], f"seed {seed}: {row}"
    assert any(0 < row["kept"] < row["states"] / 4 for row in rows)
    assert sum(row["kept"] for row in rows) > 1000
