"""Properties of the machine in C++: each check asks one process, and compares with Python.

`test_cpp_agreement` runs these on this computer, `test_cpp_chips` on chips. No question depends on
time or chance: the same machine gives the same answers.
"""

from __future__ import annotations

import operator
import random
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from itertools import product

from tests.machines import Senses
from tests.machines.host import Process
from tests.machines.python import lists_of, run_in_python
from tests.oracle import programs
from tests.oracle.task_programs import task_program
from tests.support.images import image_for
from tests.support.kits import KITS
from tests.support.random_codes import (
    EDGES,
    any_number,
    changed_kit,
    images_of_programs,
    likely_code,
    mutate_code,
    random_codes,
    random_images,
    simple,
    task_codes,
)
from tiniscript import compile_text
from tiniscript.base import fixed_point
from tiniscript.base.kit import Kit
from tiniscript.base.trace import TracedRobot
from tiniscript.base.words import COMPARATORS
from tiniscript.bytecode.image import (
    ALL_NEEDS,
    GO,
    HEADER_BYTES,
    REFUSALS,
    TASKS,
    ImageRefused,
    pack,
    unpack,
    with_checksum,
)
from tiniscript.bytecode.opcodes import BY_NAME, ESCAPE, ESCAPED_OPS, FAULTS
from tiniscript.bytecode.verify import Refused, load_image, verify
from tiniscript.vm.machine import Machine
from tiniscript.vm.runner import MachineOf
from tiniscript.vm.state import DONE, FAULT, WAITING
from tiniscript.vm.tasks import NEVER_MS, machine_of

KIT, WIDE_KIT = KITS[0][1], KITS[1][1]
SIZES = len(WIDE_KIT.sensors), len(WIDE_KIT.actuators)
MAX_MS, MAX_STEPS = 3000, 300  # limits for accepted random codes
TASK_MS = 600  # limit for programs with tasks


def python_verdict(code: bytes, sensors: int, actuators: int, needs: int = 0) -> tuple[int, int]:
    """Return Python's verdict on code, in an image with its needs."""
    try:
        verify(code, sensors, actuators, needs)
    except Refused as refusal:
        return refusal.number, refusal.offset
    return 0, 0


def compare_verdicts(
    machine: Process, codes: Sequence[bytes], sensors: int, actuators: int, needs: int = 0
) -> list[bytes]:
    """Assert that both machines agree on each code; return the accepted codes."""
    machine_verdicts = machine.verdicts(codes, sensors, actuators, needs)
    accepted_codes = []
    for code, (rule, offset) in zip(codes, machine_verdicts, strict=True):
        verdict_in_python = python_verdict(code, sensors, actuators, needs)
        # The offset of accepted code is its length.
        verdict = (rule, offset if rule else 0)
        assert verdict_in_python == verdict, (
            f"{code.hex(' ')} for {sensors}, {actuators}: {verdict_in_python}, not {verdict}"
        )
        if not rule:
            accepted_codes.append(code)
    return accepted_codes


def compare_runs(machine: Process, code: bytes, kit: Kit, senses: Senses) -> str:
    """Assert that both machines run accepted code alike; return the ending."""
    image = image_for(code, kit)
    python_run, machine_run = run_in_python(image, kit, senses), machine.run(image, kit, senses)
    assert machine.agrees(machine_run, python_run, senses.max_ms), (
        f"{code.hex(' ')}:\n{python_run}\nnot\n{machine_run}"
    )
    return machine_run.trace.split()[-1]


# -- code ---------------------------------------------------------------------------------------


def check_codes(machine: Process, seed: int, count: int) -> Counter[str]:
    """Compare random codes, and run the accepted ones; return the number of each result."""
    rng = random.Random(seed)
    oracle_kit, kit = KITS[seed % 2]
    counts: Counter[str] = Counter()
    sizes = len(kit.readings), len(kit.actuators)
    codes = list(random_codes(seed, count))
    accepted_bytes = compare_verdicts(machine, codes, *sizes)
    for number, code in enumerate(accepted_bytes):
        senses = Senses(programs.senses(rng, oracle_kit), MAX_MS, MAX_STEPS, number + 1)
        counts[compare_runs(machine, code, kit, senses)] += 1
    counts["accepted"] = len(accepted_bytes)
    counts.update(str(rule) for rule, _ in machine.verdicts(codes, *sizes))
    return counts


# -- time and a robot that is not ready ---------------------------------------------------------


LATE_BUDGET = 250  # instructions, as many as the host machine runs in a tick


