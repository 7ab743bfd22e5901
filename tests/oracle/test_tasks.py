"""Programs with TASK and WHEN: the compiler and the machine agree with the oracle.

`python -m tests.oracle.test_tasks 100000` compares more programs than the tests, and the machine in
C++ as well.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Sequence
from functools import partial

import pytest

from tests.machines import MACHINES, Machine, Senses
from tests.machines.python import run_python
from tests.oracle.interpreter import PAPER_KIT, Mistake, run
from tests.oracle.task_programs import task_program
from tests.support.campaign import each_seed, wanted
from tests.support.rows import each_row
from tiniscript import Compilation, compile_text, robots
from tiniscript.base.source import Source
from tiniscript.bytecode.image import unpack
from tiniscript.syntax.formatter import format_source

KIT = robots.load("tinibot").kit
MAX_MS = 600
BATCH = 50


def check_program(seed: int, machines: Sequence[Machine] = (run_python,), needs: int = 0) -> str:
    """Compare the traces of one random program on some machines; return how it ended.

    With the `needs` of a way it has some.
    """
    rng = random.Random(seed)
    both: list[Compilation] = []
    while not both or unpack(both[0].image).needs & needs != needs:
        text, senses = task_program(rng, ways=needs != 0)
        both = [compile_text(text, KIT, optimize=optimize) for optimize in (True, False)]
        try:
            want = run(text, PAPER_KIT, senses, MAX_MS)
        except Mistake:  # DEFs that are called too deep in all tasks together
            assert not any(each.is_right for each in both), f"seed {seed}:\n{text}"
            both = []
            continue
        assert all(each.is_right for each in both), f"seed {seed}:\n{text}"
    for image in dict.fromkeys(each.image for each in both):  # often they are the same
        for machine in machines:
            got = machine(image, KIT, Senses(senses, MAX_MS))
            assert got == want, f"seed {seed}, {image.hex()}:\n{text}"
    laid_out = format_source(Source(text))
    assert compile_text(laid_out, KIT).image == both[0].image, f"seed {seed}"
    assert format_source(Source(laid_out)) == laid_out, f"seed {seed}"
    return want.split()[-1]


@pytest.mark.sampled("first", keep=3)
@pytest.mark.parametrize("first", range(0, 400, BATCH))
def test_random_programs(first: int) -> None:
    ends = Counter(check_program(seed) for seed in range(first, first + BATCH))
    assert set(ends) == {"DONE", "LIMIT"}


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
def test_what_both_refuse(text: str) -> None:
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
def test_what_both_take(text: str) -> None:
    assert run(text, max_time_ms=100)
    assert compile_text(text, KIT).is_right


def test_programs_without_tasks_say_the_version_without_them() -> None:
    """And those with one say the next, and what they need."""
    with_tasks, without = (
        compile_text(text, KIT).image for text in ("TASK;END_TASK;F(1, 50)", "F(1, 50)")
    )
    assert (without[2:4], without[14]) == (b"\x02\x00", 0)
    assert (with_tasks[2:4], with_tasks[14]) == (b"\x02\x01", 1)


if __name__ == "__main__":
    both = [MACHINES[name] for name in ("python", "host")]
    each_seed(partial(check_program, machines=both), wanted(100_000, 0))
