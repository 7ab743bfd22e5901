"""Moves by centimetres and degrees: the compiler and the machines agree with the oracle.

`python -m tests.oracle.test_ways 100000` compares more programs than the tests, and the machine in
C++ as well.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Sequence

import pytest

from tests.machines import MACHINES, Machine, Senses
from tests.machines.python import run_python
from tests.oracle import machine, programs
from tests.oracle.interpreter import PAPER_KIT, Kit, Mistake, run
from tests.support.campaign import each_seed, make_options
from tests.support.kits import KITS
from tests.support.random_programs import MAX_MS, MAX_STEPS
from tests.support.rows import each_row
from tests.support.task_agreement import compare_task_program
from tests.support.vm_agreement import are_equivalent
from tiniscript import Compilation, compile_text
from tiniscript.base.source import Source
from tiniscript.bytecode.image import GO, unpack
from tiniscript.syntax.formatter import format_source

BATCH_SIZE = 100


def check_program(seed: int, machines: Sequence[Machine] = (run_python,)) -> str:
    """Compare the traces of one random program on some machines; return how it ended."""
    rng = random.Random(seed)
    oracle_kit, kit = KITS[seed // 2 % 2]
    compilations: list[Compilation] = []
    while not compilations or not unpack(compilations[0].image).needs & GO:
        text = programs.program(rng, oracle_kit, ways=True)
        compilations = [compile_text(text, kit, optimize=optimize) for optimize in (True, False)]
        assert all(compilation.is_right for compilation in compilations), f"seed {seed}:\n{text}"
    readings = programs.senses(rng, oracle_kit)
    expected = run(text, oracle_kit, readings, MAX_MS, MAX_STEPS)
    for image in dict.fromkeys(
        compilation.image for compilation in compilations
    ):  # often they are the same
        for run_on in machines:
            actual = run_on(image, kit, Senses(readings, MAX_MS, MAX_STEPS))
            assert are_equivalent(expected, actual), f"seed {seed}, {image.hex()}:\n{text}"
        actual = machine.trace(
            unpack(image).code, oracle_kit, readings, MAX_MS, max_steps=MAX_STEPS
        )
        assert machine.TOO_MANY in actual or are_equivalent(expected, actual), (
            f"seed {seed}, the page:\n{text}"
        )
    laid_out = format_source(Source(text))
    assert compile_text(laid_out, kit).image == compilations[0].image, f"seed {seed}"
    return expected.splitlines()[-1].split(" ", 1)[1]


@pytest.mark.sampled("first")
@pytest.mark.parametrize("first", range(0, 4 * BATCH_SIZE, BATCH_SIZE))
def test_random_programs_agree(first: int) -> None:
    end_counts = Counter(check_program(seed) for seed in range(first, first + BATCH_SIZE))
    assert {"DONE", "FAULT NO_POWER", "FAULT OVERFLOW"} <= set(end_counts), end_counts


def test_random_programs_with_tasks_agree() -> None:
    seeds = range(4 * BATCH_SIZE, 5 * BATCH_SIZE)  # two of them go without power
    end_counts = Counter(compare_task_program(seed, needs=GO) for seed in seeds)
    assert {"DONE", "LIMIT", "NO_POWER"} <= set(end_counts), end_counts


@each_row(
    "text",
    [
        "F(20 DEG, 60)",
        "L(90 CM, 60)",
        "F(20, CM, 60)",
        "F(20 CM + 5, 60)",
        "F((20 CM), 60)",
        "F(MAX(5 CM, 3), 60)",
        "F(FOREVER CM, 60) UNTIL(TRUE)",
        "F(-5 CM, 60)",
        "F(20 CM)",
        "F(1, 60 CM)",
        "F(CM 20, 60)",
        "F(20 CM CM, 60)",
        "F(CM, 60)",
        "W(20 CM)",
        "M(20 CM, 60)",
        "BEEP(2 CM, 440)",
        "SHOW(5 CM)",
        "LOOP(3 CM);END_LOOP",
        "IF(DISTANCE < 20 CM);ENDIF",
        "F(1, 60) UNTIL(DISTANCE < 20 cm)",
        "X = 20 CM",
        "CM = 5",
        "DEF DEG;END_DEF",
        "CM",
        "F(20 ° C, 60)",
        "L(90°C, 60)",
        "F(TRUE CM, 60)",
    ],
)
def test_both_refuse_the_same_programs(text: str) -> None:
    with pytest.raises(Mistake):
        run(text)
    assert not compile_text(text, KITS[0][1]).is_right


@each_row(
    "text",
    [
        "F(20 CM, 60)",
        "f(20cm,60);b(20Cm,60);L(90°,60);R(90º,60);R(90 deg,60);R(90 °,60)",
        "F(\n20\nCM\n,\n60)",
        "X = 3;F(X + 5 CM, X * 20);L((90) DEG, 60) UNTIL(TIME > 0.1)",
        "F(-X CM, 60);X = 1".replace("-X", "-TIME"),
        "F(MIN(5, 3) CM, MAX(60, 50))",
        "F(0 CM, 0);R(0 DEG, 0);B(-1 + 0 CM, 0)",
        "CMS = 5;DEGR = 1;F(CMS CM, 50)",
        "F(0.009 CM, 40)",
    ],
)
def test_both_accept_the_same_programs(text: str) -> None:
    compilation = compile_text(text, KITS[0][1])
    assert run_python(compilation.image, KITS[0][1], Senses()) == run(text)


def test_a_robot_without_known_speed_has_no_such_moves() -> None:
    oracle_kit, kit = Kit(PAPER_KIT.sensors, (), 45_000), KITS[0][1]._replace(turn=0)
    assert run("F(45 CM, 100)", oracle_kit).endswith("1000 DONE\n")
    assert compile_text("F(45 CM, 100)", kit).is_right
    with pytest.raises(Mistake):
        run("L(9 DEG, 100)", oracle_kit)
    assert [
        diagnostic.code.number for diagnostic in compile_text("L(9 DEG, 100)", kit).diagnostics
    ] == ["TS314"]


@each_row(
    "text, code, shown_text",
    [
        ("R(20, 60)", "TS811", "R(20 DEG, 60)"),
        ("L(90, 60)", "TS811", "L(90 DEG, 60)"),
        ("R(19.9, 60)", "", ""),
        ("F(30, 60)", "TS811", "F(30 CM, 60)"),
        ("F(5 CM, 0)", "TS808", ""),
        ("F(2147483.647 CM, 1)", "TS808", ""),
        ("F(0 CM, 50)", "TS803", ""),
        ("R(90 DEG, 60)", "", ""),
        ("F(200 CM, 60);IF(DISTANCE < 9);S;ENDIF", "", ""),
    ],
)
def test_advice_on_ways_agrees(text: str, code: str, shown_text: str) -> None:
    diagnostics = compile_text(text, KITS[0][1]).diagnostics
    assert [diagnostic.code.number for diagnostic in diagnostics] == [code] * bool(code)
    assert [diagnostic.values.get("way", "") for diagnostic in diagnostics] == [shown_text] * bool(
        code
    )


def test_degrees_are_shown_only_if_the_robot_has_them() -> None:
    kit = KITS[0][1]._replace(speed=0, turn=0)
    assert not compile_text("R(20, 60)", kit).diagnostics
    (diagnostic,) = compile_text("R(90, 60)", kit).diagnostics
    assert diagnostic.code.number == "TS811" and "way" not in diagnostic.values


def check_either(seed: int) -> str:
    machines = [MACHINES[name] for name in ("python", "host")]
    return check_program(seed, machines) if seed % 2 else compare_task_program(seed, machines, GO)


if __name__ == "__main__":
    each_seed(check_either, make_options(100_000, 0))
