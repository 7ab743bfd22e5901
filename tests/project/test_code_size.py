"""The code of the documents' programs stays small."""

from __future__ import annotations

from tiniscript import compile_text, robots
from tools.bench import code_size
from tools.bench.compiler import PROGRAMS


def test_statements_are_a_fifth_smaller_than_in_instruction_set_1() -> None:
    measured_measurement = code_size.measure()
    assert measured_measurement.program_count >= 50
    assert (
        measured_measurement.bytes_per_statement
        <= 0.8 * code_size.BYTES_IN_ISA_1_0 / code_size.STATEMENTS
    )


def test_the_papers_programs_keep_their_sizes() -> None:
    kit = robots.load(robots.DEFAULT).kit
    assert [len(compile_text(text, kit).code) for text in PROGRAMS] == [3, 7, 14]


def test_documented_programs_use_every_short_instruction() -> None:
    """A family that no program of the documents needs would not be worth its codes."""
    families = {name.rpartition("_")[0] for name in code_size.measure().opcodes}
    short = {"PUSH_NUM", "PUSH_VAR", "SET_VAR", "PUSH_SENSOR", "PUSH_READ", "READ", "SET"}
    assert short | {"IF8", "UNTIL8", "UNTIL16", "IF_VAR8"} <= families
