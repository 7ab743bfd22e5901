"""Programs whose DEFs take values: the compiler and the machines agree with the oracle.

`python -m tests.oracle.test_values 100000` compares more programs than the tests, and the machine
in C++ as well.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Sequence
from functools import partial

import pytest

from tests.machines import MACHINES, Machine, Senses
from tests.machines.python import run_python
from tests.oracle.interpreter import PAPER_KIT, Mistake, run
from tests.oracle.task_programs import shared_program
from tests.support.campaign import each_seed, make_options
from tiniscript import compile_text, robots
from tiniscript.base.source import Source
from tiniscript.syntax.formatter import format_source

KIT = robots.load("tinibot").kit
MAX_MS = 300
BATCH_SIZE = 50
WHOLE_IN = 4  # one in so many programs is also compiled without the optimizer and formatted


def check_program(seed: int, machines: Sequence[Machine] = (run_python,)) -> str:
    """Compare the traces of one random program on some machines; return how it ended."""
    rng = random.Random(seed)
    text, readings = shared_program(rng)
    compilation = compile_text(text, KIT)
    try:
        expected = run(text, PAPER_KIT, readings, MAX_MS)
    except Mistake:  # calls too deep, or more copies than a machine accepts
        assert not compilation.is_right, f"seed {seed}, the oracle refuses:\n{text}"
        return "refused"
    assert compilation.is_right, f"seed {seed}, the oracle accepts:\n{text}"
    images = [compilation.image]
    if seed % WHOLE_IN == 0:
        images.append(compile_text(text, KIT, optimize=False).image)
        laid_out = format_source(Source(text))
        assert compile_text(laid_out, KIT).image == compilation.image, f"seed {seed}, formatted"
    for image in dict.fromkeys(images):
        for machine in machines:
            actual = machine(image, KIT, Senses(readings, MAX_MS))
            assert actual == expected, f"seed {seed}, {image.hex()}:\n{text}"
    return expected.split()[-1]


@pytest.mark.sampled("first", keep=3)
@pytest.mark.parametrize("first", range(0, 400, BATCH_SIZE))
def test_random_programs_agree(first: int) -> None:
    end_counts = Counter(check_program(seed) for seed in range(first, first + BATCH_SIZE))
    assert {"DONE", "LIMIT"} <= set(end_counts), end_counts


if __name__ == "__main__":
    both = [MACHINES[name] for name in ("python", "host")]
    each_seed(partial(check_program, machines=both), make_options(100_000, 0))