def run_late(
    image: bytes,
    kit: Kit,
    senses: Senses,
    late_ms: Sequence[int],
    machine_of: MachineOf = Machine,
) -> str:
    """Return the trace of Python's machine where the tick after each wait comes so late."""
    robot = TracedRobot(kit, lists_of(kit, senses))
    machine = machine_of(unpack(image).code, robot, len(kit.readings), senses.seed)
    for delay_ms in late_ms:
        status = machine.tick(robot.now_ms, LATE_BUDGET)
        if status != WAITING or machine.wake_ms - robot.now_ms >= NEVER_MS:
            break
        robot.now_ms = max(machine.wake_ms, robot.now_ms) + delay_ms
    return "".join(f"{event}\n" for event in robot.events)


# Ticks at 2^31 - 8 and 2^32 - 16 ms, both multiples of 20, and then on time, for waits since 0.
ROUND_MS = (2**31 - 28, 2**31 - 28, 0, 0, 0, 7, 30, 0, 0)
ROUND_PROGRAM = "F(FOREVER, 80) UNTIL(DISTANCE < 10); W(0.1)"
ROUND_TRACE = """\
0 READ DISTANCE 50
0 MOTORS 80 80
2147483640 READ DISTANCE 50
4294967280 READ DISTANCE 50
4294967300 READ DISTANCE 50
4294967320 READ DISTANCE 50
4294967340 READ DISTANCE 50
4294967367 READ DISTANCE 50
4294967410 READ DISTANCE 9
4294967410 MOTORS 0 0
"""


def check_round(run: Callable[[bytes, Kit, Senses, Sequence[int]], str]) -> None:
    """The checks of an UNTIL go on in the same row where the clock wraps around."""
    senses = Senses({"DISTANCE": [50_000] * 7 + [9_000]})
    kit = KITS[0][1]
    assert run(compile_text(ROUND_PROGRAM, kit).image, kit, senses, ROUND_MS) == ROUND_TRACE


# -- arithmetic ---------------------------------------------------------------------------------

OPERATIONS: dict[str, Callable[[int, int], int]] = {
    "ADD": fixed_point.add,
    "SUB": fixed_point.subtract,
    "MUL": fixed_point.multiply,
    "DIV": fixed_point.divide,
    "MOD": fixed_point.modulo,
    "NEG": lambda a, b: fixed_point.negate(a),
    "ABS": lambda a, b: fixed_point.absolute(a),
    "ROUND": fixed_point.round_to,
    "MIN": min,
    "MAX": max,
    "AND": lambda a, b: a != 0 and b != 0,
    "OR": lambda a, b: a != 0 or b != 0,
    "NOT": lambda a, b: int(not a),
    **{name: getattr(operator, name.lower()) for name, _ in COMPARATORS},
    "RANDOM": lambda a, b: fixed_point.random_between(a, b, b % 2**32),
    "END": lambda a, b: fixed_point.round_to_whole(a),  # placeholder that is not needed here
}
# 2^32 thousandths, after they are rounded: products and quotients
ROUNDED_TOO_LARGE = [
    (a * sign, b)
    for a, b in ((2047, 2_098_176_500), (2832, 1_516_584_497), (304_942_678, 71), (420_906_795, 98))
    for sign in (1, -1)
]
FAULT_NUMBER_BY_NAME = {name: number for number, name, _ in FAULTS}


def python_result(name: str, a: int, b: int) -> tuple[int, int]:
    try:
        return 0, OPERATIONS[name](a, b)
    except fixed_point.Fault as fault:
        return FAULT_NUMBER_BY_NAME[fault.name], 0


def check_arithmetic(machine: Process, name: str, count: int) -> None:
    """All pairs of edges, some sizes that fit, and any others: so many operations in all."""
    rng = random.Random(name)
    pairs = list(product(EDGES, EDGES))
    pairs += ROUNDED_TOO_LARGE
    pairs += [(any_number(rng), any_number(rng)) for _ in range(count - len(pairs))]
    code = BY_NAME[name].code
    machine_results = machine.results((code, a, b) for a, b in pairs)
    for (a, b), result in zip(pairs, machine_results, strict=True):
        expected_result = python_result(name, a, b)
        assert expected_result == result, f"{name} {a} {b}: {expected_result}, not {result}"


# -- tasks --------------------------------------------------------------------------------------

FAR_JUMP = f"A = 0;N = 0;IF(N > 0);{'SHOW(8);' * 140}ENDIF;"  # more than 256 bytes


def some_task_programs(
    first_seed: int, count: int, text_before: str = ""
) -> Iterator[tuple[bytes, Senses]]:
    """Yield images of random programs with tasks, and the readings of their sensors.

    All that a program does lies after the code of the text `before`.
    """
    for seed in range(first_seed, first_seed + count):
        text, readings = task_program(random.Random(seed))
        yield compile_text(text_before + text, KIT).image, Senses(readings, TASK_MS, seed=seed + 1)


