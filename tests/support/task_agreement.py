"""Compares the compiler and the machines with the oracle on a random program with tasks."""

from __future__ import annotations

import random
from collections.abc import Sequence

from tests.machines import Machine, Senses
from tests.machines.python import run_python
from tests.oracle.interpreter import PAPER_KIT, Mistake, run
from tests.oracle.task_programs import task_program
from tiniscript import Compilation, compile_text, robots
from tiniscript.base.source import Source
from tiniscript.bytecode.image import unpack
from tiniscript.syntax.formatter import format_source

KIT = robots.load("tinibot").kit
MAX_MS = 600


def compare_task_program(
    seed: int, machines: Sequence[Machine] = (run_python,), needs: int = 0
) -> str:
    """Compare the traces of one random program on some machines; return how it ended.

    With the `needs` of a way, it has some.
    """
    rng = random.Random(seed)
    compilations: list[Compilation] = []
    while not compilations or unpack(compilations[0].image).needs & needs != needs:
        text, senses = task_program(rng, ways=needs != 0)
        compilations = [compile_text(text, KIT, optimize=optimize) for optimize in (True, False)]
        try:
            expected_trace = run(text, PAPER_KIT, senses, MAX_MS)
        except Mistake:  # DEFs that are called too deep in all tasks together
            assert not any(compilation.is_right for compilation in compilations), (
                f"seed {seed}:\n{text}"
            )
            compilations = []
            continue
        assert all(compilation.is_right for compilation in compilations), f"seed {seed}:\n{text}"
    for image in dict.fromkeys(
        compilation.image for compilation in compilations
    ):  # often they are the same
        for machine in machines:
            actual = machine(image, KIT, Senses(senses, MAX_MS))
            assert actual == expected_trace, f"seed {seed}, {image.hex()}:\n{text}"
    formatted_text = format_source(Source(text))
    assert compile_text(formatted_text, KIT).image == compilations[0].image, f"seed {seed}"
    assert format_source(Source(formatted_text)) == formatted_text, f"seed {seed}"
    return expected_trace.split()[-1]
