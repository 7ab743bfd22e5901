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

from tiniscript.bytecode.disassembly import rows
from tiniscript.bytecode.opcodes import BY_NAME
from tools.bench import avr_bench
from tools.bench.workloads import Work, check, code_of

BUDGET = 250  # instructions in a call of `tick`
SKETCH_BUDGET = 32  # as kBudget in src/main.cpp
DONE = 2  # Status::kDone

# What arithmetic is measured with: pairs as they come in a classroom, in thousandths.
PAIRS = (
    (3_000, 4_000), (12_500, 2_000), (100_000, 7_000), (500, 250), (-7_000, 3_000),
    (50_000, -8_000), (255_000, 10_000), (1_023_000, 4_000), (33_333, 3_000), (80_000, 1_500),
    (-750, -2_000), (1_000_000, 9_000), (5_000, 100), (360_000, 2_500), (17_000, 100_000),
    (9_810, 6_000),
)  # fmt: skip
ARITHMETIC = ("ADD", "SUB", "MUL", "DIV", "MOD", "LT")


class Counted(NamedTuple):
    """What the chip says: cycles in `tick` in all, and of one `tick` that runs nothing."""

    shown: list[int]
    steps: int
    cycles: int
    empty_tick: int
    each: list[tuple[int, int]]  # offset of an instruction and its cycles; with a budget of 1


def count(code: bytes, readings: Sequence[int], budget: int) -> Counted:
    request = pack(f"<BB{len(readings)}iH", budget, len(readings), *readings, len(code)) + code
    said = avr_bench.run(avr_bench.built("cycles"), request)
    found: dict[str, list[list[int]]] = defaultdict(list)
    for line in said:
        word, *numbers = line.split()
        found[word].append([int(number) for number in numbers])
    [[status]] = found["STATUS"]
    if status != DONE:
        raise RuntimeError(f"the program did not end, or a tick was too long: {said[-5:]}")
    return Counted(
        [value for (value,) in found["SHOW"]],
        found["STEPS"][0][0],
        found["CYCLES"][0][0],
        found["TICK"][0][0],
        [(offset, cycles) for offset, cycles in found["AT"]],
    )


def per_iteration(work: Work, budget: int = BUDGET) -> float:
    """Return the cycles of a whole run, all but the robot, for each time around its loop."""
    counted = count(code_of(work), work.thousandths, budget)
    check("ATmega328P", work, counted.shown, counted.steps)
    return counted.cycles / work.times


def of_instructions(work: Work) -> dict[str, float]:
    """Return the mean cycles of each instruction in the loop of a work, its first 20 times."""
    short = work._replace(times=20)
    code = code_of(short)
    names = {row.offset: row.op.name for row in rows(code) if row.op}
    found: dict[str, list[int]] = defaultdict(list)
    for offset, cycles in count(code, short.thousandths, 1).each:
        if offset in names:
            found[names[offset]].append(cycles)
    return {name: sum(each) / len(each) for name, each in found.items() if len(each) >= 20}


def of_arithmetic(name: str) -> list[int]:
    """Return the cycles of an instruction with each of PAIRS, sorted."""
    code = b""
    push, op, take = (BY_NAME[each].code for each in ("PUSH32", name, "SET_VAR"))
    ends = []
    for a, b in PAIRS:
        code += pack("<BiBi", push, a, push, b)
        ends.append(len(code))
        code += bytes((op, take, 0))
    cycles = dict(count(code, (), 1).each)
    return sorted(cycles[offset] for offset in ends)
