"""Plain code, as a robot that reads text emits it: it behaves like optimised code."""

from __future__ import annotations

import random
import re

import pytest

from tests.machines import Senses
from tests.machines.python import run_python
from tests.oracle import programs
from tests.support.case_runs import compile_case, robot_and_senses
from tests.support.casefile import ROOT
from tests.support.images import image_for
from tests.support.kits import KITS
from tests.support.number_codes import NUMBER_CODES
from tests.support.random_programs import MAX_MS, MAX_STEPS
from tests.support.rows import each_row
from tests.support.vm_agreement import are_equivalent
from tests.support.vm_cases import CASES, having
from tiniscript import Compilation, compile_text, robots
from tiniscript.base.kit import Kit
from tiniscript.bytecode.disassembly import disassemble
from tiniscript.bytecode.opcodes import BY_NAME, OPS
from tiniscript.bytecode.verify import verify
from tiniscript.codegen.text.line import PlainCode, plain_code
from tiniscript.robots.text_levels import CODE_BYTES
from tiniscript.semantics.task_copies import copy_defs_per_task

TINIBOT, GRABBER = robots.load("tinibot").kit, robots.load("grabber").kit
# Syntax for the optimizing compiler only, absent from `docs/develop/text.md`.
FUSED_OPCODE = re.compile(
    r"PUSH_READ|(SET_VAR|ADD_VAR|WAIT|BEEP|MOTORS|LOOP|UNTIL|IF|IF_VAR)(8|16)|MOVE8|IF_NOT|INC_|DEC_"
    r"|ADD_VAR|AND$|OR$|END$|\w+_FAR$"
)
PLAIN_OPCODES = {op.name for op in OPS if not FUSED_OPCODE.match(op.name)}
PROGRAM_COUNT = 4 * 500  # random programs


def plain_of(text: str, kit: Kit = TINIBOT) -> PlainCode:
    compilation = compile_text(text, kit)
    assert compilation.is_right and compilation.program is not None, text
    return plain_code(compilation.program)


def names(text: str, kit: Kit = TINIBOT) -> str:
    """Return the instructions of the plain code, without offsets and operands."""
    rows = disassemble(plain_of(text, kit).code).splitlines()
    return " ".join(row[25:].split()[0] for row in rows)


