"""Python and C++ agree: verdicts, refusals, arithmetic, and every line of every run.

`python -m tests.test_cpp_agreement 10000000` compares more random codes than the tests, and
`--three` all codes of three bytes.
"""

from __future__ import annotations

import argparse
import operator
import os
import random
import time
import zlib
from collections import Counter
from collections.abc import Callable, Iterator
from itertools import product
from struct import pack as struct_pack

import pytest

from tests.casefile import Case, all_cases
from tests.kits import KITS
from tests.machines import MACHINES, Senses
from tests.machines.host import Process, host, missing
from tests.oracle import programs
from tests.test_cases import robot_and_senses
from tiniscript import compile_text, thousandths
from tiniscript.bytecode import BY_NAME, CODE_BYTES, COMPARATORS, FAULTS, OPS, Op
from tiniscript.image import HEADER_BYTES, REFUSALS, ImageRefused, pack, unpack
from tiniscript.kit import Kit
from tiniscript.listing import read_listing
from tiniscript.run import Ending, TracedRobot, run
from tiniscript.run import Senses as Lists
from tiniscript.task import WAITING
from tiniscript.verify import RULES, Refused, verify
from tiniscript.vm import Machine

needs_host = pytest.mark.skipif(bool(missing()), reason=missing() or "there is a host machine")
CASES = all_cases()
WIDE = KITS[1][1]
SIZES = len(WIDE.sensors), len(WIDE.actuators)
BATCH = 25_000
BATCHES = 40  # in the tests
MAX_MS, MAX_STEPS = 3000, 300  # of the random codes that are accepted


def test_the_host_machine_is_there() -> None:
    """Without a compiler this leg is left out, and says so; in CI that is a failure."""
    if missing():
        assert not os.environ.get("CI"), missing()
        pytest.skip(missing())
    assert "host" in MACHINES


def python_verdict(code: bytes, sensors: int, actuators: int) -> tuple[int, int]:
    try:
        verify(code, sensors, actuators)
    except Refused as refused:
        return refused.number, refused.offset
    return 0, 0


def compare_verdicts(
    codes: list[bytes], sensors: int, actuators: int, machine: Process | None = None
) -> list[bytes]:
    """Assert that both machines say the same of each code; return those that are accepted.

    The other machine is the host's, here and below, where none is given.
    """
    theirs = (machine or host()).verdicts(codes, sensors, actuators)
    accepted = []
    for code, (rule, offset) in zip(codes, theirs, strict=True):
        ours = python_verdict(code, sensors, actuators)
        # the offset of what is accepted is its length
        assert ours == (rule, offset if rule else 0), f"{code.hex(' ')} for {sensors}, {actuators}"
        if not rule:
            accepted.append(code)
    return accepted


def compare_runs(code: bytes, kit: Kit, senses: Senses, machine: Process | None = None) -> str:
    """Assert that both machines run accepted code alike to the last step; return the ending."""
    lists = {k: senses.readings.get(each.name, ()) for k, each in enumerate(kit.sensors)}
    events = list(run(code, kit, Lists(kit, lists), senses.max_ms, senses.max_steps, senses.seed))
    ending = events.pop()
    assert isinstance(ending, Ending)
    ran = (machine or host()).run(pack("SI", kit.fingerprint, code), kit, senses)
    ours = "".join(f"{event}\n" for event in events)
    assert ran.trace == ours, code.hex(" ")
    assert (ran.offset, ran.steps) == (ending.offset, ending.steps), code.hex(" ")
    return ending.fault or ending.what


# -- the cases ----------------------------------------------------------------------------------


@needs_host
@pytest.mark.parametrize(
    "case",
    [
        pytest.param(case, id=case.id)
        for case in CASES
        if "bytecode" in case.parts and "tiniscript" not in case.parts
    ],
)
def test_listing_has_the_same_verdict(case: Case) -> None:
    kit = robot_and_senses(case)[0].kit
    code = read_listing(case.parts["bytecode"])
    for length in range(len(code) + 1):
        compare_verdicts([code[:length]], len(kit.sensors), len(kit.actuators))


