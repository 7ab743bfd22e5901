"""The second time of each part of the page is as the first one of a page that was just loaded.

The parts run in node, on a clock of the script; whatever the first time has met (a write that
fails, a STOP, a refusal, a fault, a class that is gone), nothing of it is seen in the second one.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from tests.support.node import in_node, page_data

__all__ = ["page_data"]  # a fixture
SCRIPT = Path(__file__).with_name("second_time_in_node.mjs")
WHOLE_PAGE = Path(__file__).with_name("whole_page_in_node.mjs")
SEEDS = 80
# What the first one has to have met, for the row to be about something.
ENDS_BY_PART = {
    "bluetooth": {"open", "failed", "link_silent"},
    "serial": {"hears", "errs", "writes", "reset", "goes", "stuck", "failed"},
    "simulator": {"stop", "leave", "wait", "failure", "ended"},
    "panel": {"stop", "wait", "running", "paused", "ended", "off", "refused", "breaks", "fault"},
    "sounds": {"begin", "beep", "crash", "cheer", "silence", "mute"},
    "stopping": {"confirm", "over"},
    "flashing": {"good", "port", "firmware", "flash", "meet", "cancel"},
    "pupil": {"removed"},
    "returning": {"yes", "no", "lost", "reload", "join", "leave", "mate", "full"},
    "pictures": {"made", "none"},
    "worker": {"good", "failed", "none"},
    "loading": {"ready", "silent"},
    "fetching": {"whole", "broken", "refused", "lost", "cancelled", "silent"},
    "checking": {"changed", "checked"},
    "again": {"parted", "whole"},
    "lessons": {"check", "end", "edit"},
    "asking": {"stays", "goes"},
    "python": {"error", "not fetched", "silent"},
    "keeping": {"none", "some"},
    "wall": {"lost", "came"},
    "link": {"left", "unheard", "link_silent"},
    "robots": {"again", "line", "sense", "startAgain", "step", "twice", "watch"},
    "member": {"join", "leave", "end", "edit"},
    "news": {"ask", "tell", "move"},
    "orders": {"run", "start", "step", "line", "send", "points", "halt", "stop"},
    "stops": {"silent", "confirmed", "unheard"},
    "worlds": {"draw", "earlier", "keep", "reload", "rest"},
    "drawing": {"add", "undo", "redo", "enter", "open"},
    "programs": {"kept", "full"},
    "arena": {"long", "short"},
    "curves": {"long", "short"},
    "steps": {"came", "failed"},
    "places": {"meet", "upload", "startAgain", "stop", "line", "setBreakpoints", "halt", "goOn"},
    "recording": {"theirs", "show", "end", "awaitButton", "gone", "halt", "read"},
    "giving": {"chosen", "gone", "alike", "nobody"},
    "handing": {"early", "late"},
    "sure": {"sure", "once"},
    "cable": {"closed", "opening", "open", "over"},
    "queue": {"ask", "press", "hear", "stop", "wait", "broken"},
    "writing": {
        "type",
        "build",
        "undo",
        "views",
        "join",
        "leave",
        "refuse",
        "pictures",
        "failed",
    },
    "languages": {"en", "es", "pt"},
    "builds": {"installed", "lost"},
    "kept": {"forgets"},
    "together": {"gone", "left", "fails"},
    "stage": {"run", "leave", "peek", "rest", "home", "letGo", "end"},
    "phone": {"sheet", "wrong", "warned", "right", "run", "view", "turn"},
    "entering": {"given", "used", "lost"},
    "blocks": {
        "search",
        "show",
        "edit",
        "tryAlone",
        "run",
        "grow",
        "put",
        "close",
        "changeLanguage",
    },
    "presses": {"run", "step", "stop", "edit"},
    "watching": {"told", "silent"},
}


@pytest.mark.sampled("part", keep=3)
@pytest.mark.parametrize("part", ENDS_BY_PART)
def test_a_used_page_behaves_like_a_fresh_one(page_data: Path, part: str) -> None:
    lines = in_node(SCRIPT, str(page_data), part, str(SEEDS))
    rows: list[dict[str, Any]] = [json.loads(line) for line in lines]
    assert len(rows) == SEEDS
    assert ENDS_BY_PART[part] <= {end for row in rows for end in row["ends"]}
    for row in rows:
        assert row["isSame"] and not row["unhandled"], row


# Of the whole page: what each row of seeds has to have done first, for it to be about something.
NEEDED_ACTIONS = {"run", "stop", "step", "type", "build", "robot"}
MIN_ACTION_KINDS = 30  # of doing something
ROW = 8  # seeds


@pytest.mark.sampled("first_seed", keep=1)
@pytest.mark.parametrize("first_seed", range(0, 10 * ROW, ROW))
def test_starting_anew_shows_the_same_as_a_reload(page_data: Path, first_seed: int) -> None:
    """Whatever was pressed before, and whatever is pressed then; what the page keeps, both keep.

    At rest the page says and shows what is so, and nothing that was typed is lost."""
    lines = in_node(WHOLE_PAGE, str(page_data), str(first_seed), str(ROW))
    rows: list[dict[str, Any]] = [json.loads(line) for line in lines]
    assert len(rows) == ROW
    end_kinds = {end for row in rows for end in row["ends"]}
    assert end_kinds >= NEEDED_ACTIONS and len(end_kinds) > MIN_ACTION_KINDS
    for row in rows:
        assert row["isSame"] and not row["unhandled"], row
