"""Programs at random, compiled, with the trace that the oracle wants."""

from __future__ import annotations

import random
from typing import NamedTuple

from tests.machines import Senses
from tests.oracle import interpreter, programs
from tests.support.kits import KITS
from tiniscript import Compilation, compile_text
from tiniscript.base.kit import Kit

MAX_MS, MAX_STEPS = 20_000, 20_000


class RandomProgram(NamedTuple):
    """A text, with the trace that the oracle wants."""

    seed: int
    text: str
    kit: Kit
    senses: Senses
    expected_trace: str
    short_compilation: Compilation
    plain_compilation: Compilation  # the program without optimization


def random_program(seed: int) -> RandomProgram:
    rng = random.Random(seed)
    oracle_kit, kit = KITS[seed % len(KITS)]
    text = programs.program(rng, oracle_kit)
    readings = programs.senses(rng, oracle_kit)
    expected_run = interpreter.run(text, oracle_kit, readings, MAX_MS, MAX_STEPS, seed + 1)
    senses = Senses(readings, MAX_MS, MAX_STEPS, seed + 1)
    short_compilation = compile_text(text, kit)
    plain_compilation = compile_text(text, kit, optimize=False)
    return RandomProgram(
        seed, text, kit, senses, expected_run, short_compilation, plain_compilation
    )
