"""Runs what the project promises, many times: all goals, or those that are named.

`python -m tools.campaign` goes on where the last one ended, until every goal is reached; Ctrl-C
ends it at once, and all but the piece that was under way is kept. `--list` says what is reached,
when, and how long the rest takes, `--minutes 30` ends it after a while, `--write` puts the figures
into `docs/promises.md`. Calls the campaigns of the tests; has none of its own.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import time
from collections.abc import Sequence
from datetime import date, datetime, timezone
from itertools import repeat
from math import inf
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "compiler"), str(ROOT)]

from tools.campaign import results
from tools.campaign.goals import BY_NAME, GOALS, Goal
from tools.campaign.results import Result, Results, reached

FIRST_SEED = 100_001  # others than those of the tests


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Run what the project promises, many times.")
    parser.add_argument("goals", nargs="*", metavar="GOAL", help=", ".join(BY_NAME))
    parser.add_argument("--list", action="store_true", help="only say what is reached")
    parser.add_argument("--minutes", type=float, help="end after so many minutes")
    parser.add_argument("--pieces", type=int, help="at most so many pieces of each goal")
    parser.add_argument("--write", action="store_true", help="put it into the document")
    options = parser.parse_args(arguments)
    unknown = [name for name in options.goals if name not in BY_NAME]
    if unknown:
        parser.error(f"no goal is called {', '.join(unknown)}. There are: {', '.join(BY_NAME)}")
    goals = [BY_NAME[name] for name in options.goals] or list(GOALS)
    done = results.read(results.kept())
    if options.list:
        tell(goals, done)
        return 0
    if options.write:
        return put_down(done)
    code = run(goals, done, options.minutes, options.pieces)
    tell(goals, results.read(results.kept()))
    return code


def run(goals: Sequence[Goal], done: Results, minutes: float | None, pieces: int | None) -> int:
    """Run pieces of the goals until all are reached or the time is over; return the exit code."""
    end_s = inf if minutes is None else time.monotonic() + 60 * minutes
    commit = results.commit()
    is_wrong = False
    try:
        for goal in goals:
            for _ in repeat(None) if pieces is None else range(pieces):
                if is_reached(goal, done.get(goal.name), commit):
                    break
                if time.monotonic() >= end_s:
                    print("The time is over; the next campaign goes on from here.", flush=True)
                    return int(is_wrong)
                done[goal.name] = piece(goal, done.get(goal.name), commit)
                results.write(results.kept(), done)
                if done[goal.name].wrong:
                    is_wrong = True
                    break
    except KeyboardInterrupt:
        print("\nInterrupted; the next campaign goes on from here.", flush=True)
        return 2
    return int(is_wrong)


def is_reached(goal: Goal, result: Result | None, commit: str) -> bool:
    """Whether nothing is left to do with this code."""
    if result is None or not results.is_same_code(result.commit, commit):
        return False
    return not result.wrong and result.done >= goal.shall


def piece(goal: Goal, before: Result | None, commit: str) -> Result:
    """Run a piece of a goal; return what is reached with it.

    A piece that was wrong is run again. What other code has reached counts no more.
    """
    if before is None or not results.is_same_code(before.commit, commit):
        before = Result(0, 0, FIRST_SEED, FIRST_SEED, "", commit)
    seed = before.next_seed
    count = min(goal.piece, goal.shall - before.done)
    words = [sys.executable, "-m", *goal.command.format(count=count, seed=seed).split()]
    print(f"{goal.name}: {before.done:,} of {goal.shall:,}; {' '.join(words[1:])}", flush=True)
    begun = time.monotonic()
    ended = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, errors="replace")
    seconds = round(before.seconds + time.monotonic() - begun, 1)
    day = datetime.now(timezone.utc).date().isoformat()
    if ended.returncode:
        print((ended.stdout + ended.stderr)[-4000:], flush=True)
        return before._replace(date=day, wrong=f"seed {seed}, `python {' '.join(words[1:])}`")
    return Result(before.done + count, seconds, before.seed, seed + goal.stride, day, commit)


def tell(goals: Sequence[Goal], done: Results) -> None:
    """Print what is reached, how long that took, how long the rest takes, and how old it is.

    What this computer has not run is in the document, or nowhere.
    """
    commit = results.commit()
    done = {**results.read(results.WRITTEN), **done}
    today = datetime.now(timezone.utc).date()
    for goal in goals:
        result = done.get(goal.name)
        said = reached(goal, result)
        if result is not None and result.done:
            left = max(0, goal.shall - result.done) * result.seconds / result.done
            said += f" in {result.seconds:,.0f} s; the rest takes {left:,.0f} s"
            if not results.is_same_code(result.commit, commit):
                said += f"; with the code of {result.commit}, which is another one now"
        if result is not None and result.date:
            days = (today - date.fromisoformat(result.date)).days
            said += f"; run {days} days ago" if days else "; run today"
        print(f"{goal.name:15} {goal.shall:>11,} {goal.unit}: {said}")


def put_down(done: Results) -> int:
    """Put the figures of commits that led here into the document; return the exit code."""
    rows = [*results.read(results.WRITTEN).items(), *done.items()]
    fit = {name: each for name, each in rows if results.is_in_history(each.commit)}
    left_out = sorted({name for name, _ in rows} - set(fit))
    results.write(results.WRITTEN, fit)
    if left_out:
        said = f"Left out, as their code is in no commit that led here: {', '.join(left_out)}."
        print(said, file=sys.stderr)
    return subprocess.run([sys.executable, "-m", "tools.generate"], cwd=ROOT).returncode


if __name__ == "__main__":
    sys.exit(main())
