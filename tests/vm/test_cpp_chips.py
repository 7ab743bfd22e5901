"""The cases, and samples of random programs, codes, images and numbers, on simulated chips.

The ATmega328P (`uno`, `nano` without tasks, and `portable`, whose machine is the C++ of all other
chips) and the ATmega2560 (`mega`) are started for each image:
with `--whole` each runs 400 programs, and the first one some 2,000 codes. The chips of ESP
boards (`lx6`, `lx106`, `rv32imc`) run in emulators that answer nearly as quickly as the host's
process: each also judges 16,000 codes and runs those that are accepted, judges 10,000 images, and
does 210,000 operations.
"""

from __future__ import annotations

import random
import re
from functools import partial
from pathlib import Path

import pytest

from tests.machines import Senses, avr
from tests.machines import board as boards
from tests.machines.chips import Chip, agrees
from tests.machines.host import Ran, parse_run, run_request
from tests.machines.pace import Pace
from tests.machines.python import run_in_python
from tests.machines.qemu import missing as emulator_missing
from tests.machines.qemu import start_emulator
from tests.oracle import programs
from tests.support import avr_tasks, cpp_checks
from tests.support.case_runs import compile_case, robot_and_senses
from tests.support.casefile import Case
from tests.support.edge_codes import kit_with_sensors, unverified_code
from tests.support.images import image_for, needs_of
from tests.support.kits import KITS
from tests.support.random_codes import jump, random_codes, simple
from tests.support.vm_cases import disassemblies_alone, having
from tiniscript import compile_text
from tiniscript.base.kit import Kit
from tiniscript.bytecode.disassembly import assemble
from tiniscript.bytecode.image import ALL_NEEDS, TASKS, ImageRefused
from tiniscript.bytecode.verify import Refused
from tools.builds import chips


def _run_emulated(name: str, image: bytes, kit: Kit, senses: Senses) -> Ran:
    return start_emulator(name).run(image, kit, senses)


CHIPS = {
    name: Chip(avr.missing(), partial(avr.run_on, name), 620) for name in avr.COMPILER_ARGUMENTS
}
CHIPS |= {name: Chip(emulator_missing(name), partial(_run_emulated, name)) for name in chips.CHIPS}


def some_chips(*names: str) -> pytest.MarkDecorator:
    """Run a test once for each of these chips, or skip it with the missing part."""
    marks = {
        name: pytest.mark.skipif(bool(CHIPS[name].missing), reason=CHIPS[name].missing or "here")
        for name in names
    }
    return pytest.mark.parametrize("chip", [pytest.param(n, marks=marks[n]) for n in names])


VARIABLES_AT = 37  # bytes: start of a machine's variables in `layout_avr.h`
SENSORS = 3  # sensors in the kit for code that no verifier accepts
# Errors that the AVR ignores: a statement on an empty stack empties it, the missing second of two
# values means nothing, and so does the counter of NEXT without a loop.
LENIENT = (
    simple("SHOW"),
    simple("PUSH_TRUE") + simple("ADD") + simple("SHOW"),
    simple("PUSH_TRUE") + simple("MOTORS"),
    jump("NEXT", False, 0),
)


each_chip = some_chips(*CHIPS)
each_emulated = some_chips(*chips.CHIPS)
one_chip = pytest.mark.sampled("chip")  # draws one chip per row; `--whole` runs all


def features_of(chip: str) -> int:
    """Return the features of a chip, as in `needs`: a Nano has no tasks."""
    return ALL_NEEDS & ~TASKS if chip == avr.NANO else ALL_NEEDS


def assert_same_on_chip(chip: str, image: bytes, kit: Kit, senses: Senses) -> str:
    """Assert that the chip says and does the same as Python; return the last line."""
    expected: Ran | str
    actual: Ran | str
    try:
        expected = run_in_python(image, kit, senses, has=features_of(chip))
    except (Refused, ImageRefused) as refusal:
        expected = repr(refusal)
    try:
        actual = CHIPS[chip].run(image, kit, senses)
    except (Refused, ImageRefused) as refusal:
        actual = repr(refusal)
    if isinstance(actual, str) or isinstance(expected, str):
        assert actual == expected, image.hex(" ")
        return str(expected)
    assert agrees(actual, expected, senses.max_ms), f"{image.hex(' ')}\n{actual}\n{expected}"
    return expected.trace.splitlines()[-1]


