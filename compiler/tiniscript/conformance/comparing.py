"""What differs between what was wanted and what came: a value for each case.

Knows no process and no port.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import NamedTuple

from tiniscript.conformance.kit import MachineCase
from tiniscript.conformance.machine_process import Problem

AGREES, DIFFERS, LACKS = "agrees", "differs", "lacks"  # or what a Problem says
LACKING_ANSWERS = (
    ["REFUSED UNKNOWN_NEEDS"],
    ["REFUSED OTHER_VERSION"],
)  # the second of a machine of 2.0
MOST_ENDLESS = 3  # answers that hang or flood; then nobody waits for more of them,
MOST_SILENT = 20  # nor for a machine whose first so many runs gave no answer


class Verdict(NamedTuple):
    """`what` is AGREES, DIFFERS, LACKS, hang, crash, flood or more. `line` counts from 1; `want`
    and `got` are that line of the two answers, None after their ends."""

    name: str
    what: str
    line: int = 0
    want: str | None = None
    got: str | None = None
    detail: str = ""


def compare(name: str, wanted_rows: Sequence[str], rows_got: Sequence[str]) -> Verdict:
    """Return the first line that differs."""
    for number in range(max(len(wanted_rows), len(rows_got))):
        pair = [rows[number] if number < len(rows) else None for rows in (wanted_rows, rows_got)]
        if pair[0] != pair[1]:
            return Verdict(name, DIFFERS, number + 1, pair[0], pair[1])
    return Verdict(name, AGREES)


Ask = Callable[[str, int], Sequence[str]]


def verdicts(cases: Iterable[MachineCase], answer_of: Ask) -> Iterator[Verdict]:
    """Yield the verdict of each case, up to where nobody waits for more.

    A machine that refuses the first case that needs something lacks it, and is asked for no other.
    `needs` has a bit for each thing.
    """
    endless = silent = answers = 0
    lacks: dict[int, bool] = {}
    for case in cases:
        if any(is_missing and needs & case.needs for needs, is_missing in lacks.items()):
            yield Verdict(case.name, LACKS)
            continue
        try:
            answer = answer_of(case.request(), sum(len(row) + 2 for row in case.answer))
        except Problem as problem:
            verdict = compare(case.name, case.answer, problem.rows)
            yield verdict._replace(what=problem.kind, detail=problem.detail)
            endless += problem.kind in ("hang", "flood")
            silent += not answers
            if endless == MOST_ENDLESS or silent == MOST_SILENT:
                return
        else:
            answers += 1
            if case.needs and case.needs not in lacks:
                refuses = list(answer) in LACKING_ANSWERS and list(answer) != list(case.answer)
                lacks[case.needs] = refuses
                if refuses:
                    yield Verdict(case.name, LACKS)
                    continue
            yield compare(case.name, case.answer, answer)
