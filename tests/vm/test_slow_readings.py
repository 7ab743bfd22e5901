"""Readings that take time, and the owner of the motors meanwhile: on every machine.

A move's UNTIL is not looked at while a higher task has the motors; when its task has them back, it
is looked at anew.

`python -m tests.vm.test_slow_readings 10000` compares more programs than the tests.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from functools import partial

import pytest

from tests.machines import Senses, avr, host
from tests.machines.host import host as host_machine
from tests.machines.pace import ECHO_SENSORS, Pace, random_pace, trace_at
from tests.oracle.interpreter import PAPER_KIT, run
from tests.oracle.task_programs import rival_program, task_program
from tests.support.campaign import each_seed, make_options
from tests.support.kits import KITS
from tiniscript import compile_text
from tiniscript.vm.tasks import machine_of

KIT = KITS[0][1]
MAX_MS = 600

Run = Callable[[Pace, bytes, Senses], str]


def run_python(pace: Pace, image: bytes, senses: Senses) -> str:
    return trace_at(pace, machine_of, image, KIT, senses)


def run_wasm(pace: Pace, image: bytes, senses: Senses) -> str:
    from tiniscript.vm.wasm import WasmImage

    return trace_at(pace, WasmImage(image, KIT).machine, image, KIT, senses)


def run_host(pace: Pace, image: bytes, senses: Senses) -> str:
    return host_machine().run_at(pace, image, KIT, senses).trace


def run_avr(chip: str, pace: Pace, image: bytes, senses: Senses) -> str:
    return avr.run_on(chip, image, KIT, senses, pace=pace).trace


MACHINES: dict[str, tuple[Run, str]] = {
    "python": (run_python, ""),
    "wasm": (run_wasm, ""),
    "host": (run_host, host.missing()),
    "uno": (partial(run_avr, avr.UNO), avr.missing()),
    "mega": (partial(run_avr, avr.MEGA), avr.missing()),
    "portable": (partial(run_avr, avr.PORTABLE_CHIP), avr.missing()),
}
each_machine = pytest.mark.parametrize(
    "machine",
    [
        pytest.param(value, id=name, marks=pytest.mark.skipif(bool(why), reason=why or "here"))
        for name, (value, why) in MACHINES.items()
    ],
)

TAKEN_AGAIN = """\
WHEN(LIGHT_R > 5);B(0.1, 50);END_WHEN
TASK;{};SHOW(1);END_TASK"""
LIGHTS = {"LIGHT_R": [9000, 0, 9000, 0], "DISTANCE": [5000]}


@each_machine
def test_a_check_awaiting_an_echo_ends_when_the_motors_are_taken(machine: Run) -> None:
    """The echo that comes at 150 ms is of a look at 120: the task has the motors back at 260."""
    image = compile_text(TAKEN_AGAIN.format("F(FOREVER, 40) UNTIL(DISTANCE < 10)"), KIT).image
    pace = Pace(slow=ECHO_SENSORS, period_ms=1000, from_ms=100, to_ms=150)
    actual = machine(pace, image, Senses(LIGHTS, 300))
    want = """\
0 READ LIGHT_R 9
0 MOTORS -50 -50
100 MOTORS 0 0
120 READ LIGHT_R 0
140 READ LIGHT_R 9
140 MOTORS -50 -50
240 MOTORS 0 0
260 READ LIGHT_R 0
260 READ DISTANCE 5
260 SHOW 1
280 READ LIGHT_R 0
300 READ LIGHT_R 0
300 LIMIT
"""
    assert actual == want


@each_machine
def test_a_first_check_is_not_continued_while_a_higher_task_has_the_motors(machine: Run) -> None:
    """No higher task existed when its task reached the move; the M before it is then over."""
    image = compile_text(
        """W(0.05)
TASK;W(0.02);B(0.1, 50);END_TASK
TASK;M(20, 30);F(FOREVER, 40) UNTIL(LIGHT_L > 5 AND DISTANCE < 10);SHOW(1);END_TASK""",
        KIT,
    ).image
    pace = Pace(slow=ECHO_SENSORS, period_ms=1000, from_ms=0, to_ms=70)
    actual = machine(pace, image, Senses({"LIGHT_L": [9000], "DISTANCE": [5000]}, 300))
    want = """\
0 MOTORS 20 30
0 READ LIGHT_L 9
20 MOTORS -50 -50
120 MOTORS 0 0
120 READ LIGHT_L 9
120 READ DISTANCE 5
120 SHOW 1
120 DONE
"""
    assert actual == want


@each_machine
def test_the_condition_of_a_wait_is_checked_whichever_task_has_the_motors(machine: Run) -> None:
    """The same applies to the condition of a WHEN, and to everything else that reads."""
    image = compile_text(
        """TASK;W(0.02);B(0.2, 50);END_TASK
TASK;W(FOREVER) UNTIL(DISTANCE < 10);SHOW(1);END_TASK
F(0.01, 20);X = DISTANCE;SHOW(2);W(1)""",
        KIT,
    ).image
    pace = Pace(slow=ECHO_SENSORS, period_ms=1000, from_ms=0, to_ms=70)
    actual = machine(pace, image, Senses({"DISTANCE": [5000]}, 100))
    want = """\
0 MOTORS 20 20
10 MOTORS 0 0
20 MOTORS -50 -50
70 READ DISTANCE 5
70 SHOW 1
70 READ DISTANCE 5
70 SHOW 2
100 LIMIT
"""
    assert actual == want


def check_program(seed: int, machines: Sequence[Run]) -> None:
    """Check that machines agree with the oracle, with tasks and late readings."""
    rng = random.Random(seed)
    text, readings = rng.choice((task_program, rival_program))(rng)
    pace = random_pace(rng)
    want = run(
        text, PAPER_KIT, readings, MAX_MS, seed=seed + 1, is_slow=pace.is_slow,
        call_interval_ms=pace.call_interval_ms,
    )  # fmt: skip
    image = compile_text(text, KIT).image
    for machine in machines:
        actual = machine(pace, image, Senses(readings, MAX_MS, seed=seed + 1))
        assert actual == want, f"seed {seed}, {pace}:\n{text}"


@pytest.mark.sampled("first", keep=2)
@pytest.mark.parametrize("first", range(0, 800, 100))
def test_random_programs_with_slow_readings_agree(first: int) -> None:
    for seed in range(first, first + 100):
        check_program(seed, (run_python,))


@each_machine
def test_random_programs_agree_on_each_machine(machine: Run) -> None:
    for seed in range(800, 840):
        check_program(seed, (machine,))


if __name__ == "__main__":
    both = [MACHINES[name][0] for name in ("python", "host")]
    each_seed(partial(check_program, machines=both), make_options(100_000, 0))
