"""The workloads that the machines are measured with, and their expected results.

It knows the programs, and the results of the machine in Python. Does not measure. Constants come
from a sensor, so that no compiler can fold them.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

from tiniscript import compile_text, robots
from tiniscript.base.trace import Ending, Senses
from tiniscript.bytecode.image import HEADER_BYTES
from tiniscript.vm.runner import run

KIT = robots.load(robots.DEFAULT).kit
SENSOR = [sensor.name for sensor in KIT.sensors].index("DISTANCE")


class Workload(NamedTuple):
    """A loop that runs so many `loop_count`, between reading its constants and showing its
    results."""

    name: str
    code_before: str
    body: str
    loop_count: int
    code_after: str
    readings: tuple[int, ...] = ()  # values of DISTANCE in units

    @property
    def text(self) -> str:
        return (
            f"{self.code_before} LOOP({self.loop_count}); {self.body} END_LOOP; {self.code_after}"
        )

    @property
    def thousandths(self) -> list[int]:
        return [1000 * reading for reading in self.readings]


class WrongResult(Exception):
    """A machine that is fast and wrong."""


WORKLOADS = (
    Workload("A", "K = DISTANCE; X = 0;", "X = X + K;", 10_000, "SHOW(X);", (3,)),
    Workload(
        "B",
        "D = 0; E = 0;",
        "D = D + 1; IF(D > 500); E = E + 1; ENDIF;",
        1000,
        "SHOW(D); SHOW(E);",
    ),
    # S, M, B and L are words of the language: the sum is named Y here, and the others P, Q and N
    Workload(
        "C",
        "P = DISTANCE; Q = DISTANCE; N = DISTANCE; A = 0; Y = 0;",
        "Y = Y + A*P; Y = Y/Q; Y = Y%N; A = A + 1;",
        1000,
        "SHOW(Y); SHOW(A);",
        (3, 7, 100),
    ),
)

MAX_CYCLES = (120.0, 200.0, 2400.0)  # cycles of one iteration, at most


@lru_cache
def image_of(work: Workload) -> bytes:
    compilation = compile_text(work.text, KIT)
    assert compilation.image, compilation.diagnostics
    return compilation.image


def code_of(work: Workload) -> bytes:
    return image_of(work)[HEADER_BYTES:]


@lru_cache
def expected_values(work: Workload) -> tuple[int, ...]:
    """Return the values that the machine in Python shows, in thousandths."""
    *events, ending = run(code_of(work), KIT, Senses(KIT, {SENSOR: work.thousandths}))
    assert isinstance(ending, Ending) and ending.kind == "DONE", ending
    return tuple(
        value
        for event in events
        if not isinstance(event, Ending) and event.kind == "SHOW"
        for value in event.values
    )


def check(machine: str, work: Workload, shown_values: Sequence[object]) -> None:
    """Raise WrongResult where a machine does not say the same as the one in Python."""
    if tuple(shown_values) != expected_values(work):
        raise WrongResult(
            f"{machine}, work {work.name}: {shown_values}, not {expected_values(work)}"
        )
