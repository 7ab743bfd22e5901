"""Counts cycles of the machine on a simulated ATmega328P.

`vm_arduino/extras/bench/cycles.cpp` is the program that is measured.
"""

from __future__ import annotations

import sys
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from struct import pack
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "compiler"), str(ROOT)]

from tools.bench import avr_bench
from tools.bench.workloads import Work, check, code_of

BUDGET = 100  # jumps back in a call of `tick`: it may take 200,000 cycles
DONE = 2  # Status::kDone


class Counted(NamedTuple):
    """What the chip says of a run: values shown, jumps back, cycles in `tick` in all."""

    shown: list[int]
    jumps: int
    cycles: int


def count(code: bytes, readings: Sequence[int], budget: int, *more: str) -> Counted:
    request = pack(f"<BB{len(readings)}iH", budget, len(readings), *readings, len(code)) + code
    said = avr_bench.run(avr_bench.built("cycles", avr_bench.SOURCES, *more), request)
    found: dict[str, list[list[int]]] = defaultdict(list)
    for line in said:
        word, *numbers = line.split()
        found[word].append([int(number) for number in numbers])
    [[status]] = found["STATUS"]
    if status != DONE:
        raise RuntimeError(f"the program did not end, or a tick was too long: {said[-5:]}")
    return Counted(
        [value for (value,) in found["SHOW"]],
        found["JUMPS"][0][0],
        found["CYCLES"][0][0],
    )


def per_iteration(work: Work) -> float:
    """Return the cycles of a whole run, all but the robot, for each time around its loop."""
    counted = count(code_of(work), work.thousandths, BUDGET)
    check("ATmega328P", work, counted.shown)
    return counted.cycles / work.times
