"""A word with an instruction of its own is a row of few tables: every stage takes it from there.

CONTRIBUTING.md names the files of these tables, and three that no test can replace: the code of the
C++ machine, the language reference and the block's text.
"""

from __future__ import annotations

import inspect
import shutil
import subprocess
from pathlib import Path
from struct import Struct
from types import ModuleType

import pytest

from tests.machines import avr
from tests.machines.host import SOURCES, WARNINGS
from tests.oracle import text as oracle_text
from tests.oracle import words as oracle
from tests.oracle.interpreter import run as run_by_reference
from tests.support.casefile import ROOT
from tests.support.needs import need
from tests.support.new_word import CHEEP
from tiniscript import compile_text, robots
from tiniscript.base import words
from tiniscript.base.fixed_point import clamp, round_to_whole
from tiniscript.bytecode import opcodes
from tiniscript.bytecode.disassembly import disassemble
from tiniscript.codegen.sketch import helpers
from tiniscript.codegen.sketch.writing import sketch_of
from tiniscript.vm import actions
from tiniscript.vm.handlers import HANDLERS, Step
from tiniscript.vm.runner import run
from tiniscript.vm.state import Drive
from tools.generate import avr_header, cpp_header

ROBOT = robots.load("tinibot")
PROGRAM = "SI|T = 1;CHEEP(0.25, 440);CHEEP(T - 2, T + 30000);M(50, 50);W(0.5)"
NEXT_MINOR = opcodes.ISA_MINOR + 1
OP = opcodes._op(0x5F, "CHEEP", "", "time hertz --", "plain", "Sound the buzzer and go on.")


def cheep(machine: Drive, next_pc: int) -> Step:
    def step() -> int:
        hertz, time_milli = machine.task.stack.pop(), machine.task.stack.pop()
        machine.robot.beep(clamp(round_to_whole(hertz), 31, 20_000), max(0, time_milli))
        return next_pc

    return step


@pytest.fixture
def tables(monkeypatch: pytest.MonkeyPatch) -> list[ModuleType]:
    """Add CHEEP to each of the tables; return the modules that have them."""
    op = OP._replace(since=NEXT_MINOR)
    assert opcodes.BY_CODE[op.code] is None
    by_code = [op if code == op.code else other for code, other in enumerate(opcodes.BY_CODE)]
    act = oracle.ACTS["BEEP"]._replace(waits=False)
    monkeypatch.setitem(words.WORDS, CHEEP.text, CHEEP)
    monkeypatch.setattr(opcodes, "BY_CODE", by_code)
    monkeypatch.setattr(opcodes, "OPS", (*opcodes.OPS, op))
    monkeypatch.setattr(opcodes, "UNO_OPS", (*opcodes.UNO_OPS, op))
    monkeypatch.setitem(opcodes.BY_NAME, op.name, op)
    monkeypatch.setitem(opcodes._LAYOUTS, op.code, Struct("<"))
    monkeypatch.setitem(HANDLERS, op.name, cheep)
    monkeypatch.setitem(
        helpers.HELPERS, "cheep", helpers.HELPERS["beep"].replace("$beep", "$cheep")
    )
    monkeypatch.setitem(oracle.ACTS, CHEEP.text, act)
    monkeypatch.setitem(oracle.RANGES, CHEEP.text, act.ranges)
    monkeypatch.setattr(oracle_text, "RESERVED", oracle.RESERVED | {CHEEP.text})
    return [words, opcodes, helpers, actions, oracle]


def sketch(text: str) -> str:
    compilation = compile_text(text, ROBOT.kit)
    assert compilation.program is not None
    return sketch_of(compilation.source, compilation.program, ROBOT, "en")


def test_a_word_needs_few_tables(tables: list[ModuleType]) -> None:
    compilation = compile_text(PROGRAM, ROBOT.kit)
    assert not compilation.diagnostics and compilation.program is not None
    assert "CHEEP" in disassemble(compilation.code)
    assert compilation.image[2:4] == bytes([opcodes.ISA_MAJOR, NEXT_MINOR])
    *events, _ = map(str, run(compilation.code, ROBOT.kit, lambda _: 0))
    assert events[:3] == ["0 BEEP 440 250", "0 BEEP 20000 0", "0 MOTORS 50 50"]
    assert events == run_by_reference(PROGRAM).splitlines()
    assert "cheep(0.25, 440);" in sketch(PROGRAM) and "limited(" in sketch(PROGRAM)
    assert "struct Number" in sketch("CHEEP(DISTANCE, 440)")  # otherwise the value would be rounded
    assert "struct Number" not in sketch("CHEEP(0.5, 440)")


def test_the_tables_of_the_machine_in_c_have_its_instruction(
    tables: list[ModuleType], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its action is a `case` of `Machine::act`, without which a compiler warns."""
    acts = tuple(op for op in opcodes.UNO_OPS if op.is_act)
    monkeypatch.setattr(cpp_header, "ACTS", acts)
    families = dict.fromkeys(op.family for op in acts)
    monkeypatch.setattr(cpp_header, "ASKED_FAMILIES", (*families, *cpp_header.ASKED_FAMILIES))
    header = cpp_header.header("a test")
    assert "  kCheep = 0x5f,  // time hertz --\n" in header  # an Op
    assert "case Op::kCheep" in header and f"code == 0x5f ? {NEXT_MINOR}" in header
    assert header.count("  kCheep = ") == len(("Op", "Family"))
    assert "\nop_cheep:\n" in avr_header.header("a test")


def test_a_machine_with_its_instruction_compiles_for_a_chip(
    tables: list[ModuleType], tmp_path: Path
) -> None:
    """`image.cpp` uses the table of versions. The GCC of an AVR is the strictest compiler."""
    need(avr.missing())
    shutil.copytree(SOURCES / "src" / "vm", tmp_path, dirs_exist_ok=True)
    (tmp_path / "bytecode.h").write_text(cpp_header.header("a test"), encoding="utf-8")
    flags = ("-mmcu=atmega328p", *avr.FLAGS, *WARNINGS, "-fsyntax-only")
    subprocess.run(["avr-g++", *flags, tmp_path / "image.cpp"], check=True)


def test_contributing_names_their_files(tables: list[ModuleType]) -> None:
    row = next(
        line
        for line in (ROOT / "CONTRIBUTING.md").read_text("utf-8").splitlines()
        if line.startswith("| a **word** of the language ")
    )
    package = ROOT / "compiler" / "tiniscript"
    for module in tables:
        path = Path(inspect.getfile(module)).resolve()
        inside = path.is_relative_to(package)
        assert f"`{path.relative_to(package if inside else ROOT).as_posix()}`" in row
