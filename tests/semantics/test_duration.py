"""The duration of a program from its text alone: `least_ms`, `most_ms` (None: no bound) and
`never_ends`.
"""

from __future__ import annotations

import pytest

from tests.support.rows import each_row
from tiniscript import check_text, robots
from tiniscript.semantics.duration import Duration, duration_of_program
from tiniscript.semantics.optimizer import optimize_program

KIT = robots.load("tinibot").kit


def duration_of(text: str, is_optimized: bool = True) -> Duration:
    compilation = check_text(text, KIT)
    assert compilation.is_right and compilation.program is not None, compilation.diagnostics
    return duration_of_program(
        optimize_program(compilation.program) if is_optimized else compilation.program, KIT
    )


@each_row(
    "text, least_ms, most_ms",
    [
        ("F(1.5, 80);W(0.25);BEEP(0.5, 440)", 2250, 2250),
        ("W(1 - 3)", 0, 0),  # a time below 0 counts as 0
        ("M(50, 50);S;SHOW(DISTANCE);X = 5;SHOW(X)", 0, 0),  # instructions that take no time
        # UNTIL ends a move at any time, but not later than its time
        ("F(2, 80) UNTIL(DISTANCE < 9)", 0, 2000),
        ("F(FOREVER, 80) UNTIL(DISTANCE < 9)", 0, None),
        # the shortest arm, and the longest
        ("IF(DISTANCE < 9);W(1);ELSEIF(DISTANCE < 20);W(5);ELSE;W(3);ENDIF", 1000, 5000),
        # loops
        ("LOOP(2.5);W(2);END_LOOP", 6000, 6000),  # 3 times, as the robot does it
        ("LOOP(3);IF(DISTANCE < 9);BREAK;ENDIF;W(2);END_LOOP", 0, 6000),
        ("LOOP(DISTANCE);W(2);END_LOOP", 0, None),
        ("LOOP(DISTANCE);S;END_LOOP", 0, 0),
        ("LOOP(0);W(2);END_LOOP", 0, 0),
        ("LOOP(0 - 1);W(2);END_LOOP", 0, 0),
        ("WHILE(DISTANCE > 9);W(2);END_WHILE", 0, None),
        # A call takes the time of its DEF.
        ("DEF A;W(2);END_DEF;A;A", 4000, 4000),
        ("DEF A;W(2);END_DEF;DEF C;A;W(1);END_DEF;LOOP(2);C;END_LOOP", 6000, 6000),
        ("DEF A;W(DISTANCE);END_DEF;W(1);A", 1000, None),
        # several tasks: the longest counts, and a turn without a wait lasts a millisecond
        ("W(1);TASK;W(3);END_TASK", 3000, 3000),
        ("TASK;LOOP(3);SHOW(1);END_LOOP;END_TASK", 0, 3),
        ("LOOP(3);W(2);END_LOOP;TASK;W(1);END_TASK", 6000, 6000),
        ("LOOP(3);IF(DISTANCE < 9);W(1);ENDIF;END_LOOP;TASK;W(0.1);END_TASK", 100, 3003),
        ("LOOP(3);W(DISTANCE);END_LOOP;TASK;W(0.1);END_TASK", 100, None),
        ("LOOP(DISTANCE);SHOW(1);END_LOOP;TASK;W(1);END_TASK", 1000, None),
        # One of them may move; two movers wait for each other, or an S ends them.
        ("F(2, 80);TASK;W(3);F(1, 60);END_TASK", 0, None),
        ("DEF A;S;END_DEF;F(2, 80);TASK;W(3);A;END_TASK", 0, None),
    ],
)
def test_the_duration_of_an_ending_program_is_known(
    text: str, least_ms: int, most_ms: int | None
) -> None:
    for is_optimized in (True, False):
        assert duration_of(text, is_optimized) == Duration(least_ms, most_ms, False)


@pytest.mark.parametrize(
    ("text", "least_ms"),
    [
        ("W(2);LOOP(FOREVER);W(1);END_LOOP", 2000),
        (
            "IF(TIME < 9);LOOP(FOREVER);S;END_LOOP;ELSE;W(3);LOOP(FOREVER);W(1);END_LOOP;ENDIF",
            0,
        ),
        ("LOOP(3);W(1);LOOP(FOREVER);S;END_LOOP;END_LOOP", 1000),
        ("W(1);TASK;LOOP(FOREVER);W(1);END_LOOP;END_TASK", 1000),
        ("W(1);WHEN(DISTANCE < 9);SHOW(1);END_WHEN", 1000),  # a WHEN watches forever
    ],
)
def test_an_endless_program_has_no_duration(text: str, least_ms: int) -> None:
    assert duration_of(text) == Duration(least_ms, None, True)


def test_one_ending_branch_is_enough() -> None:
    text = "IF(DISTANCE < 9);LOOP(FOREVER);W(1);END_LOOP;ENDIF;W(2)"
    assert duration_of(text) == Duration(2000, None, False)