@needs_host
@pytest.mark.parametrize("length", [0, 1, CODE_BYTES - 1, CODE_BYTES, CODE_BYTES + 1, 100_000])
def test_length_of_code(length: int) -> None:
    compare_verdicts([bytes([BY_NAME["STOP"].code]) * length], 3, 2)


@needs_host
@pytest.mark.parametrize("devices", [0, 1, 32, 33, 255])
def test_number_of_devices(devices: int) -> None:
    codes = [bytes([BY_NAME["READ"].code, k]) for k in range(256)]
    codes += [bytes([BY_NAME["PUSH_TRUE"].code, BY_NAME["SET"].code, k]) for k in range(256)]
    compare_verdicts(codes, devices, 255 - devices)


# -- short codes, all of them -------------------------------------------------------------------


@needs_host
def test_all_codes_of_up_to_two_bytes() -> None:
    every = [bytes(each) for size in range(3) for each in product(range(256), repeat=size)]
    for code in compare_verdicts(every, *SIZES):
        compare_runs(code, WIDE, Senses(max_ms=100, max_steps=50))


@needs_host
@pytest.mark.parametrize("few_at", [1, 2])
def test_codes_of_three_bytes_with_two_opcodes(few_at: int) -> None:
    """All pairs of opcodes; the third byte is one of the edges of its ranges."""
    opcodes = [op.code for op in OPS]
    few = (0, 1, 2, 3, 31, 32, 100, 101, 127, 128, 156, 255)
    sets = [opcodes, opcodes, opcodes]
    sets[few_at] = list(few)
    codes = [bytes(each) for each in product(*sets)]
    for code in compare_verdicts(codes, *SIZES):
        compare_runs(code, WIDE, Senses(max_ms=100, max_steps=50))


@needs_host
@pytest.mark.parametrize("first", range(0, 256, 16), ids=lambda first: f"from {first:02x}")
def test_all_codes_of_three_bytes_run_safely(first: int) -> None:
    """In C++ alone: what its verifier accepts never fails a run-time check."""
    for byte in range(first, first + 16):
        accepted, bad, _ = host().all_of_three(byte, 3, 2)
        assert bad == 0, f"{bad} of {accepted} codes that begin with {byte:02x}"


def compare_three(first: int) -> int:
    """Assert that both say the same of all codes of three bytes that begin with `first`.

    Return how many are accepted.
    """
    accepted, bad, checksum = host().all_of_three(first, 3, 2)
    ours = 0
    for rest in product(range(256), repeat=2):
        verdict = python_verdict(bytes((first, *rest)), 3, 2)
        ours = zlib.crc32(struct_pack("<BH", *verdict), ours)
    assert (bad, checksum) == (0, ours), f"{first:02x}"
    return accepted


@needs_host
@pytest.mark.parametrize(
    "name",
    ["PUSH_TRUE", "PUSH_VAR", "ADD_VAR", "READ", "MOVE8_F", "MOTORS8", "STOP", "FOREVER", "DEF"],
)
def test_codes_of_three_bytes_that_begin_alike(name: str) -> None:
    """A sample of `--three`: what begins with an instruction of one, two or three bytes."""
    assert compare_three(BY_NAME[name].code) > 0


# -- random codes -------------------------------------------------------------------------------


def operand_bytes(rng: random.Random, op: Op) -> bytes:
    """Return operands of `op`: often right ones, near jumps, and edges."""
    parts = b""
    for operand in op.operands:
        kind = operand.kind
        if kind.name.startswith(("fwd", "back")):
            value = rng.randrange(16) if rng.random() < 0.9 else rng.randint(kind.low, kind.high)
        elif kind.name in ("sensor", "actuator", "variable"):
            value = rng.randrange(4) if rng.random() < 0.98 else rng.randrange(40)
        elif rng.random() < 0.6:
            value = rng.randint(max(kind.low, -3), 12)
        else:
            value = rng.choice((kind.low, kind.high, rng.randint(kind.low, kind.high)))
        parts += value.to_bytes(kind.size, "little", signed=kind.signed and value < 0)
    return parts


