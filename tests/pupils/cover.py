"""Few programs of the corpus that reach each branch which all of them reach.

python -m tests.pupils.cover    chooses them again, in some minutes, and writes `cover.txt`

A commit is tested with these; `python -m tools.campaign pupils`, or `--whole`, takes all. It also
includes the first programs that `--accept` pins. Select them again when other programs come or go,
or when the code that judges them has changed so much that a fiftieth of its branches may differ: a
test reports this.
"""

from __future__ import annotations

import ast
import hashlib
import heapq
import re
from collections.abc import Iterable, Sequence
from functools import cache
from pathlib import Path

from tests.pupils.corpus import FOLDER, Entry, check, current_entry, entries
from tests.support.casefile import ROOT

PACKAGE = ROOT / "compiler" / "tiniscript"
JUDGES = ("recovery/*.py", "diagnostics/*.py", "semantics/checker.py", "syntax/*.py")
LIST = FOLDER / "cover.txt"
HEAD = re.compile(r"# \d+ of \d+ programs reach the same (\d+) branches; (\d+) forks, (\w+)")
OTHER = 50  # one of so many branches may be new
Branch = tuple[str, int, int]
_FORKS = (ast.If, ast.IfExp, ast.For, ast.While, ast.BoolOp, ast.comprehension, ast.ExceptHandler)


@cache
def list_covering_entries() -> tuple[Entry, ...]:
    """Return the entries that each commit is tested with."""
    names = {row.partition(" ")[0] for row in LIST.read_text(encoding="utf-8").splitlines()}
    return tuple(entry for entry in entries() if name_of(entry.program) in names)


def name_of(program: str) -> str:
    return hashlib.sha256(program.encode()).hexdigest()[:8]


def judges() -> list[Path]:
    return sorted(path for judge in JUDGES for path in PACKAGE.glob(judge))


def forks(sources: Iterable[str]) -> int:
    """Return the number of branching places in the code."""
    return sum(isinstance(node, _FORKS) for text in sources for node in ast.walk(ast.parse(text)))


def head(chosen: int, branches: int, programs: Sequence[str]) -> str:
    its_forks = forks(path.read_text(encoding="utf-8") for path in judges())
    return _head(chosen, branches, programs, its_forks)


def _head(chosen: int, branches: int, programs: Sequence[str], its_forks: int) -> str:
    return (f"# {chosen} of {len(programs)} programs reach the same {branches} branches; "
            f"{its_forks} forks, {_name_of_all(programs)}")  # fmt: skip


def _name_of_all(programs: Sequence[str]) -> str:
    return name_of("".join(sorted(map(name_of, programs))))


def add(added: Sequence[str], programs: Sequence[str]) -> None:
    """Take new programs into the list of chosen ones, until all are chosen again."""
    first, *rows = LIST.read_text(encoding="utf-8").splitlines()
    written_match = HEAD.match(first)
    if (
        not added
        or not written_match
        or written_match[3] != _name_of_all([entry for entry in programs if entry not in added])
    ):
        return  # entries were added or removed
    rows += map(_row, added)
    first = _head(len(rows), int(written_match[1]), programs, int(written_match[2]))
    LIST.write_text("\n".join((first, *rows)) + "\n", encoding="utf-8")
    list_covering_entries.cache_clear()


def _row(program: str) -> str:
    return f"{name_of(program)} {program.splitlines()[0].strip()}"


def why_stale(written_text: str, now: str) -> str:
    """Return the reason to choose the programs again, or ""."""
    match_before, match_after = HEAD.match(written_text), HEAD.match(now)
    assert match_before and match_after, "its first line says of what it is"
    if match_before[3] != match_after[3]:
        return "programs have come or gone"
    moved = abs(int(match_after[2]) - int(match_before[2]))
    return "the code has other branches" if moved * OTHER > int(match_before[2]) else ""


def list_reached_branches(programs: Sequence[Entry]) -> list[frozenset[Branch]]:
    """Return the branches that each program reaches when checked and repaired."""
    from coverage import Coverage

    files = [str(path) for path in judges()]
    measured_coverage = Coverage(data_file=None, branch=True, include=files, config_file=False)
    branches = []
    for entry in programs:
        check.cache_clear()
        measured_coverage.erase()
        measured_coverage.start()
        try:
            current_entry(entry)
        finally:
            measured_coverage.stop()
        data = measured_coverage.get_data()
        branches.append(frozenset(
            (file, *arc) for file in data.measured_files() for arc in data.arcs(file) or ()
        ))  # fmt: skip
    return _branches(branches)


def _branches(branches: Sequence[frozenset[Branch]]) -> list[frozenset[Branch]]:
    """Return the steps between lines at which there was a choice."""
    ways: dict[tuple[str, int], set[int]] = {}
    for file, start, end in frozenset().union(*branches):
        ways.setdefault((file, start), set()).add(end)
    is_branch = {position for position, targets in ways.items() if len(targets) > 1}
    return [frozenset(arc for arc in arcs if arc[:2] in is_branch) for arcs in branches]


def choose_cover(
    branches: Sequence[frozenset[Branch]], covered_before: Iterable[int] = ()
) -> list[int]:
    """Return the numbers of a few sets whose union is that of all.

    Each adds the most branches; of equals, one of `covered_before` is chosen: little changes.
    """
    chosen_before, uncovered = set(covered_before), set().union(*branches)
    heap = [(-len(branch_set), k not in chosen_before, k) for k, branch_set in enumerate(branches)]
    heapq.heapify(heap)
    chosen = []
    while uncovered:
        _, is_new, k = heapq.heappop(heap)
        gain = len(branches[k] & uncovered)
        if heap and (-gain, is_new, k) > heap[0]:
            heapq.heappush(heap, (-gain, is_new, k))
            continue
        chosen.append(k)
        uncovered -= branches[k]
    return sorted(chosen)


def main() -> None:
    programs = entries()
    known_entries = set(list_covering_entries()) if LIST.exists() else set()
    current_entry(programs[0])  # caches filled by the first program count for none
    branches = list_reached_branches(programs)
    chosen = choose_cover(
        branches, [k for k, entry in enumerate(programs) if entry in known_entries]
    )
    first = head(
        len(chosen), len(frozenset().union(*branches)), [program.program for program in programs]
    )
    rows = (_row(programs[k].program) for k in chosen)
    LIST.write_text("\n".join((first, *rows)) + "\n", encoding="utf-8")
    list_covering_entries.cache_clear()
    print(first[2:].partition(";")[0] + ".")


if __name__ == "__main__":
    main()
