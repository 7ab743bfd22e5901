"""The table keeps its word: every stack picture is what the machine really does."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.casefile import ROOT, read
from tiniscript.bytecode import opcodes
from tiniscript.bytecode.disassembly import listing, read_listing, rows
from tiniscript.bytecode.opcodes import BY_NAME, OPS, Op, read_operands
from tiniscript.bytecode.verify import RULES
from tiniscript.vm.machine import Machine


class Nothing:
    """A robot that is always ready and does nothing."""

    def motors(self, left: int, right: int) -> None: ...
    def off(self) -> None: ...
    def read(self, sensor: int) -> int | None:
        return 1

    def beep(self, hertz: int, duration_ms: int) -> None: ...
    def show(self, value: int, is_yes_no: bool) -> bool:
        return True

    def set(self, actuator: int, value: int) -> None: ...


def code_with(op: Op, value: int) -> bytes:
    """Return code that pushes what `op` takes, and runs it with its smallest operands."""
    pushes = bytes([BY_NAME["PUSH8"].code, value]) * op.pops
    operands = b"".join(
        max(operand.kind.low, 0).to_bytes(operand.kind.size, "little") for operand in op.operands
    )
    return pushes + bytes([op.code]) + operands


@pytest.mark.parametrize("value", [0, 1], ids=["false", "true"])
@pytest.mark.parametrize("op", OPS, ids=lambda op: op.name)
def test_stack_picture(op: Op, value: int) -> None:
    """Push what it takes, run it, count what it leaves."""
    code = code_with(op, value)
    machine = Machine(code, Nothing(), sensors=1)
    task = machine.task
    if op.role == "next" or op.role == "drop":
        task.counters.append(2)
    if op.role == "return":
        task.calls.append(0)
    machine.tick(0, op.pops + 1)
    left = op.pushes
    if op.role == "join":  # what decides stays
        left += value == ("OR" in op.name)
    divides = op.name in ("DIV", "MOD") and value == 0
    assert len(task.stack) == (1 if divides else left)
    assert machine.fault == ("DIVIDE_BY_ZERO" if divides else "")


@pytest.mark.parametrize("op", OPS, ids=lambda op: op.name)
def test_operands_are_where_the_table_says(op: Op) -> None:
    highest = tuple(operand.kind.high for operand in op.operands)
    lowest = tuple(operand.kind.low for operand in op.operands)
    for values in (highest, lowest):
        data = bytes([op.code]) + b"".join(
            value.to_bytes(operand.kind.size, "little", signed=operand.kind.signed)
            for operand, value in zip(op.operands, values, strict=True)
        )
        assert len(data) == op.size
        assert read_operands(op, data, 0) == values


def test_codes_and_numbers_are_used_once() -> None:
    assert len({op.code for op in OPS}) == len(OPS) == len({op.name for op in OPS})
    numbers = [number for number, _ in RULES.values()]
    assert len(set(numbers)) == len(numbers)
    assert {op.role for op in OPS} == set(opcodes.ROLES)


def test_listing_of_every_instruction_reads_back() -> None:
    code = b"".join(bytes([op.code]) + bytes(op.size - 1) for op in OPS)
    assert read_listing(listing(code)) == code
    assert [row.op for row in rows(code)] == list(OPS)


def test_listing_of_anything_reads_back() -> None:
    code = bytes(range(256)) + b"\x44"
    assert read_listing(listing(code)) == code


@pytest.mark.parametrize("text", ["0001  58", "0000  5", "zzzz  58", "0000 58", "nonsense"])
def test_what_is_no_listing_is_no_listing(text: str) -> None:
    with pytest.raises(ValueError, match="no line of a listing"):
        read_listing(text)


def test_generated_files_are_fresh() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "tools.generate", "--check"],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr


def test_generated_check_notices(tmp_path: Path) -> None:
    """The check can fail: a changed byte in a copy of the repo is named."""
    from shutil import copytree, ignore_patterns

    skipped = ignore_patterns(".git", ".venv", "*.pyc", "build", "*.egg-info")
    copy = copytree(ROOT, tmp_path / "copy", ignore=skipped)
    spec = copy / "bytecode_spec.md"
    spec.write_text(
        spec.read_text(encoding="utf-8").replace("`MOVE8_F ", "`MOVE9_F "), encoding="utf-8"
    )
    done = subprocess.run(
        [sys.executable, "-m", "tools.generate", "--check"],
        cwd=copy,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 1
    assert "bytecode_spec.md" in done.stderr


def test_spec_has_cases() -> None:
    assert len(read(ROOT / "bytecode_spec.md")) >= 2
