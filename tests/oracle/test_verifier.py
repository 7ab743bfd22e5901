"""The verifiers agree with the one in `bytecode_spec.md`, which runs here.

`python -m tests.oracle.test_verifier 100000` compares more codes than the tests: random ones,
programs that are damaged, and all of one or two bytes.
"""

from __future__ import annotations

import ast
import random
from collections.abc import Iterable, Iterator
from functools import lru_cache
from itertools import product

import pytest

from tests.machines.host import host, missing
from tests.oracle import spec_tables, verifier
from tests.support.campaign import each_seed, make_options
from tests.support.casefile import ROOT, Case, all_cases
from tests.support.cpp_checks import python_verdict
from tests.support.random_codes import random_codes, task_codes
from tests.support.rows import each_row
from tiniscript import compile_text
from tiniscript.bytecode.disassembly import assemble
from tiniscript.bytecode.opcodes import CONTROL_ROLES
from tiniscript.bytecode.verify import RULES
from tiniscript.robots import DEFAULT, load

SENSORS, ACTUATORS = 11, 2
NEEDY = {spec_tables.ESCAPE} | {
    code for code, row in spec_tables.instructions().items() if row.name in verifier.OF_TASKS
}


def compare(codes: Iterable[bytes], sensors: int = SENSORS, actuators: int = ACTUATORS) -> set[int]:
    """Assert that all verifiers say the same of each code; return the rules that were broken.

    Verdicts of code that needs something are compared twice, with all of `needs` and with none. The
    machine in C++ gets the second.
    """
    codes = list(codes)
    own_verdicts = [verifier.verdict(code, sensors, actuators) for code in codes]
    without = [
        verifier.verdict(code, sensors, actuators, 0) if NEEDY & {*code} else verdict
        for code, verdict in zip(codes, own_verdicts, strict=True)
    ]
    for code, *verdicts in zip(codes, own_verdicts, without, strict=True):
        for needs, verdict in zip((0xFF, 0), verdicts, strict=True):
            if not needs and verdict == verdicts[0]:
                continue
            python_result = python_verdict(code, sensors, actuators, needs)
            assert python_result == verdict, (
                f"{code.hex(' ')}: Python says {python_result}, the page {verdict}"
            )
    if not missing():
        cpp_verdicts = host().verdicts(codes, sensors, actuators)
        for code, verdict, (rule, offset) in zip(codes, without, cpp_verdicts, strict=True):
            cpp_result = rule, offset if rule else 0  # the offset of accepted code is its length
            assert cpp_result == verdict, (
                f"{code.hex(' ')}: C++ says {cpp_result}, the page {verdict}"
            )
    return {rule for rule, _ in own_verdicts}


@lru_cache(maxsize=1)
def every_program() -> list[bytes]:
    """Return the code of all programs in cases and documents that compile for the usual robot."""
    kit = load(DEFAULT).kit
    texts = [case.parts["tiniscript"] for case in all_cases() if "tiniscript" in case.parts]
    compiled_compilations = [compile_text(text, kit) for text in texts]
    return [
        compilation.code
        for compilation in compiled_compilations
        if compilation.is_right and compilation.code
    ]


def damage_programs(programs: list[bytes], seed: int, count: int) -> Iterator[bytes]:
    """Yield programs with one to three bytes that are changed, lost, doubled or cut off."""
    rng = random.Random(seed)
    for _ in range(count):
        code = bytearray(rng.choice(programs))
        for _ in range(rng.choice((1, 1, 2, 3))):
            index = rng.randrange(len(code)) if code else 0
            kind = rng.randrange(6)
            if kind == 0:
                del code[index : index + 1]
            elif kind == 1:
                code[index:index] = code[index : index + 1]
            elif kind == 2 and rng.random() < 0.2:
                del code[index:]
            elif code:
                code[index] = rng.choice((code[index] ^ 1 << rng.randrange(8), rng.randrange(256)))
        yield bytes(code)


def disassemblies() -> list[pytest.ParameterSet]:
    cases = [case for case in all_cases() if "bytecode" in case.parts]
    return [pytest.param(case, id=case.id) for case in cases if "senses" not in case.parts]


@each_row("case", disassemblies())
def test_verdicts_on_disassemblies_and_their_prefixes_agree(case: Case) -> None:
    code = assemble(case.parts["bytecode"])
    for actuators in (0, ACTUATORS):
        compare([code[:length] for length in range(len(code) + 1)], SENSORS, actuators)


