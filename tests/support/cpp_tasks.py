"""What holds of programs with TASK and WHEN in C++: each check compares with Python."""

from __future__ import annotations

import random
from collections.abc import Iterator

from tests.machines import Senses
from tests.machines.host import Process
from tests.machines.python import ran_python
from tests.oracle.task_programs import task_program
from tests.support.cpp_checks import LATE_BUDGET, SIZES, compare_verdicts
from tests.support.kits import KITS
from tests.support.random_codes import mutated, task_codes
from tiniscript import compile_text
from tiniscript.base.trace import Senses as Lists
from tiniscript.base.trace import TracedRobot
from tiniscript.bytecode.image import TASKS, unpack
from tiniscript.vm.state import DONE, FAULT, WAITING
from tiniscript.vm.tasks import machine_of

KIT = KITS[0][1]
MAX_MS = 600
Program = tuple[bytes, Senses]


FAR = f"A = 0;N = 0;IF(N > 0);{'SHOW(8);' * 140}ENDIF;"  # more than 256 bytes


def some_task_programs(first: int, count: int, before: str = "") -> Iterator[Program]:
    """Yield images of random programs with tasks, and what their sensors read.

    All that a program does lies behind the code of the text `before`.
    """
    for seed in range(first, first + count):
        text, readings = task_program(random.Random(seed))
        yield compile_text(before + text, KIT).image, Senses(readings, MAX_MS, seed=seed + 1)


def check_task_codes(machine: Process, seed: int, count: int) -> None:
    """Code with tasks has the same verdict, in images that may have some and in others."""
    rng = random.Random(seed)
    codes = list(task_codes(seed, count))
    codes += [mutated(rng, code, rng.choice(codes)) for code in codes]
    rules = set()
    for needs in (0, TASKS):
        accepted = compare_verdicts(machine, codes, *SIZES, needs)
        assert bool(accepted) == bool(needs) or len(accepted) < len(codes) / 4
        rules |= {rule for rule, _ in machine.verdicts(codes, *SIZES, needs)}
    # accepted, UNKNOWN_OPCODE, STACK_NOT_EMPTY, NOT_OPEN, STILL_OPEN, BAD_DEF, INSIDE_CHECK,
    # TOO_MANY_TASKS
    assert {0, 21, 27, 32, 33, 35, 38, 40} <= rules, rules


def check_task_programs(machine: Process, first: int, count: int) -> None:
    for image, senses in some_task_programs(first, count):
        assert machine.run(image, KIT, senses) == ran_python(image, KIT, senses), first


class SlowRobot(TracedRobot):
    """A robot that is not ready each `not_ready`th time that it is asked."""

    asked = 0
    not_ready = 0

    def is_ready(self) -> bool:
        self.asked += 1
        return not self.not_ready or self.asked % self.not_ready != 0

    def read(self, sensor: int) -> int | None:
        return super().read(sensor) if self.is_ready() else None

    def show(self, value: int, is_yes_no: bool) -> bool:
        return self.is_ready() and super().show(value, is_yes_no)


def slow_run(image: bytes, senses: Senses, not_ready: int, late_ms: int = 0) -> str:
    """Return the trace of Python's machine on a robot that is not always ready.

    Its clock moves by more than a millisecond at once, so that ticks come up to `late_ms` late.
    """
    step_ms = late_ms + 1
    lists = {k: senses.readings.get(each.name, ()) for k, each in enumerate(KIT.sensors)}
    robot = SlowRobot(KIT, Lists(KIT, lists))
    robot.not_ready = not_ready
    machine = machine_of(unpack(image).code, robot, len(KIT.sensors), senses.seed)
    end = ""
    while not end:
        status = machine.tick(robot.now_ms, LATE_BUDGET)
        if status in (DONE, FAULT):
            end = f"{robot.now_ms} {status.upper()} {machine.fault}".strip()
        elif status == WAITING:
            robot.now_ms = -(-machine.wake_ms // step_ms) * step_ms
            if robot.now_ms > senses.max_ms:
                end = f"{senses.max_ms} LIMIT"
    return "".join(f"{event}\n" for event in robot.events) + end + "\n"
