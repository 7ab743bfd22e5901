"""The kit notices machines that have read the specification quickly: each by the case it names.

`faults.txt` has the faults; a fault that no case notices is a hole of the kit.
"""

from __future__ import annotations

from functools import lru_cache

import pytest

from tests.conform.faulty import Fault, faults, machine_with
from tools.generate.machine_kit import Run, answer_of, runs


@lru_cache(maxsize=1)
def runs_by_name() -> dict[str, Run]:
    return {run.name: run for run in runs()}


@pytest.mark.parametrize("fault", [pytest.param(fault, id=fault.says) for fault in faults()])
def test_each_fault_fails_its_case(fault: Fault) -> None:
    run = runs_by_name()[fault.noticed_by]
    right_answer = answer_of(run)
    assert right_answer is not None
    with machine_with(fault) as module:
        parts = {name: module[name] for name in ("load_image", "machine_of") if name in module}
        try:
            answer = answer_of(run, **parts)
        except (LookupError, AssertionError):  # the machine has crashed
            answer = []
    assert answer != right_answer
    assert answer_of(run) == right_answer, "a fault stays behind"


def test_each_fault_is_different() -> None:
    assert len({fault.says for fault in faults()}) == len({fault.changes for fault in faults()})
    assert len(faults()) == len({fault.says for fault in faults()})
