"""Counts cycles of the machine on a simulated ATmega328P.

`vm_arduino/extras/bench/cycles.cpp` is the program that is measured.
"""

from __future__ import annotations

import sys
from collections import defaultdict
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from struct import pack
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "compiler"), str(ROOT)]

from tiniscript.bytecode.opcodes import BY_NAME
from tools.bench import avr_bench
from tools.bench.workloads import Work, WrongResult, check, code_of, driven

BUDGET = 100  # jumps back in a call of `tick`: it may take 200,000 cycles
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
    """What the chip says of a run: values shown, motors, jumps back, cycles in `tick` in all."""

    shown: list[int]
    driven: tuple[int, int]
    jumps: int
    cycles: int


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
        (found["LEFT"][0][0], found["RIGHT"][0][0]),
        found["JUMPS"][0][0],
        found["CYCLES"][0][0],
    )


def per_iteration(work: Work) -> float:
    """Return the cycles of a whole run, all but the robot, for each time around its loop."""
    counted = count(code_of(work), work.thousandths, BUDGET // 2 if work.has_robot else BUDGET)
    check("ATmega328P", work, counted.shown)
    if counted.driven != driven(work):
        raise WrongResult(f"ATmega328P, work {work.name}: motors {counted.driven}")
    return counted.cycles / work.times


def of_arithmetic(name: str) -> list[int]:
    """Return the cycles of an instruction with each of PAIRS, sorted."""
    return sorted(_cycles(pair, name) - _cycles(pair[:1]) - _of_push() for pair in PAIRS)


@cache
def _of_push() -> int:
    """Return the cycles of PUSH32: twice as many take twice as long."""
    one, two, three = (_cycles((0,) * count) for count in (1, 2, 3))
    assert three - two == two - one
    return two - one


def _cycles(values: Sequence[int], name: str = "") -> int:
    """Return the cycles of code that pushes values, does an instruction, and keeps the top."""
    push, take = (BY_NAME[each].code for each in ("PUSH32", "SET_VAR"))
    code = b"".join(pack("<Bi", push, value) for value in values)
    code += bytes([BY_NAME[name].code]) if name else b""
    return count(code + bytes((take, 0)), (), BUDGET).cycles
