"""A program as one line for a robot: shorter, and the same program."""

from __future__ import annotations

import random

import pytest

from tests.oracle import programs
from tests.support.case_runs import compile_case, robot_and_senses
from tests.support.kits import KITS
from tests.support.text_lines import check_line
from tests.support.vm_cases import CASES
from tiniscript.base.source import Source
from tiniscript.codegen.text.line import line_of
from tiniscript.syntax.checksums import with_checksum


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("", "SI|"),
        (" // nothing\n;;\n", "SI|"),
        ("si | f( 2 , 80 ) ; s", "SI|F(2,80);S"),
        ("SB|\n\n  F(1,\n 80) // go\n;;\n S;\n", "SB|F(1,80);S"),
        ("LOOP(2)\nS\nENDLOOP\nIF(TRUE)\nELSE\nEND_IF", "LOOP(2);S;END_LOOP;IF(TRUE);ELSE;ENDIF"),
        ("x = not (1 < 2) and 3 > - 4", "X=NOT(1<2)AND 3>-4"),
        ("X = 3 - - 5 % .5", "X=3--5%.5"),
        ("F(1, 50) UNTIL(TIME > 3)", "F(1,50)UNTIL(TIME>3)"),
        ("DEF A; END_DEF\nA", "DEF A;END_DEF;A"),
        ("PING |\n check_connection ;", "PING|CHECK_CONNECTION"),
        ("START\nM(\u2013 5,\u00a06)", "START;M(-5,6)"),
    ],
)
def test_a_text_is_reduced_to_a_line(text: str, line: str) -> None:
    assert line_of(Source(text)) == with_checksum(line)


@pytest.mark.sampled("first")
@pytest.mark.parametrize("first", range(0, 2000, 500))
def test_the_line_of_a_random_program_is_the_same_program(first: int) -> None:
    for seed in range(first, first + 500):
        oracle_kit, kit = KITS[seed % len(KITS)]
        check_line(programs.program(random.Random(seed), oracle_kit), kit)


def test_the_line_of_each_program_of_the_documents_is_the_same_program() -> None:
    right_cases = [
        case for case in CASES if "tiniscript" in case.parts and "mistake" not in case.parts
    ]
    assert len(right_cases) > 150
    for case in right_cases:
        robot, _ = robot_and_senses(case)
        check_line(compile_case(case).source.text, robot.kit)