def likely_code(rng: random.Random) -> bytes:
    """Return instructions in a row whose stack fits: the structure is left to chance."""
    code = b""
    depth = 0
    few = rng.sample(OPS, rng.randint(3, 12))
    for _ in range(rng.randrange(1, 14)):
        op = rng.choice(few if rng.random() < 0.8 else OPS)
        while depth < op.pops:
            if rng.random() < 0.8:
                code += bytes((BY_NAME["PUSH8"].code, rng.randrange(256)))
            else:
                code += simple("PUSH32") + any_number(rng).to_bytes(4, "little", signed=True)
            depth += 1
        if depth > op.pops and op.role not in ("value", "join") and rng.random() < 0.9:
            continue
        code += bytes([op.code]) + operand_bytes(rng, op)
        depth += op.pushes - op.pops
    return code


def nested_code(rng: random.Random, levels: int) -> bytes:
    """Return loops, branches and checks in one another, mostly right."""
    code = b""
    for _ in range(rng.randrange(4)):
        inner = nested_code(rng, levels - 1) if levels else likely_code(rng)[:8]
        far = rng.random() < 0.3
        kind = rng.randrange(8)
        answer, branch = (
            simple(rng.choice(("PUSH_TRUE", "PUSH_FALSE"))),
            rng.choice(("IF", "IF_NOT")),
        )
        slip = rng.choice((0, 0, 0, 0, 0, 0, 1, -1, 2, 65_530))
        if kind == 0:
            code += simple("FOREVER") + inner
            code += jump("AGAIN", far, len(inner) + (3 if far else 2) + slip)
        elif kind == 1:
            close = jump("NEXT", far, len(inner) + (3 if far else 2) + slip)
            times = bytes((BY_NAME["PUSH8"].code, rng.randrange(3)))
            counted = times + jump("LOOP", rng.random() < 0.5, len(inner + close) + slip)
            code += rng.choice((simple("LOOP8") + b"\x02", counted)) + inner + close
        elif kind == 2:
            body = inner + jump("BREAK_LOOP", far, slip + 3 if far else slip + 2)
            close = jump("NEXT", far, len(body) + (3 if far else 2))
            code += simple("LOOP8") + b"\x03" + body + close
        elif kind == 3:
            code += answer + jump(branch, far, len(inner) + slip) + inner
        elif kind == 4:
            other = likely_code(rng)[:6]
            skip = jump("ELSE", far, len(other) + slip)
            code += answer + jump(branch, far, len(inner) + len(skip)) + inner
            code += skip + other
        elif kind == 5:
            end = inner + simple("RETURN")
            code += jump("DEF", far, len(end) + slip) + end
            code += jump("CALL", far, len(end) + (3 if far else 2) + rng.choice((0, 0, slip)))
        elif kind == 6:
            check = bytes((BY_NAME["PUSH_READ"].code, 0, BY_NAME["PUSH8"].code, 5))
            check += simple("LT")
            code += simple("WATCH_FOREVER_WAIT") + check
            code += jump("UNTIL", far, len(check) + (3 if far else 2) + slip)
        else:
            inner = jump("BREAK", far, len(inner) + (3 if far else 2)) + inner
            back = jump("AGAIN", far, len(inner) + (3 if far else 2))
            code += rng.choice((simple("FOREVER"), jump("WHILE", far, len(inner + back) + slip)))
            code += inner + back
    return code


