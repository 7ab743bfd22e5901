"""Breakpoints cost nothing if none is set: cycles of the machine on a simulated Mega."""

from __future__ import annotations

from struct import pack

import pytest

from tools.bench import avr_bench, workloads
from tools.bench.machine import JUMP_BUDGET
from tools.bench.workloads import Workload, code_of

pytestmark = pytest.mark.skipif(bool(avr_bench.missing_reason()), reason=avr_bench.missing_reason())


def cycles(work: Workload, *flags: str) -> tuple[list[str], int]:
    """Return the values that a Mega shows, and the cycles of all ticks."""
    code = code_of(work)
    readings = work.thousandths
    request = pack(f"<BB{len(readings)}iH", JUMP_BUDGET, len(readings), *readings, len(code)) + code
    program = avr_bench.build("cycles", avr_bench.SOURCES, *flags, chip="atmega2560")
    *shown_texts, count, _ = avr_bench.run(program, request, "atmega2560")
    return shown_texts, int(count.split()[1])


@pytest.mark.parametrize("work", workloads.WORKLOADS, ids=lambda work: work.name)
def test_a_mega_with_breakpoints_is_as_fast_as_one_without(work: Workload) -> None:
    assert cycles(work) == cycles(work, "-Dtiniscript_without_breakpoints")
