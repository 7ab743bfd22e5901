"""The table is right: every stack effect is that of the machine."""

from __future__ import annotations

import re

import pytest

from tests.support.casefile import ROOT
from tiniscript import compile_text, robots
from tiniscript.base.limits import VARIABLES
from tiniscript.base.words import COMPARATORS
from tiniscript.bytecode import opcodes
from tiniscript.bytecode.disassembly import assemble, disassemble, rows
from tiniscript.bytecode.image import unpack
from tiniscript.bytecode.opcodes import (
    BY_NAME,
    ESCAPE,
    ESCAPED_OPS,
    ISA_MAJOR,
    ISA_MINOR,
    NEEDS_GO,
    NEEDS_TASKS,
    OPS,
    PUSHED_NUMBERS,
    SHORTS,
    Op,
    op_at,
    read_operands,
    time8,
    time8_ms,
)
from tiniscript.bytecode.verify import RULES
from tiniscript.vm.machine import Machine
from tiniscript.vm.tasks import TaskMachine
from tools.generate import cpp_header

SLOW = robots.load("tinibot").kit._replace(speed=1, turn=1)


# The codes of each minor version that has been released: another one needs a later `since_minor`.
RELEASED = {
    0: "00-0c 10-19 20-28 2a-2d 30-35 38-3b 40-54 56 58-5b 60-65 68-75 78-7c 80-c3"
    " c8-cd d0-d5 d8-dd e0-e5 e8-ed f0-f5",
    1: "55 76-77 7d-7e ff40-ff43 ff48-ff4b",
}


class Nothing:
    """A robot that is always ready and does nothing."""

    def motors(self, left: int, right: int) -> None: ...
    def off(self) -> None: ...
    def read(self, sensor: int) -> int | None:
        return 1

    def go_ms(self, extent: int, power: int, is_turn: bool) -> int:
        return SLOW.go_ms(extent, power, is_turn)

    def beep(self, hertz: int, duration_ms: int) -> None: ...
    def show(self, value: int, is_yes_no: bool) -> bool:
        return True

    def set(self, actuator: int, value: int) -> None: ...


def code_with(op: Op, value: int) -> bytes:
    """Return code that pushes the arguments of `op`, and runs it with its smallest operands."""
    pushes = bytes([BY_NAME["PUSH_TRUE" if value else "PUSH_FALSE"].code]) * op.pops
    operands = b"".join(
        max(operand.kind.low, 0).to_bytes(operand.kind.size, "little") for operand in op.operands
    )
    return pushes + op.opcode + operands


def machine_for(op: Op, code: bytes) -> Machine:
    """Return a machine that has the instruction `op`: those of tasks have a scheduler."""
    return (TaskMachine if op.needs == NEEDS_TASKS else Machine)(
        code, Nothing(), sensor_count=SHORTS
    )


def effect_of(op: Op, value: int) -> tuple[int, str]:
    """Push an instruction's arguments and run it; return the number of values that it leaves, and
    its fault."""
    code = code_with(op, value)
    machine = machine_for(op, code)
    task = machine.task
    if op.control_role == "next" or op.control_role == "drop":
        task.counters.append(2)
    if op.control_role == "return":
        task.calls.append(0)
    machine.tick(0, op.pops + 1)
    return len(task.stack), machine.fault


def test_stack_effects_are_those_of_the_table() -> None:
    for op in OPS:
        for value in (0, 1):
            results = op.pushes
            if op.control_role == "join":  # the deciding comparison stays
                results += value == ("OR" in op.name)
            divides = op.name in ("DIV", "MOD") and value == 0
            expected = (1, "DIVIDE_BY_ZERO") if divides else (results, "")
            if op.needs == NEEDS_GO and value:  # a way, and a power that rounds to 0
                expected = (0, "NO_POWER")
            assert effect_of(op, value) == expected, (op.name, value)


EDGES = (-(2**31), 1 - 2**31, -1001, -1, 0, 1, 500, 1000, 2**31 - 1)