@each_row(
    "text, says",
    [
        # Code that the optimizer would fold, fuse or drop.
        ("X = 2 + 3; SHOW(X)", "PUSH_NUM_2 PUSH_NUM_3 ADD SET_VAR_0 PUSH_VAR_0 SHOW"),
        ("X = 1; X = X + 1", "PUSH_NUM_1 SET_VAR_0 PUSH_VAR_0 PUSH_NUM_1 ADD SET_VAR_0"),
        ("F(2, 80)", "PUSH_NUM_2 PUSH_NUM_80 MOVE_F"),
        ("W(1)", "PUSH_NUM_1 WAIT"),
        ("M(50, -50)", "PUSH_NUM_50 PUSH16 MOTORS"),
        ("BEEP(1, 440)", "PUSH_NUM_1 PUSH16 BEEP"),
        ("SHOW(DISTANCE)", "READ_2 PUSH_SENSOR_2 SHOW"),
        ("DISTANCE; SHOW(DISTANCE)", "READ_2 PUSH_SENSOR_2 SHOW"),
        ("LOOP(3); S; END_LOOP", "PUSH_NUM_3 LOOP STOP NEXT"),
        ("LOOP(0); S; END_LOOP", "PUSH_NUM_0 LOOP STOP NEXT"),
        ("LOOP(FOREVER); BREAK; S; END_LOOP; S", "FOREVER BREAK STOP AGAIN STOP"),
        ("LOOP(2); BREAK; END_LOOP", "PUSH_NUM_2 LOOP BREAK_LOOP NEXT"),
        ("WHILE(FALSE); S; END_WHILE", "WHILE PUSH_FALSE IF STOP AGAIN"),
        ("IF(TRUE); S; ENDIF", "PUSH_TRUE IF STOP"),
        ("IF(TRUE); ENDIF", "PUSH_TRUE IF"),
        ("IF(TRUE); ELSE; ENDIF", "PUSH_TRUE IF ELSE"),
        ("IF(TRUE); ELSEIF(FALSE); ENDIF", "PUSH_TRUE IF ELSE PUSH_FALSE IF"),
        ("IF(TRUE); ELSEIF(FALSE); ELSE; ENDIF", "PUSH_TRUE IF ELSE PUSH_FALSE IF ELSE"),
        ("LOOP(FOREVER); IF(TRUE); BREAK; ELSE; S; ENDIF; END_LOOP",
         "FOREVER PUSH_TRUE IF BREAK ELSE STOP AGAIN"),
        ("SHOW(NOT TRUE AND FALSE)", "PUSH_TRUE NOT AND_THEN PUSH_FALSE SHOW_YES_NO"),
        ("IF(TIME < 1 OR TIME > 2); ENDIF", "TIME PUSH_NUM_1 LT OR_ELSE TIME PUSH_NUM_2 GT IF"),
        ("F(1, 50) UNTIL(TIME > 1)", "PUSH_NUM_1 PUSH_NUM_50 WATCH_F TIME PUSH_NUM_1 GT UNTIL"),
        ("W(FOREVER) UNTIL(TRUE)", "WATCH_FOREVER_WAIT PUSH_TRUE UNTIL"),
        ("L(FOREVER, 9) UNTIL(TRUE)", "PUSH_NUM_9 WATCH_FOREVER_L PUSH_TRUE UNTIL"),
        # readings: in front of the instruction, and those of UNTIL after WATCH
        (
            "F(DISTANCE, LIGHT_L) UNTIL(DISTANCE < 5)",
            "READ_2 READ_1 PUSH_SENSOR_2 PUSH_SENSOR_1 WATCH_F"
            " READ_2 PUSH_SENSOR_2 PUSH_NUM_5 LT UNTIL",
        ),
        ("WHILE(DISTANCE < 5); END_WHILE", "WHILE READ_2 PUSH_SENSOR_2 PUSH_NUM_5 LT IF AGAIN"),
        (
            "IF(DISTANCE < 5); ELSEIF(DISTANCE < LIGHT_L); ENDIF",
            "READ_2 PUSH_SENSOR_2 PUSH_NUM_5 LT IF ELSE READ_1 PUSH_SENSOR_2 PUSH_SENSOR_1 LT IF",
        ),
        # Moves by distance, tasks in their place, and an endless FOREVER.
        ("F(20 CM, 60)", "PUSH_NUM_20 PUSH_NUM_60 GO_F"),
        ("r(90°, 60) UNTIL(TRUE)", "PUSH_NUM_90 PUSH_NUM_60 WATCH_GO_R PUSH_TRUE UNTIL"),
        ("TASK; S; END_TASK; S; TASK; ENDTASK", "TASK STOP END_TASK STOP TASK END_TASK"),
        (
            "DISTANCE; WHEN(DISTANCE < 9); SHOW(DISTANCE); ENDWHEN; SHOW(DISTANCE)",
            "READ_2 WHEN READ_2 PUSH_SENSOR_2 PUSH_NUM_9 LT LOOK READ_2 PUSH_SENSOR_2 SHOW END_WHEN"
            " PUSH_SENSOR_2 SHOW",
        ),
        ("F(FOREVER, 9); W(FOREVER); TASK; END_TASK",
         "PUSH_NUM_9 WATCH_FOREVER_F PUSH_FALSE UNTIL WATCH_FOREVER_WAIT PUSH_FALSE UNTIL"
         " TASK END_TASK"),
        # DEFs in their place, called or not.
        ("S; DEF A; END_DEF; S", "STOP DEF RETURN STOP"),
        ("S; DEF A; S; END_DEF; A; DEF C; END_DEF", "STOP DEF STOP RETURN CALL DEF RETURN"),
        # the minus of a number, and others
        ("X = - 5; X = 3 - 5; X = --5; X = -(5)",
         "PUSH_TENTHS SET_VAR_0 PUSH_NUM_3 PUSH_NUM_5 SUB SET_VAR_0 PUSH_TENTHS NEG SET_VAR_0"
         " PUSH_NUM_5 NEG SET_VAR_0"),
        # An empty program.
        ("START", ""), ("", ""), ("PING|CHECK_CONNECTION", ""),
    ],
)  # fmt: skip
def test_each_word_is_its_own_instruction(text: str, says: str) -> None:
    assert names(text) == says


@each_row("number, code", NUMBER_CODES)
def test_a_number_uses_the_first_suitable_push(number: str, code: str) -> None:
    """This also holds in optimized code."""
    assert plain_of(f"SHOW({number})").code.hex(" ") == f"{code} 39"
    assert compile_text(f"SHOW({number})", TINIBOT).code.hex(" ") == f"{code} 39"


