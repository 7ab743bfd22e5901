"""Tests the project's guarantees many times: all goals, or the named ones.

`python -m tools.campaign` goes on where the last one ended, until every goal is reached; Ctrl-C
ends it at once, and all but the piece that was under way is kept. `--list` prints which goals were
reached, and when; `--minutes 30` ends it after a while. Results for committed code are written into
the table of `docs/en/guarantees.md`. It calls the campaigns of the tests and has none of its own.
"""

from __future__ import annotations

import argparse
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from datetime import datetime, timezone
from math import inf

from tools import ROOT
from tools.campaign import results
from tools.campaign.goals import BY_NAME, GOALS, Goal
from tools.campaign.results import Result, figure_text

FIRST_SEED = 100_001  # others than those of the tests


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Test what the project guarantees, many times.")
    parser.add_argument("goals", nargs="*", metavar="GOAL", help=", ".join(BY_NAME))
    parser.add_argument("--list", action="store_true", help="only say what is reached")
    parser.add_argument("--minutes", type=float, default=inf, help="end after so many minutes")
    options = parser.parse_args(arguments)
    unknown_goals = [name for name in options.goals if name not in BY_NAME]
    if unknown_goals:
        parser.error(
            f"no goal is called {', '.join(unknown_goals)}. There are: {', '.join(BY_NAME)}"
        )
    goals = [BY_NAME[name] for name in options.goals] or list(GOALS)
    exit_code = 0 if options.list else run(goals, time.monotonic() + 60 * options.minutes)
    results_by_goal = results.read_results()
    for goal in goals:
        result = results_by_goal.get(goal.name)
        reached_text = f"; {result.date}, code of {result.commit}" if result else ""
        figure = figure_text(goal, result)
        print(f"{goal.name:15} {goal.target:>11,} {goal.unit}: {figure}{reached_text}")
    return exit_code


def run(goals: Sequence[Goal], end_s: float) -> int:
    """Run pieces of the goals until all are reached or the time is over; return the exit code."""
    commit = results.current_commit()
    if commit.endswith("+"):
        print("Code that is not committed: what it reaches is not kept.", flush=True)
    results_by_goal = results.read_results()
    is_wrong = False
    try:
        for goal in goals:
            while not is_reached(goal, results_by_goal.get(goal.name), commit):
                if time.monotonic() >= end_s:
                    print("The time is over; the next campaign goes on from here.", flush=True)
                    return int(is_wrong)
                results_by_goal[goal.name] = run_piece(goal, results_by_goal.get(goal.name), commit)
                if not commit.endswith("+"):
                    results.write_results(results_by_goal)
                if results_by_goal[goal.name].wrong:
                    is_wrong = True
                    break
    except KeyboardInterrupt:
        print("\nInterrupted; the next campaign goes on from here.", flush=True)
        return 2
    if not commit.endswith("+"):
        subprocess.run([sys.executable, "-m", "tools.generate"], cwd=ROOT, check=True)
    return int(is_wrong)


def is_reached(goal: Goal, result: Result | None, commit: str) -> bool:
    """Return whether the goal is already reached for this code."""
    if result is None or not results.is_same_code(goal, result.commit, commit):
        return False
    return not result.wrong and result.done >= goal.target


def run_piece(goal: Goal, last_result: Result | None, commit: str) -> Result:
    """Run a piece of a goal; return the new result.

    A piece that failed is run again. Results of other code no longer count.
    """
    if last_result is None or not results.is_same_code(goal, last_result.commit, commit):
        last_result = Result(0, 0, FIRST_SEED, FIRST_SEED, "", commit)
    seed = last_result.next_seed
    count = min(goal.piece_size, goal.target - last_result.done)
    command = [sys.executable, "-m", *goal.command.format(count=count, seed=seed).split()]
    print(
        f"{goal.name}: {last_result.done:,} of {goal.target:,}; {' '.join(command[1:])}", flush=True
    )
    begin_s = time.monotonic()
    process = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, errors="replace")
    total_s = round(last_result.seconds + time.monotonic() - begin_s, 1)
    date = datetime.now(timezone.utc).date().isoformat()
    if process.returncode:
        print((process.stdout + process.stderr)[-4000:], flush=True)
        return last_result._replace(
            date=date, wrong=f"seed {seed}, `python {' '.join(command[1:])}`"
        )
    return Result(
        last_result.done + count, total_s, last_result.seed, seed + goal.stride, date, commit
    )


if __name__ == "__main__":
    # A background process of a shell ignores Ctrl-C, and so would each command under test.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    sys.exit(main())
