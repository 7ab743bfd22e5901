"""What holds of moves by centimetres and degrees in C++: each check compares with Python."""

from __future__ import annotations

import random
from collections import Counter

from tests.machines import Senses
from tests.machines.host import Process
from tests.machines.python import ran_python
from tests.oracle import programs
from tests.oracle.task_programs import task_program
from tests.support.cpp_checks import MAX_MS, MAX_STEPS, SIZES, compare_runs, compare_verdicts
from tests.support.kits import KITS
from tests.support.random_codes import any_number, likely_code, mutated, simple, task_codes
from tiniscript import compile_text
from tiniscript.base.kit import Kit
from tiniscript.bytecode.image import EVERYTHING, GO, TASKS
from tiniscript.bytecode.opcodes import ESCAPE, ESCAPED

TASK_MS = 600
WAYS = [op.opcode for op in ESCAPED.values()]


def way_code(rng: random.Random) -> bytes:
    """Return a move by any way and power, mostly right; with an UNTIL or without."""
    values = (any_number(rng), rng.choice((any_number(rng), rng.randrange(-5, 105) * 1000)))
    pushes = [simple("PUSH32") + each.to_bytes(4, "little", signed=True) for each in values]
    code = b"".join(pushes) + rng.choice(WAYS)
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
            code = mutated(rng, code, rng.choice(tasks))
        if number % 8 == 2:
            code = (
                code[: rng.randrange(len(code))]
                + bytes((ESCAPE, rng.randrange(256)))[: rng.choice((1, 2))]
            )
        codes.append(code)
    return codes


def check_way_codes(machine: Process, seed: int, count: int) -> None:
    """The same verdicts, whatever the image needs; what is accepted and has no tasks runs alike."""
    kit = KITS[1][1]
    ends: Counter[str] = Counter()
    codes = way_codes(seed, count)
    codes += [bytes(each) for each in ((ESCAPE,), *((ESCAPE, second) for second in range(256)))]
    pushed = simple("PUSH_NUM_2") * 2
    codes += [pushed + bytes((ESCAPE, second)) for second in range(256)]
    for needs in (0, TASKS, GO, EVERYTHING):
        accepted = compare_verdicts(machine, codes, *SIZES, needs)
        if needs != GO:
            continue
        for code in accepted:
            ends[compare_runs(machine, code, kit, Senses({}, MAX_MS, MAX_STEPS))] += 1
    assert {"DONE", "LIMIT", "NO_POWER", "OVERFLOW"} <= set(ends), ends
    assert "BAD_CODE" not in ends


def check_way_programs(machine: Process, first: int, count: int) -> None:
    """Random programs with ways, with tasks and without, run alike to the last step."""
    ends: Counter[str] = Counter()
    for image, kit, senses in some_way_programs(first, count):
        ran = machine.run(image, kit, senses)
        assert ran == ran_python(image, kit, senses), image.hex(" ")
        ends[ran.trace.split()[-1]] += 1
    assert {"DONE", "LIMIT", "NO_POWER"} <= set(ends), ends


def some_way_programs(first: int, count: int) -> list[tuple[bytes, Kit, Senses]]:
    """Return images of random programs whose moves go by ways, each second one with tasks."""
    found = []
    for seed in range(first, first + count):
        rng = random.Random(seed)
        theirs, kit = KITS[seed // 2 % 2]
        if seed % 2:
            text, readings = task_program(rng, ways=True)
            kit, max_ms = KITS[0][1], TASK_MS
        else:
            text = programs.program(rng, theirs, ways=True)
            readings, max_ms = programs.senses(rng, theirs), MAX_MS
        image = compile_text(text, kit).image
        found.append((image, kit, Senses(readings, max_ms, 2000, seed + 1)))
    return found
