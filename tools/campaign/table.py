"""The table of `docs/promises.md`: each goal, and what was reached."""

from __future__ import annotations

from tools.campaign.goals import GOALS, Goal
from tools.campaign.results import WRITTEN, Result, read

HEAD = ("goal", "promise", "tested by", "shall", "reached", "seeds", "date", "commit")


def reached(goal: Goal, result: Result | None) -> str:
    """Return the figure, and that it is less than the goal where it is."""
    if result is None:
        return "not run yet"
    if result.wrong:
        return f"**wrong**: {result.wrong}"
    return f"{result.done:,}" + ("" if result.done >= goal.shall else ": less")


def rows() -> list[tuple[str, ...]]:
    results = read(WRITTEN)
    found: list[tuple[str, ...]] = []
    for goal in GOALS:
        result = results.get(goal.name)
        words = goal.command.format(count=goal.shall, seed="N")
        about = ("", "", "")
        if result is not None:
            last = max(result.seed, result.next_seed - goal.stride)
            seeds = f"{result.seed}" if last == result.seed else f"{result.seed} to {last}"
            about = ("-" if "{seed}" not in goal.command else seeds, result.date, result.commit)
        shall = f"{goal.shall:,} {goal.unit}"
        row = (f"`{goal.name}`", goal.promise, f"`python -m {words}`", shall)
        found.append((*row, reached(goal, result), *about))
    return found
