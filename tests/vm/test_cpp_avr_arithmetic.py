"""A hundred thousand operations on a simulated ATmega328P, against `fixed_point.py`.

The chip makes the numbers itself, in the way that `pairs` does, and says a checksum for each block
of results. If one differs, the chip is asked for that block again, result by result.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator, Sequence
from itertools import cycle, islice
from struct import pack
from typing import NamedTuple

import pytest

from tests.support.cpp_checks import FAULT_NUMBER_BY_NAME, OPERATIONS, python_result
from tests.support.random_codes import EDGES
from tiniscript.base import fixed_point
from tiniscript.bytecode.opcodes import BY_NAME
from tools.bench import avr_bench

BLOCK, BLOCKS = 500, 50  # codes per seed, and number of seeds
NO_BLOCK = 0xFFFF

needs_chip = pytest.mark.skipif(
    bool(avr_bench.missing_reason()),
    reason=avr_bench.missing_reason() or "there is a simulated chip",
)


class Operation(NamedTuple):
    name: str
    a: int
    b: int

    def result(self) -> tuple[int, int]:
        """Return the number of the fault, or 0, and Python's result."""
        if self.name != "RANDOM":
            return python_result(self.name, self.a, self.b)
        state = fixed_point.next_random(self.b % 2**32 | 1)
        try:
            return 0, fixed_point.random_between(self.a, self.b, state)
        except fixed_point.Fault as fault:
            return FAULT_NUMBER_BY_NAME[fault.name], 0


def numbers(state: int) -> Iterator[int]:
    """Yield numbers of any size, as many small ones as large ones; one in 8 is an edge."""
    while True:
        state = fixed_point.next_random(state)
        choice = state >> 24
        state = fixed_point.next_random(state)
        if choice < 32:
            yield EDGES[(state >> 8) % len(EDGES)]
        else:
            yield (state - (state >> 31 << 32)) >> (choice & 31)


def operations(seed: int, blocks: int) -> list[Operation]:
    number_stream = numbers(seed)
    names = islice(cycle(OPERATIONS), BLOCK * blocks)
    return [
        Operation(name, next(number_stream), second(name, next(number_stream))) for name in names
    ]


def second(name: str, b: int) -> int:
    """Return the second value: of ROUND, every other time from -8 to 8 decimals."""
    return (b & 0x3FFF) - 0x2000 if name == "ROUND" and b & 1 else b


def chip(seed: int, blocks: int, detailed: int = NO_BLOCK) -> list[str]:
    """Return the checksum of each block; or those before `detailed`, and each of its results."""
    codes = [BY_NAME[name].code for name in OPERATIONS]
    request = pack("<IHHH", seed, blocks, BLOCK, detailed)
    request += bytes((len(codes), *codes, len(EDGES))) + pack(f"<{len(EDGES)}i", *EDGES)
    return avr_bench.run(avr_bench.build("arithmetic"), request)


def checksum(block: Sequence[Operation]) -> int:
    return zlib.crc32(b"".join(pack("<Bi", *operation.result()) for operation in block))


def compare(seed: int, blocks: int = BLOCKS) -> None:
    """Assert that the chip calculates like Python, or name the operation."""
    all_operations = operations(seed, blocks)
    results = [int(line) for line in chip(seed, blocks)]
    assert len(results) == blocks
    for number, theirs in enumerate(results):
        block = all_operations[number * BLOCK : (number + 1) * BLOCK]
        if checksum(block) == theirs:
            continue
        for operation, line in zip(block, chip(seed, blocks, number)[number:], strict=True):
            fault, result = map(int, line.split())
            assert operation.result() == (fault, result), (
                f"{operation.name} {operation.a} {operation.b}"
            )
        raise AssertionError(f"the checksum of block {number} alone is wrong")


def test_there_are_operations_of_every_kind() -> None:
    all_operations = operations(1, BLOCKS)
    pairs = {(operation.a, operation.b) for operation in all_operations}
    assert len(pairs) > 0.95 * len(all_operations)
    assert {operation.a for operation in all_operations} >= set(EDGES)
    for name in OPERATIONS:
        sizes = {
            abs(operation.a).bit_length() for operation in all_operations if operation.name == name
        }
        assert sizes >= set(range(32)), name
    faults = {(operation.name, operation.result()[0]) for operation in all_operations}
    assert {("MUL", 1), ("DIV", 1), ("DIV", 2), ("MOD", 2), ("NEG", 1)} <= faults


@needs_chip
@pytest.mark.sampled("seed", keep=2)
@pytest.mark.parametrize("seed", range(1, 5))
def test_arithmetic_agrees(seed: int) -> None:
    """25,000 operations for each seed; a hundred thousand in all."""
    compare(seed)
