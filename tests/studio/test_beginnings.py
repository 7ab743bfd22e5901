"""The programs of the pictures on the start screen."""

from __future__ import annotations

import json
from pathlib import Path

from tests.support.command import run_in_process
from tests.support.node import in_node

SCRIPT = Path(__file__).parent / "beginnings_in_node.mjs"
SECONDS = 90


def test_no_start_picture_shows_a_collision(tmp_path: Path) -> None:
    (row,) = in_node(SCRIPT)
    beginnings = json.loads(row)
    assert len(beginnings) > 5
    for name, beginning in beginnings.items():
        program = tmp_path / "program.ts"
        program.write_text(beginning["text"], "utf-8")
        robot_options = ("--robot", beginning["robot"], "--world", beginning["world"])
        result = run_in_process(
            "upload", program, "--virtual", *robot_options, "--for", str(SECONDS), "--hurry", "max"
        )
        assert "touched nothing" in result.out, (name, result.out)
