"""A test that is played for long by command, as `python -m tests.link.test_live_lines 1000000`."""

from __future__ import annotations

import time
from argparse import ArgumentParser, Namespace
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from traceback import extract_tb


def make_options(count: int, seed: int, *flags: str) -> Namespace:
    """Return the `count` and the first `seed` of a command, and whether each flag was given."""
    parser = ArgumentParser()
    parser.add_argument("count", type=int, nargs="?", default=count)
    parser.add_argument("--seed", type=int, default=seed)
    for flag in flags:
        parser.add_argument(f"--{flag}", action="store_true")
    return parser.parse_args()


def each_seed(check: Callable[[int], object], options: Namespace) -> None:
    """Run a check with each seed; print how many times each thing came of it, or a seed that fails.

    `check` returns the outcome, or None if that is always the same.
    """
    counts: Counter[str] = Counter()
    start_s = time.monotonic()
    for seed in range(options.seed, options.seed + options.count):
        try:
            outcome = check(seed)
        except BaseException:
            print(f"seed {seed}", flush=True)
            raise
        if outcome is not None:
            counts[str(outcome)] += 1
    print(f"{options.count}, nothing wrong: {dict(counts)}, {time.monotonic() - start_s:.0f} s")


def failure_text(error: AssertionError) -> str:
    """Return the message of an assertion, or its place and code if it has none."""
    frame = extract_tb(error.__traceback__)[-1]
    place = f"{Path(frame.filename).name}:{frame.lineno}: {frame.line}"
    return f"{place}: {error}" if str(error) else place
