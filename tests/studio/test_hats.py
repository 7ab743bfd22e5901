"""Where a WHEN, a TASK or a DEF of the blocks is written in the text.

Who looks at a text's blocks changes nothing; whatever is moved, nothing is lost, and a DEF stands
before its calls.
"""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

from tests.support.needs import need
from tiniscript.studio.building import SOURCES
from tools import CannotMake
from tools.builds.studio import found_tools

SCRIPT = Path(__file__).with_name("hats_in_node.mjs")
SEEDS = 3000


def test_hats_are_written_where_they_stand_and_before_their_calls() -> None:
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
    assert sum(row["moved"] > 0 for row in rows) > SEEDS / 3
    assert sum(row["excused"] > 0 for row in rows) > SEEDS / 20
