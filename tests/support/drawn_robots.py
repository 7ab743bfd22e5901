"""Pictures of the virtual robot, drawn by the page's own code in node."""

from __future__ import annotations

import json
from typing import Any

from tests.support.casefile import ROOT
from tests.support.node import in_node
from tiniscript.studio.description import description

DRAW_SCRIPT = ROOT / "tests" / "studio" / "draw_in_node.mjs"
STANDING_STILL: dict[str, Any] = {"rolled_cm": [0, 0], "isBeeping": False}
Drawing = list[tuple[str, list[float], str]]


def drawings_of(*expected: tuple[str, dict[str, Any] | None, dict[str, Any]]) -> list[Drawing]:
    """Return the drawings of robots, each with its name, its state and other visible parts."""
    robot_by_name = {robot["name"]: robot for robot in description()["robots"]}
    requests = [
        {"robot": robot_by_name[name], "state": state, "seen": robot_state}
        for name, state, robot_state in expected
    ]
    drawings: list[Drawing] = json.loads(in_node(DRAW_SCRIPT, input_text=json.dumps(requests))[0])
    return drawings


def shapes(drawing: Drawing, style: str, color: str) -> list[list[float]]:
    return [numbers for kind, numbers, fill in drawing if (kind, fill) == (style, color)]
