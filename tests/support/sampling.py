"""Sampling of slow rows, on chips or of random programs: each commit runs a fair sample.

A test marked `sampled("chip")` keeps, of the rows that differ in `chip` alone, one that the commit
draws: every other value is in each run, each chip as often as the others, and every row in some.
`sampled("chip", keep=2)` keeps two. `sampled(of="bootloaders", keep=2)` keeps two of all tests that
are marked so, with their rows. `pytestmark = pytest.mark.sampled(files="sides", keep=3)` keeps
three whole files of all that have it: a browser opens no page for the others. Tests with the same
`draw` keep the same rows, so that fewer builds are needed for them. `some_of` samples the items
that one test goes through itself.

A test marked `long` takes long, and another one notices most of what it does: it is in the second
tier, which runs at the end of an issue and before a release. `--tenth` runs a tenth of that tier,
which the commit draws, too. `--whole` runs all; tests selected by `-k` or by name always run.
"""

from __future__ import annotations

import random
import subprocess
from collections import defaultdict
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import TypeVar

import pytest

from tests.support.casefile import ROOT

MARK = "sampled"
LONG_MARK = "long"
Row = TypeVar("Row")


def add_options(parser: pytest.Parser) -> None:
    parser.addoption("--whole", action="store_true", help="all rows, not the sample of this commit")
    parser.addoption("--tenth", action="store_true", help="a tenth of the long tests, too")
    parser.addoption("--sample", metavar="COMMIT", help="the sample that another commit draws")


def leave_out(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Deselect the rows that are not in the sample."""
    if config.getoption("--whole") or is_narrowed(config):
        return
    tests: dict[str, dict[str, list[pytest.Item]]] = defaultdict(lambda: defaultdict(list))
    for item in items:
        mark = _mark_of_rows(item)
        if mark is not None and "of" in mark.kwargs:
            tests[mark.kwargs["of"]][""].append(item)
        elif mark is not None:
            tests[item.nodeid.partition("[")[0]][_others(item, mark.args)].append(item)
    omitted_items = _long_left_out(config, items) | _files_left_out(config, items)
    for name, groups in tests.items():
        together = _mark(next(iter(groups.values()))).kwargs.get("draw", "")
        rng = random.Random(f"{seed(config)} {together or name}")
        turn = rng.randrange(1000)
        for rows in rng.sample(list(groups.values()), len(groups)):
            turn += not together
            chosen_items = {
                rows[(turn + k) % len(rows)] for k in range(_mark(rows).kwargs.get("keep", 1))
            }
            omitted_items |= set(rows) - chosen_items
    if omitted_items:
        items[:] = [item for item in items if item not in omitted_items]
        config.hook.pytest_deselected(items=list(omitted_items))


def _long_left_out(config: pytest.Config, items: list[pytest.Item]) -> set[pytest.Item]:
    """Return the long tests that this run leaves out, of files that the user did not name."""
    named_paths = _list_named_files(config)
    long_tests = [
        item
        for item in items
        if item.get_closest_marker(LONG_MARK) and item.path not in named_paths
    ]
    if not config.getoption("--tenth"):
        return set(long_tests)
    rng = random.Random(f"{seed(config)} {LONG_MARK}")
    return set(rng.sample(long_tests, len(long_tests) * 9 // 10))


def _files_left_out(config: pytest.Config, items: list[pytest.Item]) -> set[pytest.Item]:
    """Return the tests of whole files that are not drawn, of files that the user did not name."""
    files: dict[tuple[str, int], dict[Path, list[pytest.Item]]] = defaultdict(dict)
    for item in items:
        for mark in item.iter_markers(MARK):
            if "files" in mark.kwargs:
                items_by_path = files[mark.kwargs["files"], mark.kwargs["keep"]]
                items_by_path.setdefault(item.path, []).append(item)
    omitted_items: set[pytest.Item] = set()
    for (name, keep), items_by_path in files.items():
        rng = random.Random(f"{seed(config)} {name}")
        for path in rng.sample(sorted(items_by_path), len(items_by_path))[keep:]:
            omitted_items |= set(
                items_by_path[path] if path not in _list_named_files(config) else ()
            )
    return omitted_items


def _list_named_files(config: pytest.Config) -> set[Path]:
    return {Path(arg).resolve() for arg in config.args if arg.endswith(".py")}


def _mark_of_rows(item: pytest.Item) -> pytest.Mark | None:
    return next((mark for mark in item.iter_markers(MARK) if "files" not in mark.kwargs), None)


def _mark(rows: list[pytest.Item]) -> pytest.Mark:
    mark = _mark_of_rows(rows[0])
    assert mark is not None
    return mark


def sample_of(
    config: pytest.Config, sample_name: str, rows: Sequence[Row], keep: int = 1
) -> Sequence[Row]:
    """Return a sample of the rows that one test iterates over, in their order."""
    if config.getoption("--whole") or is_narrowed(config):
        return rows
    kept_indexes = random.Random(f"{seed(config)} {sample_name}").sample(range(len(rows)), keep)
    return [rows[k] for k in sorted(kept_indexes)]


def how_to_repeat(config: pytest.Config) -> str:
    """Return the command that repeats the rows of this run, or "" if it has all."""
    if config.getoption("--whole") or is_narrowed(config):
        return ""
    tenth = " --tenth" if config.getoption("--tenth") else ""
    return f"a sample: --sample {seed(config)}{tenth} draws the same again, --whole takes all"


def is_narrowed(config: pytest.Config) -> bool:
    keyword = config.option.keyword  # "not this one" selects none
    return (keyword and not keyword.startswith("not ")) or any("::" in arg for arg in config.args)


def seed(config: pytest.Config) -> str:
    """Return the seed of the sample: the commit, or `none` without a history."""
    return str(config.getoption("--sample") or _commit())


@lru_cache(maxsize=1)
def _commit() -> str:
    words = ["git", "-C", str(ROOT), "rev-parse", "--short=10", "HEAD"]
    try:
        completed = subprocess.run(words, capture_output=True, text=True)
    except OSError:
        return "none"
    # Without a commit, the sample would never change.
    if completed.returncode and (ROOT / ".git").exists():
        raise pytest.UsageError(
            f"This checkout has a history that cannot be read: {completed.stderr}"
        )
    return completed.stdout.strip() or "none"


def _others(item: pytest.Item, names: tuple[str, ...]) -> str:
    """Return the parameters that all rows have in common that differ in these alone."""
    assert isinstance(item, pytest.Function)
    params = dict(item.callspec.params)
    for name in names:
        params.pop(name)  # a KeyError means that the test has no such parameter
    return repr(sorted((name, repr(value)) for name, value in params.items()))