@pytest.mark.sampled("case", "chip", keep=90)
@each_chip
@pytest.mark.parametrize("case", having("tiniscript", "robot"))
def test_a_program_has_its_stated_trace(case: Case, chip: str) -> None:
    robot, senses = robot_and_senses(case)
    if needs_of(compile_case(case).code) & ~features_of(chip):
        with pytest.raises(ImageRefused, match="UNKNOWN_NEEDS"):
            CHIPS[chip].run(compile_case(case).image, robot.kit, senses)
        return
    run = CHIPS[chip].run(compile_case(case).image, robot.kit, senses)
    assert run.trace == case.parts["robot"], case.id


@one_chip
@each_chip
@pytest.mark.parametrize("case", disassemblies_alone())
def test_disassembly_runs_or_is_refused(case: Case, chip: str) -> None:
    robot, senses = robot_and_senses(case)
    image = image_for(assemble(case.parts["bytecode"]), robot.kit)
    limited_senses = senses._replace(max_ms=min(senses.max_ms, 5000), max_steps=5000)
    ending = assert_same_on_chip(chip, image, robot.kit, limited_senses)
    is_refused = "refused" in case.parts
    lacks = not is_refused and needs_of(assemble(case.parts["bytecode"])) & ~features_of(chip)
    assert ("Refused" in ending) == (is_refused or bool(lacks))


@one_chip
@each_chip
@pytest.mark.parametrize("seed", range(4))
def test_random_programs_agree(chip: str, seed: int) -> None:
    for number in range(100):
        rng = random.Random(seed * 1000 + number)
        oracle_kit, kit = KITS[number % 2]
        image = compile_text(programs.program(rng, oracle_kit), kit).image
        if len(image) <= CHIPS[chip].max_bytes:
            readings = programs.senses(rng, oracle_kit)
            assert_same_on_chip(chip, image, kit, Senses(readings, 3000, 2000, number + 1))


@pytest.mark.sampled("seed")
@some_chips(avr.UNO)
@pytest.mark.parametrize("seed", range(4))
def test_some_random_codes_agree(chip: str, seed: int) -> None:
    endings = set()
    kit = KITS[seed % 2][1]
    for number, code in enumerate(random_codes(seed, 8000)):
        if number % 20 < 1 or number % 40 == 16:  # deep blocks and expressions among them
            if len(code) <= 680:
                image = image_for(code, kit, "SB")
                ending = assert_same_on_chip(chip, image, kit, Senses(max_ms=3000, max_steps=300))
                endings.add(ending.split(" ", 1)[-1])
    assert "DONE" in endings and len(endings) > 2


@some_chips(avr.UNO)
def test_code_changed_after_verification_ends_in_bad_code(chip: str) -> None:
    """It ends in BAD_CODE at each edge, and not earlier."""
    kit, senses = kit_with_sensors(SENSORS), Senses(max_ms=100, max_steps=100)
    endings = set()
    for code, caught_at in unverified_code(len(kit.readings)):
        if code not in LENIENT:
            expected = "DONE" if caught_at is None else "BAD_CODE"
            answer = avr.answer(chip, b"U" + run_request(code, kit, senses))
            assert parse_run(answer).trace.split()[-1] == expected, f"{code.hex()}: {answer}"
            endings.add(expected)
    assert endings == {"DONE", "BAD_CODE"}


