"""The verifier: every rule has a disassembly that breaks it, and what it accepts runs safely."""

from __future__ import annotations

import random
from itertools import product

import pytest

from tests.bytecode.test_opcodes import Nothing
from tests.oracle.programs import program
from tests.support.casefile import ROOT, read
from tests.support.kits import KITS
from tiniscript import compile_text
from tiniscript.base.kit import DEVICES
from tiniscript.base.limits import CODE_BYTES, STACK_VALUES
from tiniscript.bytecode.opcodes import OPS
from tiniscript.bytecode.verify import RULES, Refused, verify
from tiniscript.vm.machine import Machine

SENSORS, ACTUATORS = 3, 2


def refusal(code: bytes) -> str:
    try:
        verify(code, SENSORS, ACTUATORS)
    except Refused as refused:
        assert 0 <= refused.offset <= len(code)
        return refused.name
    return ""


def test_every_rule_has_a_case() -> None:
    said = {
        case.parts["refused"].split()[1]
        for name in ("refused.md", "tasks.md")
        for case in read(ROOT / "tests/cases" / name)
        if "refused" in case.parts
    }
    assert said | {"CODE_LENGTH"} == set(RULES)


def test_code_may_be_as_long_as_the_limit() -> None:
    stop = bytes([next(op.code for op in OPS if op.name == "STOP")])
    assert refusal(stop * CODE_BYTES) == ""
    assert refusal(stop * (CODE_BYTES + 1)) == "CODE_LENGTH"


def test_a_way_that_is_cut_behind_its_first_byte() -> None:
    assert refusal(bytes.fromhex("bcbfff")) == "CUT_OPERAND"
    assert refusal(bytes.fromhex("bcbfff40")) == ""
    with pytest.raises(Refused, match="UNKNOWN_OPCODE"):
        verify(bytes.fromhex("bcbfff"), SENSORS, ACTUATORS, needs=0)


def runs_safely(code: bytes, seed: int) -> None:
    """Run accepted code; no list of the machine may be left, and nothing may grow too large."""
    machine = Machine(code, Nothing(), SENSORS, seed)
    now_ms = 0
    for _ in range(60):
        machine.tick(now_ms, 5)
        task = machine.task
        assert len(task.stack) <= STACK_VALUES
        assert len(task.counters) <= 16
        assert len(task.calls) <= 8
        assert 0 <= task.pc <= len(code)
        if machine.status in ("done", "fault"):
            break
        now_ms = max(now_ms, task.wake_ms)


@pytest.mark.sampled("part", keep=2)
@pytest.mark.parametrize("part", range(10))
def test_random_and_mutated_code(part: int) -> None:
    """Whatever the bytes: a verdict; and what is accepted runs. Half of it nearly right code."""
    rng = random.Random(part)
    accepted = 0
    codes = [each for op in OPS for each in op.opcode]
    for number in range(3000):
        kind = number % 3
        if kind == 0:
            code = bytearray(rng.choices(codes + list(range(9)), k=rng.randrange(12)))
        else:
            oracle_kit, kit = KITS[number % 2]
            code = bytearray(compile_text(program(rng, oracle_kit), kit).code)
            for _ in range(rng.randrange(3)):
                if code:
                    at = rng.randrange(len(code))
                    if rng.random() < 0.3:
                        del code[at]
                    else:
                        code[at] = rng.choice((rng.randrange(256), rng.choice(codes)))
        if refusal(bytes(code)) == "":
            accepted += 1
            runs_safely(bytes(code), number + 1)
    assert accepted > 300


def test_all_code_of_up_to_two_bytes_and_three_around_each_opcode() -> None:
    accepted = 0
    every = range(256)
    few = (0, 1, 2, 3, 127, 128, 255)
    opcodes = [op.opcode[-1] for op in OPS]
    for code in (
        *(bytes(each) for each in product(every, repeat=1)),
        *(bytes(each) for each in product(every, repeat=2)),
        *(bytes(each) for each in product(opcodes, few, opcodes)),
        *(bytes(each) for each in product(opcodes, opcodes, few)),
    ):
        if refusal(code) == "":
            accepted += 1
            runs_safely(code, 1)
    assert accepted > 1000


@pytest.mark.parametrize("sensors", [0, 1, 32])
def test_devices_are_counted(sensors: int) -> None:
    read_op = next(op.code for op in OPS if op.name == "READ")
    for index in range(33):
        code = bytes([read_op, index])
        if index < sensors:
            assert verify(code, sensors, 0).uses == (("sensor", index),)
        else:
            rule = "NO_SUCH_DEVICE" if index < DEVICES else "BAD_OPERAND"
            with pytest.raises(Refused, match=rule):
                verify(code, sensors, 0)


def test_verdict_says_what_code_needs() -> None:
    _oracle_kit, kit = KITS[0]
    text = """
        DEF IN; LOOP(2); LOOP(3); SHOW(1 + TIME * 2); END_LOOP; END_LOOP; END_DEF
        DEF OUT; IN; END_DEF
        LOOP(4); OUT; END_LOOP
    """
    verdict = compile_text(text, kit).verdict
    assert verdict == (3, 3, 2, (), 0, 0)
