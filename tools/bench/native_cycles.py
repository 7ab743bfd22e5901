"""Counts cycles of the works as C, compiled for a simulated ATmega328P.

`vm_arduino/extras/bench/native.cpp` is the program that is measured: with the flags of the
machine, and numbers in RAM.
"""

from __future__ import annotations

import sys
from itertools import cycle, islice
from pathlib import Path
from struct import pack

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "compiler"), str(ROOT)]

from tools.bench import avr_bench, interpreters
from tools.bench.workloads import Work, WrongResult, driven, expected

# Where `native.cpp` has them, with whole numbers and with thousandths.
WHOLE = {"A": 0, "A2": 1, "B": 2, "C": 3, "D": 5, "E": 6, "F": 7}
THOUSANDTHS = {"C": 4}
READINGS = 8


def per_iteration(work: Work, has_thousandths: bool = False) -> float:
    """Return the cycles of one time around the loop. Raises WrongResult."""
    number = (THOUSANDTHS if has_thousandths else WHOLE)[work.name]
    readings = work.thousandths if has_thousandths else work.readings
    told = list(islice(cycle(readings or [0]), READINGS))
    request = pack(f"<BH{READINGS}i", number, work.times, *told)
    said = [line.split() for line in avr_bench.run(avr_bench.built("native"), request)]
    shown = [int(number) for word, number in said if word == "SHOW"]
    found = {word: int(number) for word, number in said}
    if shown != wanted(work, has_thousandths):
        raise WrongResult(f"C alone, work {work.name}: {shown}")
    if (found["LEFT"], found["RIGHT"]) != driven(work) or found["UNDONE"]:
        raise WrongResult(f"C alone, work {work.name}: {found}")
    return found["CYCLES"] / work.times


def wanted(work: Work, has_thousandths: bool) -> list[int]:
    """Return what is to be shown: a quotient of whole numbers has no places."""
    if has_thousandths:
        return list(expected(work).shown)
    if work.name in THOUSANDTHS:
        return interpreters.expected(work)
    return [value // 1000 for value in expected(work).shown]