def deep_code(rng: random.Random) -> bytes:
    """Return one thing in itself or in a row, about as often as a machine remembers."""
    kind = rng.randrange(8)
    usual = 15, 16, 17
    often = rng.choice({1: (16, 31, 32, 33), 5: (6, 7, 8), 6: (3, 4, 5)}.get(kind, usual))
    yes = simple("PUSH_TRUE")
    code = simple("STOP") if rng.random() < 0.9 else b""
    if kind == 0:
        return simple("TIME") * often + simple("ADD") * (often - 1) + simple("SHOW")
    if kind == 1:
        for _ in range(often):
            code = yes + jump("IF", True, len(code)) + code + simple("STOP")
    elif kind == 2:
        for _ in range(often):
            code = loop(code, 2 if rng.random() < 0.3 else 1)
    elif kind == 3:
        for _ in range(often):
            code = simple("FOREVER") + code + jump("BREAK", True, 3)
            code += jump("AGAIN", True, len(code) + 2)
    elif kind == 4:
        join = rng.choice(("AND_THEN", "OR_ELSE"))
        code = yes
        for _ in range(often):
            code = yes + jump(join, rng.random() < 0.5, len(code)) + code
        code += simple("SHOW_YES_NO")
    elif kind == 5:  # each procedure calls the one before it
        code = jump("DEF", False, 2) + simple("STOP") + simple("RETURN")
        for _ in range(often):
            inner = jump("CALL", False, 6 if len(code) == 4 else 7) + simple("RETURN")
            code += jump("DEF", False, len(inner)) + inner
        code += jump("CALL", False, 5)
    elif kind == 6:  # loops around calls of procedures with loops
        inner = simple("STOP")
        for _ in range(often):
            inner = loop(inner, 1)
        ways = len(inner) + 1
        code = jump("DEF", False, ways) + inner + simple("RETURN")
        body = jump("CALL", False, ways + 2)
        for depth in range(rng.choice((10, 11, 12, 13))):
            body = simple("LOOP8") + b"\x01" + body + jump("NEXT", False, 4 + 4 * depth)
            # the call lies further behind the procedure with each loop around it
            at = body.index(BY_NAME["CALL"].code)
            body = body[: at + 1] + bytes([ways + at + 2]) + body[at + 2 :]
        code += body
    else:
        end = simple("RETURN")
        code = (jump("DEF", False, len(end)) + end) * often + jump("CALL", False, 3)
    return code


def expression(rng: random.Random) -> bytes:
    """Return code that shows a value calculated from numbers of all sizes."""
    code, depth = b"", 0
    ops = [op for op in OPS if op.role == "value" and not op.operands]
    for _ in range(rng.randrange(1, 12)):
        op = rng.choice(ops)
        while depth < op.pops:
            code += simple("PUSH32") + any_number(rng).to_bytes(4, "little", signed=True)
            depth += 1
        code += bytes([op.code])
        depth += op.pushes - op.pops
    return code + simple("SHOW") * depth


def branches(rng: random.Random) -> bytes:
    """Return branches with values and constants that are often near one another."""
    code = b""
    body = simple("STOP")
    for _ in range(6):
        op = rng.choice([op for op in OPS if op.role == "if"])
        near = rng.choice((0, 1, 2, 9, 200))
        code += simple("PUSH16") + near.to_bytes(2, "little") + simple("SET_VAR") + b"\x01"
        if op.pops:
            code += simple(rng.choice(("PUSH_TRUE", "PUSH_FALSE"))) + bytes([op.code])
        else:
            code += bytes([op.code, 1])
            number = near + rng.choice((-1, 0, 0, 1))
            size = op.operands[1].kind.size
            code += (number & ((1 << 8 * size) - 1)).to_bytes(size, "little")
        code += len(body).to_bytes(op.operands[-1].kind.size, "little") + body
    return code


def loop(inner: bytes, times: int) -> bytes:
    return simple("LOOP8") + bytes([times]) + inner + jump("NEXT", True, len(inner) + 3)


def simple(name: str) -> bytes:
    return bytes([BY_NAME[name].code])


def jump(name: str, far: bool, distance: int) -> bytes:
    size = 2 if far else 1
    return simple(name + "_FAR" * far) + (distance & ((1 << 8 * size) - 1)).to_bytes(size, "little")


