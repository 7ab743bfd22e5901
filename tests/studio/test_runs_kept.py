"""The page keeps the last runs: ten at most, 2 MB at most, and the oldest goes first."""

from __future__ import annotations

import json
import random
from pathlib import Path

from tests.support.node import in_node

SCRIPT = Path(__file__).parent / "runs_kept_in_node.mjs"
MAX_RUNS, MAX_CHARACTERS = 10, 2_000_000
LARGE_RUN = (9_900, 188, 0, 0)  # nearly as much as there is room for
TOO_LARGE_RUN = (9_900, 188, 50_000, 0)
ROW_CHARACTERS = 12  # of a row, beside its text


Kept = tuple[int, int, int, int]  # rows, characters of each, and of a file; pictures


def run(rng: random.Random, kind: int) -> Kept:
    """Return a small run, a middling one, a large one, one of which nothing is known, or one that
    was opened from a file and seen.
    """
    small_run = rng.randint(1, 20), rng.randint(1, 60), 0, rng.randint(0, 3)
    middling = rng.randint(500, 3000), rng.randint(1, 80), rng.choice((0, 600_000)), 2
    opened = (0, 0, rng.randint(100, 5000), rng.randint(2, 20))
    large = rng.choice((LARGE_RUN, TOO_LARGE_RUN))
    return (small_run, middling, large, (0, 0, 0, rng.randint(0, 1)), opened)[kind]


def stories() -> list[list[Kept]]:
    """Return runs of one kind, and of all kinds."""
    rng = random.Random(1)
    runs = [[run(rng, kind) for _ in range(25)] for kind in range(3) for _ in range(3)]
    return runs + [[run(rng, rng.randrange(5)) for _ in range(25)] for _ in range(20)]


def trimmed(runs: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """Return the newest runs that there is room for, and the newest in any case."""
    runs = runs[-MAX_RUNS:]
    while len(runs) > 1 and sum(size for _, size in runs) > MAX_CHARACTERS:
        runs = runs[1:]
    return runs


def test_the_newest_runs_are_kept_while_there_is_room() -> None:
    """One of which nothing is known goes as soon as another one begins."""
    histories = stories()
    by_count = by_size = by_nothing = 0
    lines = in_node(SCRIPT, input_text=json.dumps(histories))
    for history, line in zip(histories, lines, strict=True):
        kept_runs: list[tuple[int, int]] = []  # numbers and sizes, the oldest first
        for number, (at_start, at_end, size, run_size, seen) in enumerate(json.loads(line), 1):
            if number > 1 and not history[number - 2][0] and history[number - 2][3] < 2:
                by_nothing += 1
                kept_runs.pop()
            kept_runs = trimmed([*kept_runs, (number, 0)])
            assert at_start == [run_number for run_number, _ in reversed(kept_runs)]
            rows, characters, file, _ = history[number - 1]
            assert run_size == rows * (characters + ROW_CHARACTERS) + file + seen
            kept_before, kept_runs = kept_runs, trimmed([*kept_runs[:-1], (number, run_size)])
            by_size += len(kept_runs) < len(kept_before)
            by_count += len(kept_runs) == MAX_RUNS < number
            assert at_end == [run_number for run_number, _ in reversed(kept_runs)]
            assert size == sum(run_size for _, run_size in kept_runs)
    assert by_count > 40 and by_size > 100 and by_nothing > 40
