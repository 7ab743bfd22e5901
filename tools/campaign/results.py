"""What campaigns have measured: `results.json`, and from it the table of `docs/en/guarantees.md`.

A result belongs to the code with which it was measured: figures of other code are not added up.
"""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import NamedTuple

from tiniscript.base.files import replace
from tools import ROOT
from tools.campaign.goals import GOALS, Goal

WRITTEN = Path(__file__).with_name("results.json")
CODE = ("compiler", "vm_arduino", "tests")  # what a figure is about
HEAD = ("name", "guarantee", "target", "measured", "seeds", "date", "commit")


class Result(NamedTuple):
    """So many were `done` in `seconds`, with the seeds from `seed` on; `next_seed` is the one after
    the last. `wrong`: how the last piece failed, or nothing."""

    done: int
    seconds: float
    seed: int
    next_seed: int
    date: str
    commit: str
    wrong: str = ""


Results = dict[str, Result]


def read() -> Results:
    found = json.loads(WRITTEN.read_text(encoding="utf-8"))
    return {name: Result(**values) for name, values in found.items()}


def write(results: Results) -> None:
    """Write a line for each result, in the order of the goals."""
    rows = (f'"{goal.name}": {json.dumps(results[goal.name]._asdict())}'
            for goal in GOALS if goal.name in results)  # fmt: skip
    replace(WRITTEN, ("{\n" + ",\n".join(rows) + "\n}\n").encode())


def commit() -> str:
    """Return the commit of the code that is tested; with a `+` where it has changed since."""
    head = git("rev-parse", "--short=10", "HEAD").stdout.strip()
    return head + "+" * bool(git("status", "--porcelain", "--", *CODE).stdout.strip())


def is_same_code(one: str, other: str) -> bool:
    """Whether two commits have the same code; one with a `+` is like no other."""
    is_known = "+" not in one + other
    return one == other or (
        is_known and not git("diff", "--quiet", one, other, "--", *CODE).returncode
    )


def git(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True)


def measured(goal: Goal, result: Result | None) -> str:
    """Return the figure, and that it is less than the goal where it is."""
    if result is None:
        return "not run yet"
    if result.wrong:
        return f"**wrong**: {result.wrong}"
    return f"{result.done:,}" + ("" if result.done >= goal.target else ": less")


def rows() -> list[tuple[str, ...]]:
    """Return the table of `docs/en/guarantees.md`."""
    results = read()
    found: list[tuple[str, ...]] = []
    for goal in GOALS:
        result = results.get(goal.name)
        about = ("", "", "")
        if result is not None:
            last = max(result.seed, result.next_seed - goal.stride)
            seeds = f"{result.seed}" if last == result.seed else f"{result.seed} to {last}"
            about = ("-" if "{seed}" not in goal.command else seeds, result.date, result.commit)
        row = (f"`{goal.name}`", goal.guarantee, f"{goal.target:,} {goal.unit}")
        found.append((*row, measured(goal, result), *about))
    return found