def faults_of(op: Op) -> set[str]:
    """Return the faults of an instruction on all pairs of values at the edges of their range."""
    code = op.opcode + b"".join(
        (1).to_bytes(operand.kind.size, "little") for operand in op.operands
    )
    fault_names = set()
    for first_name in EDGES:
        for second in EDGES:
            machine = machine_for(op, code)
            task = machine.task
            task.stack[:] = [first_name, second][: op.pops]
            task.variables[:] = [first_name] * VARIABLES
            task.counters[:], task.calls[:] = [2], [0]
            machine.tick(2**31, 1)
            fault_names.add(machine.fault)
    return fault_names - {""}


def test_the_instructions_that_can_fault_are_those_that_the_table_names() -> None:
    for op in OPS:
        fault_names = {fault for fault, names in opcodes.FAULTING_OPS.items() if op.name in names}
        # Faults of robots that measure their wheels.
        fault_names -= {"STUCK", "STUCK_LEFT", "STUCK_RIGHT"}
        assert faults_of(op) == fault_names, op.name


def test_operands_are_where_the_table_says() -> None:
    for op in OPS:
        highest = tuple(operand.kind.high for operand in op.operands)
        lowest = tuple(operand.kind.low for operand in op.operands)
        for values in (highest, lowest):
            data = op.opcode + b"".join(
                value.to_bytes(operand.kind.size, "little", signed=operand.kind.is_signed)
                for operand, value in zip(op.operands, values, strict=True)
            )
            assert len(data) == op.size, op.name
            assert read_operands(op, data, 0) == values, op.name


def test_codes_and_numbers_are_used_once() -> None:
    assert len({op.code for op in OPS}) == len(OPS) == len({op.name for op in OPS})
    numbers = [number for number, _ in RULES.values()]
    assert len(set(numbers)) == len(numbers)
    assert {op.control_role for op in OPS} == set(opcodes.CONTROL_ROLES)


def test_an_instruction_of_one_byte_has_its_operand_in_its_last_bits() -> None:
    short_ops = [op for op in OPS if op.implied is not None]
    assert len(short_ops) == 6 * SHORTS
    for op in short_ops:
        assert op.implied is not None
        assert op.size == 1 and op.name == f"{op.family}_{op.code % SHORTS}"
        assert op.implied.value == op.code % SHORTS
        long_op = BY_NAME[op.family]
        assert [operand.kind for operand in long_op.operands] == [op.implied.kind]
        assert (long_op.effect, long_op.control_role) == (op.effect, op.control_role)


def test_the_last_bits_of_a_comparison_with_a_constant_are_the_comparator() -> None:
    for op in OPS:
        comparator = op.name.rpartition("_")[2]
        if comparator in dict(COMPARATORS):
            assert op.code % 8 == BY_NAME[comparator].code % 8


def test_the_escape_byte_begins_two_byte_opcodes() -> None:
    assert opcodes.BY_CODE[ESCAPE] is None
    for code, op in ESCAPED_OPS.items():
        assert op_at(bytes([0, ESCAPE, code]), 1) is op
        assert op.opcode == bytes([ESCAPE, code]) and op.size == 2 + sum(
            operand.kind.size for operand in op.operands
        )
    assert op_at(bytes([ESCAPE]), 0) is None
    assert op_at(bytes([ESCAPE, 0]), 0) is None


def test_a_way_has_the_code_of_a_time_after_the_escape() -> None:
    """Therefore a machine's decode tables serve both."""
    for code, op in ESCAPED_OPS.items():
        of_time = opcodes.BY_CODE[code]
        assert of_time is not None
        assert op.name == of_time.name.replace("MOVE_", "GO_").replace("WATCH_", "WATCH_GO_")
        assert (op.control_role, op.pops, op.pushes) == (
            of_time.control_role,
            of_time.pops,
            of_time.pushes,
        )