def test_operands_to_7_are_part_of_the_code() -> None:
    code = plain_of("; ".join(f"V{k} = 0" for k in range(9))).code
    assert code == b"".join(bytes((0xB0, 0xA0 + k)) for k in range(8)) + b"\xb0\x30\x08"


def test_variables_have_their_numbers_in_the_order_of_the_text() -> None:
    text = "IF(FALSE); C = 1; ENDIF; DEF D; A = 2; END_DEF; E = 3; SHOW(A); SHOW(C)"
    last_rows = disassemble(plain_of(text).code).splitlines()[-6:]
    assert [row[25:] for row in last_rows] == [
        "PUSH_NUM_3", "SET_VAR_2", "PUSH_VAR_1", "SHOW", "PUSH_VAR_0", "SHOW"
    ]  # fmt: skip


def test_the_length_is_that_with_short_jumps() -> None:
    """A robot refuses code with a far jump; `tsc` says how much too long it is with short ones."""
    text = "IF(TRUE); " + "S; " * 300 + "ENDIF"
    code = plain_of(text)
    assert BY_NAME["IF_FAR"].code == code.code[1] and len(code.code) == 304
    assert code.short_length == 303
    assert [place.offset for place in code.locations[:3]] == [0, 3, 4]


def test_code_that_fits_a_level_has_no_far_jumps() -> None:
    code = plain_of("IF(TRUE); " + "S; " * (CODE_BYTES - 3) + "ENDIF")
    assert len(code.code) == code.short_length == CODE_BYTES
    assert "FAR" not in disassemble(code.code)


def test_the_page_names_every_instruction_of_plain_code_and_no_other() -> None:
    """`MOVE_B`, `PUSH_NUM_5` and the like are under the first of their kind."""
    page = (ROOT / "docs" / "develop" / "text.md").read_text(encoding="utf-8")
    page = page[page.index("## Plain code") : page.index("## A program, byte")]
    names = {word for part in re.findall(r"`([^`]+)`", page) for word in part.split()}
    for name in PLAIN_OPCODES:
        kind = re.sub(r"_\d+$", "", name)
        kind = {"PUSH_NUM": "PUSH_NUM_n"}.get(kind, kind)
        kind = re.sub(r"(MOVE|GO|WATCH|WATCH_GO|WATCH_FOREVER)_[BLR]$", r"\1_F", kind)
        assert kind in names, name
    known_names = {op.name for op in OPS}
    assert names & known_names <= PLAIN_OPCODES | {"AND", "OR"}  # words of the language as well


def check_same(compilation: Compilation, kit: Kit, senses: Senses) -> None:
    """The plain code of a program passes the verifier and behaves like its other code."""
    assert compilation.program is not None
    code = plain_code(compilation.program)
    verify(code.code, len(kit.readings), len(kit.actuators))
    is_short = "_FAR" not in disassemble(code.code)
    assert (code.short_length == len(code.code)) == is_short
    if is_short:
        used = {row[25:].split()[0] for row in disassemble(code.code).splitlines()}
        assert not [name for name in used if FUSED_OPCODE.match(name)], used
    trace = run_python(image_for(code.code, kit, compilation.program.start), kit, senses)
    assert are_equivalent(run_python(compilation.image, kit, senses), trace), (
        compilation.source.text
    )


@pytest.mark.sampled("first")
@pytest.mark.parametrize("first", range(0, PROGRAM_COUNT, 500))
def test_random_programs_do_the_same_in_plain_code(first: int) -> None:
    for seed in range(first, first + 500):
        rng = random.Random(seed)
        oracle_kit, kit = KITS[seed % len(KITS)]
        compilation = compile_text(programs.program(rng, oracle_kit), kit)
        readings = programs.senses(rng, oracle_kit)
        check_same(compilation, kit, Senses(readings, MAX_MS, MAX_STEPS, seed + 1))


def test_programs_of_all_documents_do_the_same_in_plain_code() -> None:
    run = [case for case in CASES if {"tiniscript", "robot"} <= set(case.parts)]
    assert len(run) > 80 and len(run) == len(having("tiniscript", "robot"))
    for case in run:
        robot, senses = robot_and_senses(case)
        compilation = compile_case(case)
        assert compilation.program is not None
        if (
            copy_defs_per_task(compilation.program) == compilation.program
        ):  # no robot that reads text has copies of DEFs
            check_same(compilation, robot.kit, senses)