@some_chips(avr.UNO)
def test_loop_counts_may_exceed_65535(chip: str) -> None:
    """The test uses a nested loop and a long body: a counter has 24 bits, in registers and in
    memory."""
    kit = KITS[0][1]
    far_jump = f"IF(X < 0); {'Y = Y + 1; ' * 130} ENDIF; Y = X;"
    for body in ("LOOP(1); Y = X; END_LOOP;", far_jump):
        text = f"X = 0; Y = 0; LOOP(70000); X = X + 1; {body} END_LOOP; SHOW(Y)"
        image = compile_text(text, kit).image
        assert_same_on_chip(chip, image, kit, Senses())
        run = avr.run_on(chip, image, kit, Senses(), not_ready=2)
        assert run.trace == run_in_python(image, kit, Senses()).trace, body


@some_chips(avr.MEGA)
def test_variables_beyond_256_bytes_are_reached(chip: str, tmp_path: Path) -> None:
    """Some of those that short and long instructions use lie there, others before it."""
    names = [f"V{k}" for k in range(32)]
    text = "".join(f"{name} = {k}; {name} = {name} + 1; " for k, name in enumerate(names))
    image = compile_text(text + "; ".join(f"SHOW({name})" for name in names), KITS[0][1]).image
    assert assert_same_on_chip(chip, image, KITS[0][1], Senses()) == "0 DONE"
    (tmp_path / "program.elf").write_bytes(avr.program(chip))
    symbols = boards.run("avr-nm", tmp_path / "program.elf")
    (machine,) = re.findall(r"^(\S+) \S \S*7machineE", symbols, re.M)
    assert 0 < -(int(machine, 16) + VARIABLES_AT) % 256 < 4 * len(names)


@some_chips(avr.UNO)
def test_a_robot_that_is_not_ready_is_polled_again(chip: str) -> None:
    """Values stay on the stack, and the next tick goes on with them."""
    kit = KITS[0][1]
    code = b"".join(
        simple("PUSH_NUM_5") + simple(name) + operand + simple("ADD") + simple("SHOW")
        for name, operand in (("PUSH_READ", b"\2"), ("PUSH_READ_2", b""), ("PUSH_READ_2", b""))
    )
    image = image_for(code, kit)
    readings = {"DISTANCE": [1000, 2500, -3000]}
    expected = run_in_python(image, kit, Senses(readings)).trace
    for not_ready in (2, 3):
        assert avr.run_on(avr.UNO, image, kit, Senses(readings), not_ready).trace == expected


@pytest.mark.sampled("chip", "seed")
@each_emulated
@pytest.mark.parametrize("seed", range(2))
def test_verdicts_on_random_codes_agree(chip: str, seed: int) -> None:
    """Rules and offsets of random and mutated codes; those that are accepted run."""
    counts = cpp_checks.check_codes(start_emulator(chip), seed, 8000)
    assert {"DONE", "LIMIT", "OVERFLOW", "DIVIDE_BY_ZERO"} <= set(counts)
    assert counts["accepted"] > 500


@one_chip
@each_emulated
def test_programs_with_tasks_agree(chip: str) -> None:
    cpp_checks.check_task_codes(start_emulator(chip), 4, 2000)
    cpp_checks.check_task_programs(start_emulator(chip), 2000, 100)


@pytest.mark.sampled("chip")
@some_chips(avr.UNO, avr.MEGA, avr.PORTABLE_CHIP)
def test_programs_with_tasks_on_an_avr_agree(chip: str) -> None:
    for number, (image, senses) in enumerate(cpp_checks.some_task_programs(3000, 60)):
        assert_same_on_chip(chip, image, cpp_checks.KIT, senses)
        run = avr.run_on(chip, image, cpp_checks.KIT, senses, 2 + number % 3)
        assert run.trace == cpp_checks.slow_run(image, senses, 2 + number % 3), run.trace