def check_task_codes(machine: Process, seed: int, count: int) -> None:
    """Code with tasks has the same verdict, in images that may have some and in others."""
    rng = random.Random(seed)
    codes = list(task_codes(seed, count))
    codes += [mutate_code(rng, code, rng.choice(codes)) for code in codes]
    rules = set()
    for needs in (0, TASKS):
        accepted_bytes = compare_verdicts(machine, codes, *SIZES, needs)
        assert bool(accepted_bytes) == bool(needs) or len(accepted_bytes) < len(codes) / 4
        rules |= {rule for rule, _ in machine.verdicts(codes, *SIZES, needs)}
    # accepted, UNKNOWN_OPCODE, STACK_NOT_EMPTY, NOT_OPEN, STILL_OPEN, BAD_DEF, INSIDE_CHECK,
    # TOO_MANY_TASKS
    assert {0, 21, 27, 32, 33, 35, 38, 40} <= rules, rules


def check_task_programs(machine: Process, first_seed: int, count: int) -> None:
    for image, senses in some_task_programs(first_seed, count):
        run = machine.run(image, KIT, senses)
        assert machine.agrees(run, run_in_python(image, KIT, senses), senses.max_ms), first_seed


class SlowRobot(TracedRobot):
    """A robot that is not ready each `not_ready`th time that it is asked."""

    ask_count = 0
    not_ready = 0

    def is_ready(self) -> bool:
        self.ask_count += 1
        return not self.not_ready or self.ask_count % self.not_ready != 0

    def read(self, sensor: int) -> int | None:
        return super().read(sensor) if self.is_ready() else None

    def show(self, value: int, is_yes_no: bool) -> bool:
        return self.is_ready() and super().show(value, is_yes_no)


