"""The difference between expected and actual results, by case.

Knows no process and no port.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import NamedTuple

from tiniscript.conformance.kit import MachineCase
from tiniscript.conformance.machine_process import Problem

AGREES, DIFFERS, LACKS = "agrees", "differs", "lacks"  # or the name of a Problem
LACKING_ANSWERS = (
    ["REFUSED UNKNOWN_NEEDS"],
    ["REFUSED OTHER_VERSION"],
)  # the second of a machine of 2.0
MAX_ENDLESS = 3  # answers that hang or flood, after which no more are awaited,
MAX_SILENT = 20  # and first runs without an answer, after which the machine is given up


class Verdict(NamedTuple):
    """`outcome` is AGREES, DIFFERS, LACKS, hang, crash, flood or more. `line` counts from 1;
    `expected_line` and `actual_line` are that line of the two answers, None after their ends."""

    name: str
    outcome: str
    line: int = 0
    expected_line: str | None = None
    actual_line: str | None = None
    detail: str = ""


def compare(name: str, wanted_rows: Sequence[str], given_rows: Sequence[str]) -> Verdict:
    """Return the first line that differs."""
    for index in range(max(len(wanted_rows), len(given_rows))):
        pair = [rows[index] if index < len(rows) else None for rows in (wanted_rows, given_rows)]
        if pair[0] != pair[1]:
            return Verdict(name, DIFFERS, index + 1, pair[0], pair[1])
    return Verdict(name, AGREES)


AskMachine = Callable[[str, int], Sequence[str]]


def verdicts(cases: Iterable[MachineCase], answer_of: AskMachine) -> Iterator[Verdict]:
    """Yield the verdict of each case.

    A machine that refuses the first case that needs something lacks it, and is asked for no other.
    `needs` has a bit for each thing.
    """
    endless_count = silent_count = answer_count = 0
    is_lacking_by_needs: dict[int, bool] = {}
    for case in cases:
        if any(
            is_lacking and needs & case.needs for needs, is_lacking in is_lacking_by_needs.items()
        ):
            yield Verdict(case.name, LACKS)
            continue
        try:
            answer = answer_of(case.request(), sum(len(row) + 2 for row in case.answer))
        except Problem as error:
            verdict = compare(case.name, case.answer, error.rows)
            yield verdict._replace(outcome=error.kind, detail=error.detail)
            endless_count += error.kind in ("hang", "flood")
            silent_count += not answer_count
            if endless_count == MAX_ENDLESS or silent_count == MAX_SILENT:
                return
        else:
            answer_count += 1
            if case.needs and case.needs not in is_lacking_by_needs:
                refuses = list(answer) in LACKING_ANSWERS and list(answer) != list(case.answer)
                is_lacking_by_needs[case.needs] = refuses
                if refuses:
                    yield Verdict(case.name, LACKS)
                    continue
            yield compare(case.name, case.answer, answer)
