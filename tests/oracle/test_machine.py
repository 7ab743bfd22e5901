"""The machines agree with the one that is written from `bytecode_spec.md` alone.

`python -m tests.oracle.test_machine 10000` runs more than the tests.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence

import pytest

from tests.machines import Senses
from tests.machines.python import run_python
from tests.oracle import machine, programs
from tests.support.campaign import make_options
from tests.support.cpp_checks import check_round, python_verdict, run_late
from tests.support.images import image_for
from tests.support.kits import KITS
from tests.support.random_codes import random_codes
from tests.support.rows import each_row
from tiniscript import compile_text
from tiniscript.bytecode.image import unpack

MAX_MS, MAX_STEPS = 20_000, 5000


def assert_same_trace(code: bytes, number: int, readings: dict[str, list[int]], seed: int) -> str:
    """Assert that both machines print the same; return the last line.

    The point where one of them gives up a loop that takes no time is not part of the meaning: then
    only their output up to there must be the same.
    """
    oracle_kit, kit = KITS[number]
    senses = Senses(readings, MAX_MS, MAX_STEPS, seed)
    actual = run_python(image_for(code, kit), kit, senses).splitlines()
    lines = machine.trace(code, oracle_kit, readings, MAX_MS, seed, MAX_STEPS).splitlines()
    if lines[-1].endswith(machine.TOO_MANY) or (actual[-1] != lines[-1] and "LIMIT" in actual[-1]):
        common_count = min(len(actual), len(lines)) - 1
        actual, lines = actual[:common_count], lines[:common_count]
    assert actual == lines, f"{code.hex(' ')}, seed {seed}"
    return lines[-1].split(" ", 1)[1] if lines else ""


def codes(seed: int, count: int) -> Iterator[tuple[bytes, int, dict[str, list[int]], int]]:
    """Yield random programs and random code that is accepted, each with a robot's readings."""
    rng = random.Random(seed)
    damaged_bytes = random_codes(seed, 10**9)
    for number in range(count):
        kit_index = number % 2
        oracle_kit, kit = KITS[kit_index]
        sizes = len(kit.readings), len(kit.actuators)
        if rng.random() < 0.5:
            code = compile_text(programs.program(rng, oracle_kit), kit).code
        else:
            code = next(code for code in damaged_bytes if python_verdict(code, *sizes) == (0, 0))
        yield code, kit_index, dict(programs.senses(rng, oracle_kit)), rng.randrange(1, 2**32)


@pytest.mark.sampled("seed")
@pytest.mark.parametrize("seed", range(4))
def test_traces_agree(seed: int) -> None:
    endings = {assert_same_trace(*code) for code in codes(seed, 500)}
    assert {"DONE", "LIMIT", "FAULT OVERFLOW", "FAULT DIVIDE_BY_ZERO"} <= endings


@each_row("seed", [1, 7, 2**31, 2**32 - 1])
def test_random_numbers_agree(seed: int) -> None:
    text = "LOOP(50); SHOW(RANDOM(1, 6)); SHOW(RANDOM(100, -1000.5)); END_LOOP"
    assert assert_same_trace(compile_text(text, KITS[0][1]).code, 0, {}, seed) == "DONE"


def test_late_calls_agree() -> None:
    """Delays from 0 to 40 ms, of which a program's own clock makes up 20."""
    lines = 0
    late_ms = [waited * 7 % 41 for waited in range(1, MAX_STEPS)]
    for code, number, readings, seed in codes(2, 500):
        oracle_kit, kit = KITS[number]
        senses = Senses(readings, MAX_MS, seed=seed)
        actual = run_late(image_for(code, kit), kit, senses, late_ms).splitlines()
        trace = machine.trace(
            code,
            oracle_kit,
            readings,
            MAX_MS,
            seed,
            MAX_STEPS,
            lambda waited_ms, _: late_ms[waited_ms - 1],
        ).splitlines()
        assert trace[: len(actual)] == actual or trace[:-1] == actual[: len(trace) - 1], code.hex(
            " "
        )
        lines += min(len(actual), len(trace) - 1)
    assert lines > 5000


def test_a_watched_move_may_last_longer_than_the_clock() -> None:
    """The page's machine and Python's: where the clock wraps around."""

    def page(image: bytes, kit: object, senses: Senses, late_ms: Sequence[int]) -> str:
        code, oracle_kit = unpack(image).code, KITS[0][0]
        lines = machine.trace(
            code, oracle_kit, senses.readings, 2**33, late_ms=lambda k, _: late_ms[k - 1]
        )
        return lines.removesuffix("4294967510 DONE\n")

    check_round(run_late)
    check_round(page)


if __name__ == "__main__":
    options = make_options(10_000, 5000)
    for one in codes(options.seed, options.count):
        assert_same_trace(*one)
