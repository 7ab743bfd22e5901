"""Each small part of the page shows and tells what is so, whatever was done to it before.

The parts run in node, through random histories; after each step a plain model of the part says what
has to be seen, and what the page has to hear.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.support.node import in_node, page_data

__all__ = ["page_data"]  # a fixture
SCRIPT = Path(__file__).with_name("small_parts_in_node.mjs")
HISTORIES = 12
# What the histories of each part have to have done, for them to be about something.
NEEDED_ACTS = {
    "start": {"begin", "end", "back", "keep", "open", "stars"},
    "versions": {"keep", "delete", "restore", "store"},
    "own": {"open", "name", "paint", "fill"},
    "twice": {"press", "keys", "hide"},
    "stop": {"begin", "end", "connect", "leave", "press"},
    "timeLine": {"begin", "move", "keys", "resize"},
    "editor": {"halt", "run", "end", "type"},
    "runs": {"open", "see", "save", "choose", "drop"},
    "keys": {"open", "put"},
    "tabs": {"open", "copy", "reload", "work", "draw", "damage"},
    "fields": {"type", "typeWords", "takeBack", "open", "playKey", "step", "name"},
    "camera": {"look", "wander"},
    "bumps": {"front", "left", "back", "right", "free"},
    "words": {"show", "changeLanguage"},
    "world": {"choose", "bring", "put", "keep", "reload"},
}


@pytest.mark.parametrize("part", NEEDED_ACTS)
def test_it_shows_and_tells_what_is_so(page_data: Path, part: str) -> None:
    (line,) = in_node(SCRIPT, str(page_data), "0", str(HISTORIES), part)
    assert set(json.loads(line)) >= NEEDED_ACTS[part]
