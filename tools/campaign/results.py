"""The results of campaigns: `results.json`, and the table of `docs/en/guarantees.md`.

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

RESULTS_FILE = Path(__file__).with_name("results.json")
DOCUMENT = ROOT / "docs" / "en" / "guarantees.md"
OLD_MARK = ", old"
CODE_FOLDERS = ("compiler", "vm_arduino", "tests")  # folders whose changes make a figure old
TABLE_HEAD = ("name", "guarantee", "target", "measured", "seeds", "date", "commit")


class Result(NamedTuple):
    """A result: `done` tries in `seconds`, with seeds from `seed` up to but not including
    `next_seed`. `wrong`: the failure of the last piece, or "".
    """

    done: int
    seconds: float
    seed: int
    next_seed: int
    date: str
    commit: str
    wrong: str = ""


Results = dict[str, Result]


def read_results() -> Results:
    values_of_goal = json.loads(RESULTS_FILE.read_text(encoding="utf-8"))
    return {name: Result(**values) for name, values in values_of_goal.items()}


def write_results(results: Results) -> None:
    """Write a line for each result, in the order of the goals."""
    rows = (f'"{goal.name}": {json.dumps(results[goal.name]._asdict())}'
            for goal in GOALS if goal.name in results)  # fmt: skip
    replace(RESULTS_FILE, ("{\n" + ",\n".join(rows) + "\n}\n").encode())


def current_commit() -> str:
    """Return the commit of the code that is tested; with a `+` where it has changed since."""
    head = git("rev-parse", "--short=10", "HEAD").stdout.strip()
    return head + "+" * bool(git("status", "--porcelain", "--", *CODE_FOLDERS).stdout.strip())


def is_same_code(goal: Goal, commit: str, other_commit: str = "") -> bool:
    """Return whether two commits, or one and the current files, have the same code of a goal.

    A commit with a `+` equals no other, and neither does an unknown one.
    """
    commits = [name for name in (commit, other_commit) if name]
    is_known = "+" not in commit + other_commit
    return commit == other_commit or (
        is_known and not git("diff", "--quiet", *commits, "--", *goal.code).returncode
    )


def is_old(goal: Goal, result: Result) -> bool:
    """Return whether the code of a goal has changed since its figure.

    Without the project's commits this is unknown, and the document's word counts.
    """
    if git("rev-parse", "--is-shallow-repository").stdout.strip() != "false":
        return f"| {_figure(goal, result)}{OLD_MARK} |" in _row(goal, DOCUMENT.read_text("utf-8"))
    return not is_same_code(goal, result.commit)


def outdated_goals() -> list[str]:
    """Return the names of the goals whose figures are old."""
    results_by_goal = read_results()
    return [
        goal.name
        for goal in GOALS
        if goal.name in results_by_goal and is_old(goal, results_by_goal[goal.name])
    ]


def _row(goal: Goal, document: str) -> str:
    return next((row for row in document.splitlines() if row.startswith(f"| `{goal.name}` |")), "")


def git(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True)


def figure_text(goal: Goal, result: Result | None) -> str:
    """Return the figure, that it is less than the goal where it is, and whether it is old."""
    if result is None:
        return "not run yet"
    return _figure(goal, result) + OLD_MARK * is_old(goal, result)


def _figure(goal: Goal, result: Result) -> str:
    if result.wrong:
        return f"**wrong**: {result.wrong}"
    return f"{result.done:,}" + ("" if result.done >= goal.target else ": less")


def rows() -> list[tuple[str, ...]]:
    """Return the table of `docs/en/guarantees.md`."""
    results_by_goal = read_results()
    table_rows: list[tuple[str, ...]] = []
    for goal in GOALS:
        result = results_by_goal.get(goal.name)
        run_cells = ("", "", "")
        if result is not None:
            last_seed = max(result.seed, result.next_seed - goal.stride)
            seeds = (
                f"{result.seed}" if last_seed == result.seed else f"{result.seed} to {last_seed}"
            )
            run_cells = (
                "-" if "{seed}" not in goal.command else seeds,
                result.date,
                result.commit,
            )
        row = (f"`{goal.name}`", goal.guarantee, f"{goal.target:,} {goal.unit}")
        table_rows.append((*row, figure_text(goal, result), *run_cells))
    return table_rows
