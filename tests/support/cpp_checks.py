"""What holds of the machine in C++: each check asks one process, and compares with Python.

`test_cpp_agreement` runs these on this computer, `test_cpp_chips` on chips. Nothing asked depends
on time or chance: the same machine gives the same answers.
"""

from __future__ import annotations

import operator
import random
from collections import Counter
from collections.abc import Callable, Sequence
from itertools import product

from tests.machines import Senses
from tests.machines.host import Process
from tests.oracle import programs
from tests.support.images import image_for
from tests.support.kits import KITS
from tests.support.random_codes import EDGES, any_number, random_codes
from tiniscript import compile_text
from tiniscript.base import fixed_point
from tiniscript.base.kit import Kit
from tiniscript.base.trace import Ending, TracedRobot
from tiniscript.base.trace import Senses as Lists
from tiniscript.base.words import COMPARATORS
from tiniscript.bytecode.image import unpack
from tiniscript.bytecode.opcodes import BY_NAME, FAULTS
from tiniscript.bytecode.verify import Refused, verify
from tiniscript.vm.machine import Machine
from tiniscript.vm.runner import MachineOf, run
from tiniscript.vm.state import WAITING

WIDE = KITS[1][1]
SIZES = len(WIDE.sensors), len(WIDE.actuators)
MAX_MS, MAX_STEPS = 3000, 300  # of the random codes that are accepted


def python_verdict(code: bytes, sensors: int, actuators: int, needs: int = 0) -> tuple[int, int]:
    """Return what Python says of code, in an image that says what it needs."""
    try:
        verify(code, sensors, actuators, needs)
    except Refused as refused:
        return refused.number, refused.offset
    return 0, 0


def compare_verdicts(
    machine: Process, codes: Sequence[bytes], sensors: int, actuators: int, needs: int = 0
) -> list[bytes]:
    """Assert that both machines say the same of each code; return those that are accepted."""
    theirs = machine.verdicts(codes, sensors, actuators, needs)
    accepted = []
    for code, (rule, offset) in zip(codes, theirs, strict=True):
        ours = python_verdict(code, sensors, actuators, needs)
        # the offset of what is accepted is its length
        said = (rule, offset if rule else 0)
        assert ours == said, f"{code.hex(' ')} for {sensors}, {actuators}: {ours}, not {said}"
        if not rule:
            accepted.append(code)
    return accepted


def compare_runs(machine: Process, code: bytes, kit: Kit, senses: Senses) -> str:
    """Assert that both machines run accepted code alike to the last step; return the ending."""
    lists = {k: senses.readings.get(each.name, ()) for k, each in enumerate(kit.sensors)}
    events = list(run(code, kit, Lists(kit, lists), senses.max_ms, senses.max_steps, senses.seed))
    ending = events.pop()
    assert isinstance(ending, Ending)
    ran = machine.run(image_for(code, kit), kit, senses)
    ours = "".join(f"{event}\n" for event in events)
    assert ran.trace == ours, f"{code.hex(' ')}:\n{ours}not\n{ran.trace}"
    assert (ran.offset, ran.steps) == (ending.offset, ending.steps), code.hex(" ")
    return ending.fault or ending.what


# -- code ---------------------------------------------------------------------------------------


def check_codes(machine: Process, seed: int, count: int) -> Counter[str]:
    """Compare random codes, and run what is accepted; return how often each thing happened."""
    rng = random.Random(seed)
    oracle_kit, kit = KITS[seed % 2]
    seen: Counter[str] = Counter()
    sizes = len(kit.sensors), len(kit.actuators)
    codes = list(random_codes(seed, count))
    accepted = compare_verdicts(machine, codes, *sizes)
    for number, code in enumerate(accepted):
        senses = Senses(programs.senses(rng, oracle_kit), MAX_MS, MAX_STEPS, number + 1)
        seen[compare_runs(machine, code, kit, senses)] += 1
    seen["accepted"] = len(accepted)
    seen.update(str(rule) for rule, _ in machine.verdicts(codes, *sizes))
    return seen


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
    lists = {k: senses.readings.get(each.name, ()) for k, each in enumerate(kit.sensors)}
    robot = TracedRobot(kit, Lists(kit, lists))
    machine = machine_of(unpack(image).code, robot, len(kit.sensors), senses.seed)
    for late in late_ms:
        if machine.tick(robot.now_ms, LATE_BUDGET) != WAITING:
            break
        robot.now_ms = max(machine.wake_ms, robot.now_ms) + late
    return "".join(f"{event}\n" for event in robot.events)


# Ticks at 2^31 - 8 and 2^32 - 16 ms, both multiples of 20, and then in time, for what waits from 0.
ROUND_MS = (2**31 - 28, 2**31 - 28, 0, 0, 0, 7, 30, 0, 0)
ROUND = "F(FOREVER, 80) UNTIL(DISTANCE < 10); W(0.1)"
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
    assert run(compile_text(ROUND, kit).image, kit, senses, ROUND_MS) == ROUND_TRACE


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
    "END": lambda a, b: fixed_point.whole(a),  # of no use here: stands for `whole`
}
# 2^32 thousandths, after they are rounded: products and quotients
ROUNDED_TOO_LARGE = [
    (a * sign, b)
    for a, b in ((2047, 2_098_176_500), (2832, 1_516_584_497), (304_942_678, 71), (420_906_795, 98))
    for sign in (1, -1)
]
NUMBER_OF = {name: number for number, name, _ in FAULTS}


def python_result(name: str, a: int, b: int) -> tuple[int, int]:
    try:
        return 0, OPERATIONS[name](a, b)
    except fixed_point.Fault as fault:
        return NUMBER_OF[fault.name], 0


def check_arithmetic(machine: Process, name: str, count: int) -> None:
    """All pairs of edges, some sizes that fit, and any others: so many operations in all."""
    rng = random.Random(name)
    pairs = list(product(EDGES, EDGES))
    pairs += ROUNDED_TOO_LARGE
    pairs += [(any_number(rng), any_number(rng)) for _ in range(count - len(pairs))]
    code = BY_NAME[name].code
    theirs = machine.results((code, a, b) for a, b in pairs)
    for (a, b), result in zip(pairs, theirs, strict=True):
        ours = python_result(name, a, b)
        assert ours == result, f"{name} {a} {b}: {ours}, not {result}"
