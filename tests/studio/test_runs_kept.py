"""The page keeps the last runs: ten at most, 2 MB at most, and the oldest goes first."""

from __future__ import annotations

import json
import random
from pathlib import Path

from tests.support.node import in_node

SCRIPT = Path(__file__).parent / "runs_kept_in_node.mjs"
MOST_RUNS, MOST_CHARACTERS = 10, 2_000_000
LARGE = (9_900, 188, 0)  # nearly as much as there is room for


Kept = tuple[int, int, int]  # rows, characters of each, and of a file


def run(rng: random.Random, kind: int) -> Kept:
    """Return a small run, a middling one, or a large one."""
    small = rng.randint(1, 20), rng.randint(1, 60), 0
    middling = rng.randint(500, 3000), rng.randint(1, 80), rng.choice((0, 600_000))
    return (small, middling, LARGE)[kind]


def stories() -> list[list[Kept]]:
    """Return runs of one kind, and of all kinds."""
    rng = random.Random(1)
    runs = [[run(rng, kind) for _ in range(25)] for kind in range(3) for _ in range(3)]
    return runs + [[run(rng, rng.randrange(3)) for _ in range(25)] for _ in range(20)]


def test_the_newest_runs_are_kept_as_far_as_there_is_room_and_the_oldest_goes_first() -> None:
    histories = stories()
    by_count = by_size = 0
    for line in in_node(SCRIPT, given=json.dumps(histories)):
        sizes: list[int] = []
        for count, (kept_state, size, own) in enumerate(json.loads(line), 1):
            sizes.append(own)
            assert kept_state == [*range(count, count - len(kept_state), -1)], (
                "the newest ones, and no gap"
            )
            assert size == sum(sizes[number - 1] for number in kept_state)
            assert 1 <= len(kept_state) <= MOST_RUNS
            assert size <= MOST_CHARACTERS or len(kept_state) == 1
            if len(kept_state) < count:  # there is no room for another run
                by_count += len(kept_state) == MOST_RUNS
                by_size += len(kept_state) < MOST_RUNS
    assert by_count > 40 and by_size > 100


def test_no_run_goes_that_there_is_room_for() -> None:
    for line in in_node(SCRIPT, given=json.dumps(stories())):
        sizes: list[int] = []
        held = 0
        for count, (kept_state, size, own) in enumerate(json.loads(line), 1):
            sizes.append(own)
            wanted_count = 1
            most = min(count, held + 1, MOST_RUNS)  # removed runs do not return
            while wanted_count < most and sum(sizes[-wanted_count - 1 :]) <= MOST_CHARACTERS:
                wanted_count += 1
            assert (len(kept_state), size) == (wanted_count, sum(sizes[-wanted_count:]))
            held = len(kept_state)