def slow_run(image: bytes, senses: Senses, not_ready: int, late_ms: int = 0) -> str:
    """Return the trace of Python's machine on a robot that is not always ready.

    Its clock moves by more than a millisecond at once, so that ticks come up to `late_ms` late.
    """
    step_ms = late_ms + 1
    robot = SlowRobot(KIT, lists_of(KIT, senses))
    robot.not_ready = not_ready
    machine = machine_of(unpack(image).code, robot, len(KIT.readings), senses.seed)
    end = ""
    while not end:
        status = machine.tick(robot.now_ms, LATE_BUDGET)
        if status in (DONE, FAULT):
            end = f"{robot.now_ms} {status.upper()} {machine.fault}".strip()
        elif status == WAITING:
            robot.now_ms = -(-max(machine.wake_ms, robot.now_ms) // step_ms) * step_ms
            if robot.now_ms > senses.max_ms:
                end = f"{senses.max_ms} LIMIT"
    return "".join(f"{event}\n" for event in robot.events) + end + "\n"


# -- ways ---------------------------------------------------------------------------------------

ESCAPED_OPCODES = [op.opcode for op in ESCAPED_OPS.values()]


def way_code(rng: random.Random) -> bytes:
    """Return a move by any way and power, mostly right; with an UNTIL or without."""
    values = (any_number(rng), rng.choice((any_number(rng), rng.randrange(-5, 105) * 1000)))
    pushes = [simple("PUSH32") + value.to_bytes(4, "little", signed=True) for value in values]
    code = b"".join(pushes) + rng.choice(ESCAPED_OPCODES)
    if (code[-1] & 8) and rng.random() < 0.9:
        code += simple(rng.choice(("PUSH_TRUE", "PUSH_FALSE"))) + simple("UNTIL")
    return code


def way_codes(seed: int, count: int) -> list[bytes]:
    """Return code with ways, a part of it changed: second bytes that are none, and cut ones."""
    rng = random.Random(seed)
    tasks = list(task_codes(seed, count))
    codes = []
    for number in range(count):
        code = way_code(rng) + (likely_code(rng) if rng.random() < 0.3 else b"")
        if number % 3 == 0:
            code = tasks[number] + way_code(rng)
        if number % 4 == 1:
            code = mutate_code(rng, code, rng.choice(tasks))
        if number % 8 == 2:
            code = (
                code[: rng.randrange(len(code))]
                + bytes((ESCAPE, rng.randrange(256)))[: rng.choice((1, 2))]
            )
        codes.append(code)
    return codes


def check_way_codes(machine: Process, seed: int, count: int) -> None:
    """Check that verdicts agree whatever the image needs; accepted code without tasks runs
    alike.
    """
    count_by_end: Counter[str] = Counter()
    codes = way_codes(seed, count)
    codes += [bytes(code) for code in ((ESCAPE,), *((ESCAPE, opcode) for opcode in range(256)))]
    pushed_bytes = simple("PUSH_NUM_2") * 2
    codes += [pushed_bytes + bytes((ESCAPE, opcode)) for opcode in range(256)]
    for needs in (0, TASKS, GO, ALL_NEEDS):
        accepted_bytes = compare_verdicts(machine, codes, *SIZES, needs)
        if needs != GO:
            continue
        for code in accepted_bytes:
            count_by_end[compare_runs(machine, code, WIDE_KIT, Senses({}, MAX_MS, MAX_STEPS))] += 1
    assert {"DONE", "LIMIT", "NO_POWER", "OVERFLOW"} <= set(count_by_end), count_by_end
    assert "BAD_CODE" not in count_by_end


def check_way_programs(machine: Process, first_seed: int, count: int) -> None:
    """Random programs with ways, with tasks and without, run alike."""
    count_by_end: Counter[str] = Counter()
    for image, kit, senses in some_way_programs(first_seed, count):
        run = machine.run(image, kit, senses)
        expected_run = run_in_python(image, kit, senses)
        assert machine.agrees(run, expected_run, senses.max_ms), image.hex(" ")
        count_by_end[run.trace.split()[-1]] += 1
    assert {"DONE", "LIMIT", "NO_POWER"} <= set(count_by_end), count_by_end


def some_way_programs(first_seed: int, count: int) -> list[tuple[bytes, Kit, Senses]]:
    """Return images of random programs with moves by distance, every second one with tasks."""
    codes = []
    for seed in range(first_seed, first_seed + count):
        rng = random.Random(seed)
        oracle_kit, kit = KITS[seed // 2 % 2]
        if seed % 2:
            text, readings = task_program(rng, ways=True)
            kit, max_ms = KIT, TASK_MS
        else:
            text = programs.program(rng, oracle_kit, ways=True)
            readings, max_ms = programs.senses(rng, oracle_kit), MAX_MS
        image = compile_text(text, kit).image
        codes.append((image, kit, Senses(readings, max_ms, 2000, seed + 1)))
    return codes


# -- images -------------------------------------------------------------------------------------


def python_refusal(data: bytes) -> int:
    try:
        unpack(data)
    except ImageRefused as refusal:
        return refusal.number
    return 0


def short_headers() -> Iterator[bytes]:
    """Yield images whose headers are too short by each number of bytes, and otherwise valid."""
    header = pack("SI", 0, b"")
    for length in range(HEADER_BYTES):
        yield with_checksum(header[:5] + bytes([length]) + header[6:])


def check_images(machine: Process, seed: int, count: int) -> None:
    """Headers are refused for the same reasons, and each for some image."""
    images = [*random_images(seed, count), b"", b"T", b"TS", b"S", b"TX", *short_headers()]
    machine_refusals = machine.refusals(images)
    for image, reason in zip(images, machine_refusals, strict=True):
        expected_refusal = python_refusal(image)
        assert expected_refusal == reason, f"{image.hex(' ')}: {expected_refusal}, not {reason}"
    headers = {number for name, (number, _) in REFUSALS.items() if name != "OTHER_KIT"}
    assert {*machine_refusals} == {0, *headers}


def refusal_of(load: Callable[[], object]) -> str:
    """Return the reason and offset of an image's refusal, or ""."""
    try:
        load()
    except (ImageRefused, Refused) as refusal:
        return f"{refusal.number} {refusal}"
    return ""


def check_whole_images(machine: Process, seed: int, count: int) -> None:
    """Check changed programs, for robots of which some have other devices."""
    rng = random.Random(seed)
    senses = Senses(max_ms=100, max_steps=20)
    refusals = set()
    for image, kit in images_of_programs(seed, count):
        for robot in (kit, changed_kit(rng, kit)):
            expected_refusal = refusal_of(lambda data=image, kit=robot: load_image(data, kit))  # type: ignore[misc]
            machine_refusal = refusal_of(
                lambda data=image, kit=robot: machine.run(data, kit, senses)  # type: ignore[misc]
            )
            assert expected_refusal == machine_refusal, (
                f"{image.hex(' ')}: {expected_refusal!r}, not {machine_refusal!r}"
            )
            refusals.add(expected_refusal.partition(" ")[2].partition(" ")[0])
    assert {"", "OTHER_KIT", "NO_SUCH_DEVICE", "OTHER_VERSION", "DAMAGED"} <= refusals, refusals