def mutated(rng: random.Random, code: bytes, other: bytes) -> bytes:
    data = bytearray(code)
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        at = rng.randrange(len(data) + 1)
        kind = rng.randrange(7)
        if kind == 0:
            data[at:at] = bytes([rng.randrange(256)])
        elif kind == 1:
            del data[at : at + rng.choice((1, 1, 2, 3))]
        elif kind == 2:
            data[at:] = other[rng.randrange(len(other) + 1) :]
        elif at < len(data):
            delta = rng.choice((1, 255, 2, 254))
            choices = (rng.randrange(256), rng.choice(OPS).code, (data[at] + delta) % 256)
            data[at] = rng.choice(choices)
    return bytes(data)


def random_codes(seed: int, count: int) -> Iterator[bytes]:
    """Yield random and mutated codes: programs, likely instructions, nested and deep blocks."""
    rng = random.Random(seed)
    bases = [b"", b""]
    for number in range(count):
        kind = number % 8
        if number % 400 == 0:
            oracle_kit, kit = KITS[number // 400 % 2]
            text = programs.program(rng, oracle_kit)
            bases.append(compile_text(text, kit, optimize=rng.random() < 0.5).code)
            bases = bases[-20:]
            yield bases[-1]
        elif number % 40 == 0:
            yield deep_code(rng)
        elif number % 40 == 16:
            yield expression(rng)
        elif number % 40 == 24:
            yield branches(rng)
        elif kind == 0:
            yield rng.randbytes(rng.randrange(8))
        elif kind in (1, 2):
            yield likely_code(rng)
        elif kind == 3:
            yield nested_code(rng, rng.randrange(4))
        elif kind == 4:
            yield mutated(rng, nested_code(rng, rng.randrange(3)), likely_code(rng))
        else:
            yield mutated(rng, rng.choice(bases), rng.choice(bases))


def check_codes(seed: int, count: int, machine: Process | None = None) -> Counter[str]:
    """Compare random codes, and run what is accepted; return how often each thing happened."""
    rng = random.Random(seed)
    oracle_kit, kit = KITS[seed % 2]
    seen: Counter[str] = Counter()
    sizes = len(kit.sensors), len(kit.actuators)
    codes = list(random_codes(seed, count))
    accepted = compare_verdicts(codes, *sizes, machine)
    for number, code in enumerate(accepted):
        senses = Senses(programs.senses(rng, oracle_kit), MAX_MS, MAX_STEPS, number + 1)
        seen[compare_runs(code, kit, senses, machine)] += 1
    seen["accepted"] = len(accepted)
    seen.update(str(rule) for rule, _ in (machine or host()).verdicts(codes, *sizes))
    return seen


@needs_host
@pytest.mark.parametrize("seed", range(BATCHES))
def test_random_codes(seed: int) -> None:
    """A million in all; each batch breaks every rule and comes to every ending."""
    seen = check_codes(seed, BATCH)
    rules = {str(number) for name, (number, _) in RULES.items() if name != "CODE_LENGTH"}
    assert rules <= set(seen), sorted(rules - set(seen))
    assert {"DONE", "LIMIT", "OVERFLOW", "DIVIDE_BY_ZERO"} <= set(seen)
    assert "BAD_CODE" not in seen


@needs_host
def test_many_defs() -> None:
    for count in range(20):
        for calls in range(12):
            end = simple("RETURN")
            one = jump("DEF", False, len(end)) + end
            code = one * count + jump("CALL", False, 3) * (calls if count else 0)
            compare_verdicts([code], 3, 2)


@needs_host
def test_whatever_the_code_the_machine_keeps_to_its_memory() -> None:
    """Code that no verifier has seen: it ends, waits or faults; sanitizers see what else."""
    kit = KITS[1][1]
    endings: Counter[str] = Counter()
    for code in random_codes(1, 20_000):
        ran = host().run_unverified(code, kit, Senses(max_ms=MAX_MS, max_steps=MAX_STEPS))
        endings[ran.trace.split()[-1]] += 1
    assert endings["BAD_CODE"] > 1000
    assert endings["DONE"] > 1000


# -- time and a robot that is not ready ---------------------------------------------------------


def some_programs() -> Iterator[tuple[bytes, Kit, Senses]]:
    for seed in range(300):
        rng = random.Random(seed)
        oracle_kit, kit = KITS[seed % 2]
        image = compile_text(programs.program(rng, oracle_kit), kit).image
        yield image, kit, Senses(programs.senses(rng, oracle_kit), 20_000, 5000, seed + 1)


@needs_host
@pytest.mark.parametrize("begin_ms", [1, 2**31 - 500, 2**31, 2**32 - 1, 2**32 - 1500])
def test_the_clock_may_wrap_around(begin_ms: int) -> None:
    for image, kit, senses in some_programs():
        assert host().run(image, kit, senses, begin_ms=begin_ms) == host().run(image, kit, senses)


LATE_BUDGET = 250  # instructions


def run_late(image: bytes, kit: Kit, senses: Senses, late_ms: int) -> str:
    """Return the trace of Python's machine where each tick after a wait comes late."""
    lists = {k: senses.readings.get(each.name, ()) for k, each in enumerate(kit.sensors)}
    robot = TracedRobot(kit, Lists(kit, lists))
    machine = Machine(unpack(image).code, robot, len(kit.sensors), senses.seed)
    for count in range(1, 200):
        if machine.tick(robot.now_ms, LATE_BUDGET) != WAITING:
            break
        robot.now_ms = machine.task.wake_ms + count * 7 % (late_ms + 1)
    return "".join(f"{event}\n" for event in robot.events)


@needs_host
@pytest.mark.parametrize("late_ms", [0, 1, 19, 20, 21, 25, 100, 3000])
def test_ticks_may_come_late(late_ms: int) -> None:
    """A program's own clock catches up with a delay of up to 20 ms, and not with more."""
    for image, kit, senses in some_programs():
        assert host().run_late(image, kit, senses, late_ms) == run_late(image, kit, senses, late_ms)


@needs_host
def test_a_robot_that_is_not_ready_is_asked_again() -> None:
    """The trace is the same; only the tries are more."""
    tries = 0
    for image, kit, senses in some_programs():
        ready = host().run(image, kit, senses)
        if not ready.trace.endswith(" LIMIT\n") or ready.steps < senses.max_steps:
            slow = host().run(image, kit, senses._replace(max_steps=20_000), not_ready=2)
            assert slow.trace == ready.trace
            tries += slow.steps - ready.steps
    assert tries > 500


# -- images -------------------------------------------------------------------------------------


def python_refusal(data: bytes, kit: int) -> int:
    try:
        unpack(data, kit)
    except ImageRefused as refused:
        return refused.number
    return 0


def random_images(seed: int, count: int) -> Iterator[bytes]:
    """Yield images with a change in them, the checksum mended in most of them."""
    rng = random.Random(seed)
    for _ in range(count):
        kit = rng.choice((0, 1, 0x1234))
        image = bytearray(
            pack(rng.choice(("SI", "SB", "PING")), kit, rng.randbytes(rng.randrange(9)))
        )
        for _ in range(rng.choice((0, 1, 1, 2))):
            image[rng.randrange(min(len(image), HEADER_BYTES))] = rng.choice((0, 1, 2, 3, 255))
        if rng.random() < 0.3:
            del image[rng.randrange(len(image) + 1) :]
        elif rng.random() < 0.2:
            image += rng.randbytes(rng.randrange(3))
        if rng.random() < 0.8 and len(image) >= HEADER_BYTES:
            image[10:14] = struct_pack("<I", zlib.crc32(image[:10] + image[14:]))
        yield bytes(image)


def compare_images(seed: int, count: int, machine: Process | None = None) -> None:
    """Assert that images are refused for the same reasons, and each for some image."""
    images = [*random_images(seed, count), b"", b"T", b"TS", b"S", b"TX"]
    theirs = (machine or host()).refusals(images, 0x1234)
    for image, reason in zip(images, theirs, strict=True):
        assert python_refusal(image, 0x1234) == reason, image.hex(" ")
    assert {*theirs} == {0, *(number for number, _ in REFUSALS.values())}


@needs_host
@pytest.mark.parametrize("seed", range(4))
def test_images(seed: int) -> None:
    compare_images(seed, 25_000)


@needs_host
def test_long_images() -> None:
    for length in (CODE_BYTES, 40_000, 65_535):
        head = b"TS\x01\x00\x00\x00\x00\x00" + struct_pack("<H", length)
        code = bytes(length)
        image = head + struct_pack("<I", zlib.crc32(head + code)) + code
        assert host().refusals([image, image[:-1], image + b"x"], 0) == [0, 2, 3]


# -- arithmetic ---------------------------------------------------------------------------------

OPERATIONS: dict[str, Callable[[int, int], int]] = {
    "ADD": thousandths.add,
    "SUB": thousandths.subtract,
    "MUL": thousandths.multiply,
    "DIV": thousandths.divide,
    "MOD": thousandths.modulo,
    "NEG": lambda a, b: thousandths.negate(a),
    "ABS": lambda a, b: thousandths.absolute(a),
    "ROUND": thousandths.round_to,
    "MIN": min,
    "MAX": max,
    "AND": operator.and_,
    "OR": operator.or_,
    "NOT": lambda a, b: int(not a),
    **{name: getattr(operator, name.lower()) for name, _ in COMPARATORS},
    "RANDOM": lambda a, b: thousandths.random_between(a, b, b % 2**32),
    "END": lambda a, b: thousandths.whole(a),  # of no use here: stands for `whole`
}
NUMBER_OF = {name: number for number, name, _ in FAULTS}
_NEAR = (0, 1, 2, 3, 5, 499, 500, 501, 999, 1000, 1001, 1499, 1500, 1501, 2500, 46_340, 46_341,
         65_535, 65_536, 1_465_431, 1_465_432, 2_147_483, 2_147_484, 10**6, 10**7, 5 * 10**7,
         10**8, 10**9, 2**30, 2**31 - 1001, 2**31 - 1000, 2**31 - 501, 2**31 - 500, 2**31 - 499,
         2**31 - 2, 2**31 - 1)  # fmt: skip
EDGES = sorted({*_NEAR, *(-each for each in _NEAR), -(2**31)})


def python_result(name: str, a: int, b: int) -> tuple[int, int]:
    try:
        return 0, OPERATIONS[name](a, b)
    except thousandths.Fault as fault:
        return NUMBER_OF[fault.name], 0


def compare_arithmetic(name: str, count: int, machine: Process | None = None) -> None:
    """Compare all pairs of edges, and any others until there are `count`."""
    rng = random.Random(name)
    pairs = list(product(EDGES, EDGES))
    pairs += [(any_number(rng), any_number(rng)) for _ in range(count - len(pairs))]
    code = BY_NAME[name].code
    theirs = (machine or host()).results((code, a, b) for a, b in pairs)
    for (a, b), result in zip(pairs, theirs, strict=True):
        assert python_result(name, a, b) == result, f"{name} {a} {b}"


def any_number(rng: random.Random) -> int:
    """Return a number of any size: as many small ones as large ones, and edges."""
    if rng.random() < 0.1:
        return rng.choice(EDGES)
    return rng.randrange(-(2**31), 2**31) >> rng.randrange(32)


@needs_host
@pytest.mark.parametrize("name", OPERATIONS)
def test_arithmetic(name: str) -> None:
    """Two million operations in all."""
    compare_arithmetic(name, 100_000)


# -- a campaign ---------------------------------------------------------------------------------


def campaign(count: int) -> None:
    begun = time.monotonic()
    total: Counter[str] = Counter()
    done = 0
    for seed in range(BATCHES, BATCHES + -(-count // BATCH)):
        total += check_codes(seed, BATCH)
        done += BATCH
        print(f"{done} codes agree, {done / (time.monotonic() - begun):.0f} a second", flush=True)
    print(", ".join(f"{what}: {times}" for what, times in sorted(total.items())))


def all_of_three() -> None:
    for first in range(256):
        print(f"{first:02x}: {compare_three(first)} accepted", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", nargs="?", type=int, default=1_000_000)
    parser.add_argument("--three", action="store_true", help="all codes of three bytes instead")
    options = parser.parse_args()
    all_of_three() if options.three else campaign(options.count)
