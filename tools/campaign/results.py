"""What a campaign has reached: in the cache folder while it runs, in `results.json` for the
document.

A result belongs to the code with which it was reached: figures of other code are not added up.
"""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from shutil import which
from typing import NamedTuple

from tiniscript.files import cache_folder, replace
from tools.campaign.goals import GOALS

ROOT = Path(__file__).resolve().parent.parent.parent
WRITTEN = Path(__file__).with_name("results.json")
CODE = ("compiler", "vm_arduino", "tests")  # what a figure is about


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


def kept() -> Path:
    """Return where the results of this user are while campaigns run."""
    return cache_folder() / "campaign.json"


def read(path: Path) -> Results:
    """Return the results in a file; none where it is not there, or is not ours."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
        return {name: Result(**values) for name, values in found.items()}
    except (OSError, ValueError, TypeError, AttributeError):
        return {}


def write(path: Path, results: Results) -> None:
    ordered = {goal.name: results[goal.name]._asdict() for goal in GOALS if goal.name in results}
    path.parent.mkdir(parents=True, exist_ok=True)
    replace(path, (json.dumps(ordered, indent=2) + "\n").encode())


def commit() -> str:
    """Return the commit of the code that is tested; with a `+` where it has changed since."""
    head = _git("rev-parse", "--short=10", "HEAD")
    return head + "+" * bool(_git("status", "--porcelain", "--", *CODE))


def is_in_history(commit: str) -> bool:
    """Whether a commit leads to the one that is checked out: who has this can look at its code."""
    if "+" in commit:
        return False
    words = ["git", "merge-base", "--is-ancestor", commit, "HEAD"]
    return subprocess.run(words, cwd=ROOT, capture_output=True).returncode == 0


def has_history() -> bool:
    """Whether all commits that led here are on this computer."""
    return bool(which("git")) and _git("rev-parse", "--is-shallow-repository") == "false"


def is_same_code(one: str, other: str) -> bool:
    """Whether two commits have the same code; one with a `+` is like no other."""
    if one == other:
        return True
    if "+" in one + other:
        return False
    done = subprocess.run(["git", "diff", "--quiet", one, other, "--", *CODE], cwd=ROOT)
    return done.returncode == 0


def _git(*words: str) -> str:
    done = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True)
    return done.stdout.strip()
