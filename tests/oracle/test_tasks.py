"""Programs with TASK and WHEN: the compiler and the machine agree with the oracle.

`python -m tests.oracle.test_tasks 100000` compares more programs than the tests, and the machine in
C++ as well.
"""

from __future__ import annotations

from collections import Counter
from functools import partial

import pytest

from tests.machines import MACHINES
from tests.oracle.interpreter import Mistake, run
from tests.support.campaign import each_seed, make_options
from tests.support.rows import each_row
from tests.support.task_agreement import KIT, compare_task_program
from tiniscript import compile_text

BATCH_SIZE = 50


@pytest.mark.sampled("first", keep=3)
@pytest.mark.parametrize("first", range(0, 400, BATCH_SIZE))
def test_random_programs_agree(first: int) -> None:
    end_counts = Counter(compare_task_program(seed) for seed in range(first, first + BATCH_SIZE))
    assert set(end_counts) == {"DONE", "LIMIT"}


@each_row(
    "text",
    [
        "LOOP(1);TASK;END_TASK;END_LOOP",
        "IF(TRUE);WHEN(TRUE);END_WHEN;ENDIF",
        "DEF A;TASK;END_TASK;END_DEF",
        "TASK;TASK;END_TASK;END_TASK",
        "TASK;DEF A;END_DEF;END_TASK",
        "TASK;END_TASK;" * 5,
        "TASK;BREAK;END_TASK",
        "LOOP(1);TASK;BREAK;END_TASK;END_LOOP",
        "WHEN DISTANCE < 15;S;END_WHEN",
        "WHEN(DISTANCE < 15) S;END_WHEN",
        "WHEN();END_WHEN",
        "WHEN(DISTANCE);END_WHEN",
        "WHEN(TRUE);S",
        "WHEN(TRUE);S;END_TASK",
        "TASK;S;END_WHEN",
        "TASK;IF(TRUE);END_TASK",
        "END_TASK",
        "TASK(1);END_TASK",
        "TASK A;END_TASK",
        "TASK = 1",
        "ENDWHEN = 1",
        "F(FOREVER, 60)",
        "TASK;SHOW(N);END_TASK;N = 0",
        "PING|check_connection;TASK;END_TASK",
        "TASK;" + "LOOP(1);" * 9 + "END_LOOP;" * 9 + "END_TASK;"
        + "LOOP(1);" * 8 + "END_LOOP;" * 8,
    ],
)  # fmt: skip
def test_both_refuse_the_same_programs(text: str) -> None:
    with pytest.raises(Mistake):
        run(text)
    assert not compile_text(text, KIT).is_right


@each_row(
    "text",
    [
        "TASK;END_TASK",
        "WHEN(TRUE);ENDWHEN;TASK;ENDTASK",
        "S;TASK;END_TASK;S",
        "F(FOREVER, 60);TASK;END_TASK",
        "TASK;W(FOREVER);END_TASK",
        "DEF A;B(FOREVER, 5);END_DEF;WHEN(FALSE);A;END_WHEN",
        "TASK;" + "LOOP(1);" * 8 + "END_LOOP;" * 8 + "END_TASK;"
        + "LOOP(1);" * 8 + "END_LOOP;" * 8,
    ],
)  # fmt: skip
def test_both_accept_the_same_programs(text: str) -> None:
    assert run(text, max_time_ms=100)
    assert compile_text(text, KIT).is_right


def test_programs_without_tasks_have_the_version_without_tasks() -> None:
    """Programs with a task need the next version, and its feature."""
    with_tasks, without = (
        compile_text(text, KIT).image for text in ("TASK;END_TASK;F(1, 50)", "F(1, 50)")
    )
    assert (without[2:4], without[14]) == (b"\x02\x00", 0)
    assert (with_tasks[2:4], with_tasks[14]) == (b"\x02\x01", 1)


if __name__ == "__main__":
    both = [MACHINES[name] for name in ("python", "host")]
    each_seed(partial(compare_task_program, machines=both), make_options(100_000, 0))