@pytest.mark.parametrize("code", ["92 39 93 39", "8b 39", "9a 9f"])
def test_a_sensor_in_an_instruction_of_one_byte(code: str) -> None:
    """PUSH_READ_3, PUSH_SENSOR_3 and READ_7, of a kit with 3 that reads no remote control."""
    assert compare([bytes.fromhex(code)], 3) == {RULES["NO_SUCH_DEVICE"][0]}
    assert compare([bytes.fromhex(code)], 8) == {0}


def test_verdicts_on_all_codes_of_up_to_two_bytes_agree() -> None:
    compare(bytes(values) for size in range(3) for values in product(range(256), repeat=size))


def test_each_rule_is_broken_by_its_cases() -> None:
    """This does not depend on what random codes happen to break; the length has a test below."""
    cases = [case for case in all_cases() if "refused" in case.parts]
    for case in cases:
        number = int(case.parts["refused"].split()[0])
        assert compare([assemble(case.parts["bytecode"])], SENSORS, 0) == {number}, case.id
    names = {case.parts["refused"].split()[1] for case in cases}
    assert names == {*RULES} - {"CODE_LENGTH"}


@pytest.mark.sampled("seed")
@pytest.mark.parametrize("seed", range(4))
def test_verdicts_on_random_codes_agree(seed: int) -> None:
    broken = compare(random_codes(1000 + seed, 5000))
    broken |= compare(task_codes(1000 + seed, 2000))
    assert 0 in broken and len(broken) > 15


def test_verdicts_on_damaged_programs_agree() -> None:
    programs = every_program()
    assert len(programs) > 100
    assert compare(programs) == {0}
    assert len(compare(damage_programs(programs, 1, 5000))) > 15


def test_the_steps_cover_every_rule_and_every_role() -> None:
    text = spec_tables.SPEC.read_text(encoding="utf-8")
    steps = text[
        text.index("A verifier keeps this state") : text.index("The control roles of instructions:")
    ]
    assert {rule for rule in RULES if rule in steps} == set(RULES)
    assert {role for role in CONTROL_ROLES if f"`{role}`" in steps} == set(CONTROL_ROLES)


def test_code_may_be_as_long_as_the_limit() -> None:
    stop = next(code for code, row in spec_tables.instructions().items() if row.name == "STOP")
    assert [verifier.verdict(bytes([stop]) * length, 0, 0) for length in (32767, 32768)] == [
        (0, 0),
        (RULES["CODE_LENGTH"][0], 0),
    ]


def test_no_device_has_a_number_above_31() -> None:
    """A kit with more is refused before code runs: a machine keeps 32 readings."""
    codes = {name: code for code, row in spec_tables.instructions().items() for name in [row.name]}
    for device_count in (32, 33, 255):
        for name, number in (("READ", 31), ("READ", 32), ("PUSH_SENSOR", 32), ("PUSH_READ", 255)):
            code = bytes([codes[name], number])
            rules = compare(
                [code + bytes([codes["SHOW"]]) if name != "READ" else code],
                device_count,
                device_count,
            )
            assert rules == {0 if number == 31 else RULES["BAD_OPERAND"][0]}


READS = ("words", "lexer", "kinds", "ast", "readings", "expressions", "text", "robot", "tasks",
         "interpreter")  # fmt: skip
CHECKS = ("spec_tables", "verifier", "arithmetic", "machine")


@each_row("name", [*READS, *CHECKS])
def test_the_verifier_is_independent_of_the_package(name: str) -> None:
    text = (ROOT / "tests" / "oracle" / f"{name}.py").read_text(encoding="utf-8")
    imported_modules = {
        alias.name if isinstance(node, ast.Import) else str(node.module)
        for node in ast.walk(ast.parse(text))
        if isinstance(node, (ast.Import, ast.ImportFrom))
        for alias in node.names
    }
    assert not {module for module in imported_modules if module.startswith("tiniscript")}
    others = {module for module in imported_modules if module.startswith("tests")}
    upstream = ("spec_tables", "arithmetic", "words") if name in CHECKS else (*READS, "arithmetic")
    assert others <= {f"tests.oracle.{module}" for module in upstream}


# -- a campaign ---------------------------------------------------------------------------------


BATCH_SIZE = 10_000


def check_batch(seed: int) -> int:
    """Compare two batches; return how many rules they break."""
    codes = (*random_codes(seed, BATCH_SIZE), *damage_programs(every_program(), seed, BATCH_SIZE))
    return len(compare(codes) - {0})


if __name__ == "__main__":
    options = make_options(100_000, 2000)
    options.count = -(-options.count // (2 * BATCH_SIZE))
    each_seed(check_batch, options)
