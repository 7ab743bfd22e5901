"""Random programs: the compiler and the machine agree with the oracle, trace by trace.

The oracle is an interpreter of its own, written from the language reference alone: it shares no
line with the compiler. `python -m tests.vm.test_agreement 100000` runs a campaign.
"""

from __future__ import annotations

import random

import pytest

from tests.machines import MACHINES, ONE_IN, Machine
from tests.oracle import interpreter, programs
from tests.support.campaign import each_seed, make_options
from tests.support.kits import KITS
from tests.support.random_programs import MAX_MS, MAX_STEPS, RandomProgram, random_program
from tests.support.vm_agreement import are_equivalent
from tiniscript import compile_text
from tiniscript.base.source import Source
from tiniscript.bytecode.disassembly import assemble, disassemble
from tiniscript.bytecode.opcodes import BY_NAME
from tiniscript.bytecode.verify import verify
from tiniscript.diagnostics.rendering import as_text, message
from tiniscript.syntax.formatter import format_source

BATCH_SIZE = 125
PUSH32_BYTES = BY_NAME["PUSH32"].size
BATCH_COUNT = 160  # batches of the tests, of which a commit runs one; a campaign runs more


def check_machine(program: RandomProgram, name: str, machine: Machine) -> None:
    """Check that a machine agrees with the oracle."""
    for suffix, image in (
        ("", program.short_compilation.image),
        (", plain", program.plain_compilation.image),
    ):
        trace = machine(image, program.kit, program.senses)
        assert are_equivalent(program.expected_trace, trace), (
            f"{name}, seed {program.seed}{suffix}:\n{program.text}"
        )


def check_program(seed: int) -> None:
    """Everything that must hold for one random program."""
    program = random_program(seed)
    _, text, kit, _, _, short, plain = program
    assert short.is_right, text
    for name, machine in MACHINES.items():
        if seed % ONE_IN.get(name, 1) == 0:
            check_machine(program, name, machine)
    # a calculated constant of 32 bits may take more than the short ones that it is made of
    assert len(short.code) <= len(plain.code) + PUSH32_BYTES
    assert assemble(disassemble(short.code)) == short.code
    laid_out = format_source(Source(text))
    assert compile_text(laid_out, kit).image == short.image, f"seed {seed}, formatted:\n{text}"
    assert format_source(Source(laid_out)) == laid_out


def check_broken(seed: int) -> None:
    """Both refuse a broken text, or neither does, and there is always a message."""
    rng = random.Random(seed)
    oracle_kit, kit = KITS[seed % len(KITS)]
    text = programs.break_text(rng, programs.program(rng, oracle_kit))
    try:
        oracle_run = interpreter.run(text, oracle_kit, {}, MAX_MS, MAX_STEPS, 1)
    except interpreter.Mistake:
        oracle_run = None
    compilation = compile_text(text, kit)
    for language in ("en", "es"):
        for diagnostic in compilation.diagnostics[:5]:
            assert as_text(
                message(diagnostic, compilation.source, language), compilation.source, language
            )
    if oracle_run is None:
        assert not compilation.is_right or reads_more(text), f"seed {seed}, oracle refuses:\n{text}"
    else:
        assert compilation.is_right, f"seed {seed}, oracle accepts:\n{text}"
        verify(compilation.code, len(kit.readings), len(kit.actuators))


def reads_more(text: str) -> bool:
    """Return whether a text has dashes and blanks that only the compiler reads."""
    dashes, blanks = "\u2010\u2011\u2012\u2013\u2014\u2015\u2212", "\f\v\u200b\u2028\u3000\ufeff"
    return any(letter in text for letter in dashes + blanks)


def batches() -> list[range]:
    return [range(number * BATCH_SIZE, (number + 1) * BATCH_SIZE) for number in range(BATCH_COUNT)]


@pytest.mark.sampled("seeds")
@pytest.mark.parametrize("seeds", batches(), ids=lambda seeds: f"from {seeds.start}")
def test_random_programs_agree(seeds: range) -> None:
    for seed in seeds:
        check_program(seed)


@pytest.mark.sampled("seeds")
@pytest.mark.parametrize("seeds", batches(), ids=lambda seeds: f"from {seeds.start}")
def test_broken_programs_are_reported_and_right_ones_agree(seeds: range) -> None:
    for seed in seeds:
        check_broken(seed)


@pytest.mark.sampled("part")
@pytest.mark.parametrize("part", range(128))
def test_the_compiler_never_produces_code_that_verify_refuses(part: int) -> None:
    """10^5 random programs in all, 780 of them on a commit; optimised or not."""
    for number in range(782):
        seed = 1_000_000 + part * 782 + number
        rng = random.Random(seed)
        oracle_kit, kit = KITS[seed % len(KITS)]
        compilation = compile_text(programs.program(rng, oracle_kit), kit, optimize=seed % 3 > 0)
        assert compilation.is_right
        verify(compilation.code, len(kit.readings), len(kit.actuators))


def check_both(seed: int) -> None:
    check_program(seed)
    check_broken(seed)


if __name__ == "__main__":
    each_seed(check_both, make_options(100_000, BATCH_SIZE * BATCH_COUNT))
