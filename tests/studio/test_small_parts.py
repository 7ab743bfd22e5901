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
    "start": {"begins", "ends", "back", "keeps", "opens", "stars"},
    "versions": {"keeps", "deletes", "restores", "stores"},
    "own": {"opens", "names", "paints", "fills"},
    "twice": {"presses", "keys", "hides"},
    "stop": {"begins", "ends", "connects", "leaves", "presses"},
    "timeLine": {"begins", "moves", "keys", "resizes"},
    "editor": {"halts", "runs", "ends", "types"},
    "runs": {"opens", "sees", "saves", "chooses", "drops"},
    "keys": {"opens", "puts"},
    "tabs": {"opens", "copies", "reloads", "works", "draws", "damages"},
    "fields": {"types", "typesWords", "takesBack", "opens", "playsKey", "steps", "names"},
    "camera": {"looks", "wanders"},
    "bumps": {"front", "left", "back", "right", "free"},
    "words": {"shows", "speaks"},
    "world": {"chooses", "brings", "puts", "keeps", "reloads"},
}


@pytest.mark.parametrize("part", NEEDED_ACTS)
def test_it_shows_and_tells_what_is_so(page_data: Path, part: str) -> None:
    (line,) = in_node(SCRIPT, str(page_data), "0", str(HISTORIES), part)
    assert set(json.loads(line)) >= NEEDED_ACTS[part]