@pytest.mark.sampled("first")
@some_chips(avr.UNO)
@pytest.mark.parametrize("first", range(5000, 5400, 100))
def test_assembly_and_its_cpp_twin_agree(chip: str, first: int) -> None:
    """On one chip, instruction by instruction: turns, moves and the inner loop exist twice."""
    for number, (image, senses) in enumerate(cpp_checks.some_task_programs(first, 100)):
        not_ready, pace = (0, 2, 3)[number % 3], Pace(call_interval_ms=(1, 8, 37, 2)[number % 4])
        begin_ms = (0, 2**31 - 100, 2**32 - 100)[number // 3 % 3]
        of_assembly, of_twin = (
            avr.run_on(chip_name, image, cpp_checks.KIT, senses, not_ready, pace, begin_ms)
            for chip_name in (chip, avr.PORTABLE_CHIP)
        )
        assert of_assembly == of_twin, image.hex(" ")


@some_chips(avr.UNO, avr.MEGA, avr.PORTABLE_CHIP)
@pytest.mark.parametrize("name", avr_tasks.PROGRAMS)
def test_hard_programs_with_tasks_agree(chip: str, name: str) -> None:
    program = avr_tasks.PROGRAMS[name]
    image = compile_text(program.text, cpp_checks.KIT).image
    for not_ready, late_ms, begin_ms, max_ms in program.runs:
        senses = Senses(program.readings, max_ms)
        pace = Pace(call_interval_ms=late_ms + 1)
        run = avr.run_on(chip, image, cpp_checks.KIT, senses, not_ready, pace, begin_ms)
        assert run.trace == cpp_checks.slow_run(image, senses, not_ready, late_ms), run.trace


@some_chips(avr.UNO, avr.MEGA, avr.PORTABLE_CHIP)
def test_calls_of_a_task_use_up_the_budget(chip: str) -> None:
    """Only this ends a tick there. The calls have all low bytes of an address, in a long loop."""
    calls = "D;" * 130
    text = f"A = 0;DEF D;A = A + 1;END_DEF;TASK;LOOP(2);{calls}END_LOOP;SHOW(A);END_TASK"
    image = compile_text(text, cpp_checks.KIT).image
    for max_steps, expected in ((100, ("0 LIMIT\n", 100)), (150, ("1 SHOW 260\n1 DONE\n", 261))):
        run = avr.run_on(chip, image, cpp_checks.KIT, Senses(max_steps=max_steps))
        assert (run.trace, run.steps) == expected


@pytest.mark.sampled("chip")
@some_chips(avr.UNO, avr.MEGA, avr.PORTABLE_CHIP)
def test_late_tasks_beyond_byte_256_run(chip: str) -> None:
    for number, (image, senses) in enumerate(
        cpp_checks.some_task_programs(0, 40, cpp_checks.FAR_JUMP)
    ):
        late_ms = (0, 7, 36)[number % 3]
        pace = Pace(call_interval_ms=late_ms + 1)
        run = avr.run_on(chip, image, cpp_checks.KIT, senses, pace=pace, begin_ms=2**32 - 100)
        assert run.trace == cpp_checks.slow_run(image, senses, 0, late_ms), run.trace


@one_chip
@each_emulated
def test_programs_with_ways_agree(chip: str) -> None:
    cpp_checks.check_way_codes(start_emulator(chip), 5, 1500)
    cpp_checks.check_way_programs(start_emulator(chip), 2000, 100)


@pytest.mark.sampled("chip")
@some_chips(avr.UNO, avr.MEGA, avr.PORTABLE_CHIP)
def test_programs_with_ways_on_an_avr_agree(chip: str) -> None:
    for image, kit, senses in cpp_checks.some_way_programs(3000, 60):
        if len(image) <= CHIPS[chip].max_bytes:
            assert_same_on_chip(chip, image, kit, senses)


@one_chip
@each_emulated
def test_images_get_the_same_verdict(chip: str) -> None:
    cpp_checks.check_images(start_emulator(chip), 0, 10_000)
    cpp_checks.check_whole_images(start_emulator(chip), 0, 300)


@one_chip
@each_emulated
@pytest.mark.parametrize("name", cpp_checks.OPERATIONS)
def test_arithmetic_agrees(chip: str, name: str) -> None:
    cpp_checks.check_arithmetic(start_emulator(chip), name, 10_000)