def test_numbers_of_one_byte_follow_one_another() -> None:
    codes = [BY_NAME[f"PUSH_NUM_{n}"].code for n in PUSHED_NUMBERS]
    assert codes == list(range(codes[0], codes[0] + len(PUSHED_NUMBERS)))


def test_each_time_byte_encodes_a_distinct_time() -> None:
    times = [time8_ms(byte) for byte in range(256)]
    assert times == sorted({*times})
    assert [times[byte] for byte in (0, 1, 99, 100, 101, 199, 200, 255)] == [
        0, 10, 990, 1000, 1100, 10_900, 11_000, 66_000]  # fmt: skip
    for byte, time_ms in enumerate(times):
        assert time8(time_ms) == byte
    assert [time8(time_ms) for time_ms in (-10, 5, 1010, 10_950, 11_500, 67_000)] == [None] * 6


def test_disassembly_of_every_instruction_reads_back() -> None:
    code = b"".join(op.opcode + bytes(op.size - len(op.opcode)) for op in OPS)
    assert assemble(disassemble(code)) == code
    assert [row.op for row in rows(code)] == list(OPS)


def test_disassembly_of_anything_reads_back() -> None:
    code = bytes(range(256)) + b"\x44"
    assert assemble(disassemble(code)) == code


def test_a_disassembly_names_the_devices_that_the_kit_has() -> None:
    kit = robots.load("tinibot").kit
    names = [sensor.name for sensor in kit.readings]
    code = unpack(compile_text("; ".join(f"SHOW({name})" for name in names), kit).image).code
    remarks = (line.partition(" ; ")[2] for line in disassemble(code, kit=kit).splitlines())
    assert [remark for remark in remarks if remark] == names
    assert ";" not in disassemble(code)


@pytest.mark.parametrize("text", ["0001  58", "0000  5", "zzzz  58", "0000 58", "nonsense"])
def test_anything_but_a_disassembly_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="no line of a disassembly"):
        assemble(text)


def test_an_instruction_that_comes_after_a_release_has_a_later_version() -> None:
    """Otherwise a machine that lacks it would accept an image that it cannot run."""
    for minor, ranges in RELEASED.items():
        codes: set[int] = set()
        for first_name, _, last_name in (part.partition("-") for part in ranges.split()):
            codes.update(range(int(first_name, 16), int(last_name or first_name, 16) + 1))
        newer_codes = {op.code for op in OPS if op.since_minor == minor}
        newer_names = [op.name for op in OPS if op.code in newer_codes - codes]
        assert not newer_names, (
            f"give {newer_names} since={max(RELEASED) + 1}: {minor} has been released"
        )
        assert newer_codes == codes, "a code is a promise"


def test_a_version_that_is_not_released_is_in_the_changelog() -> None:
    """After a release its codes are in RELEASED."""
    unreleased_text = (ROOT / "CHANGELOG.md").read_text("utf-8").partition("\n## ")[2]
    for minor in {op.since_minor for op in OPS} - {*RELEASED}:
        assert f"bytecode {ISA_MAJOR}.{minor}" in unreleased_text.partition("\n## ")[0], minor
    assert max(RELEASED) <= ISA_MINOR <= max(RELEASED) + 1


def test_a_robot_makes_the_version_of_the_same_instructions(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    later_ops = [op._replace(since_minor=9) if op.name == "BEEP" else op for op in OPS]
    monkeypatch.setattr(opcodes, "OPS", later_ops)
    code = BY_NAME["BEEP"].code
    assert re.search(
        rf"minor_of_op\(uint8_t code\) {{ return .*code == 0x{code:02x} \? 9 : .*0; }}",
        cpp_header.header("a test"),
    )
    escaped_ops = [op._replace(since_minor=9) if op.name == "MOVE_F" else op for op in OPS]
    monkeypatch.setattr(opcodes, "OPS", escaped_ops)
    with pytest.raises(AssertionError, match="after an escape"):
        cpp_header.header("a test")
