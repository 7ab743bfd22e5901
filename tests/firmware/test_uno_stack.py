"""The stack on a simulated Uno: what the whole sketch leaves free of the RAM at its heaviest."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.machines.uno import built, needed
from tests.support.platformio import firmware, shared
from tiniscript import robots
from tools.bench.firmware_stack import LEAST_FREE, free_from, measured
from tools.uno import Stack, Uno


@pytest.fixture(autouse=True)
def needs_a_chip() -> None:
    needed()


def stack_of(program: int, interrupt: int, waits: bool) -> Stack:
    elf = built("stack", Program=program, Interrupt=interrupt, Waits=int(waits))
    with Uno(elf, watches_stack=True) as uno:
        uno.run_ms(20)
        return uno.stack(free_from(elf))


def test_program_and_interrupt_are_measured_apart() -> None:
    shallow, deep = (stack_of(bytes_taken, 40, False) for bytes_taken in (100, 400))
    assert deep.interrupt == shallow.interrupt
    assert 300 <= deep.program - shallow.program == shallow.untouched - deep.untouched
    longer = stack_of(100, 90, False)
    assert longer.program == shallow.program
    assert 50 <= longer.interrupt - shallow.interrupt <= 150


def test_what_is_left_at_least_is_what_is_left_where_they_meet() -> None:
    apart, met = (stack_of(400, 90, waits) for waits in (False, True))
    assert apart.untouched > met.untouched == met.least_free
    assert apart.least_free == pytest.approx(met.least_free, abs=4)


@pytest.mark.sampled(of="long ways of a chip")
@pytest.mark.parametrize(
    ("environment", "robot"),
    [("uno", "tinibot"), ("nano_liner", "liner"), ("uno_tinibot2", "tinibot2")],
)
def test_the_sketch_leaves_stack_free(
    environment: str,
    robot: str,
    tmp_path_factory: pytest.TempPathFactory,
    capsys: pytest.CaptureFixture[str],
) -> None:
    sketch: Path = firmware(
        environment, tmp_path_factory.mktemp("sketch"), shared(tmp_path_factory)
    )
    stack = measured(sketch, robots.load(robot), environment.partition("_")[0])
    with capsys.disabled():
        print(f"\n  {stack.untouched} bytes untouched, {stack.least_free} at least", end=" ")
    assert stack.untouched >= LEAST_FREE
    assert stack.least_free >= LEAST_FREE
