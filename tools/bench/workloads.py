"""The works that the machines are measured with, and what must come out of them.

Knows the programs, the figures of others, and what the machine in Python says
of them. Does not measure. Constants come from a sensor, so that no compiler can fold them.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import cycle, islice
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "compiler")]

from tiniscript import compile_text, robots
from tiniscript.bytecode.image import HEADER_BYTES
from tiniscript.vm.trace import Ending, Event, Senses, run

KIT = robots.load(robots.DEFAULT).kit
SENSOR = [each.name for each in KIT.sensors].index("DISTANCE")


class Work(NamedTuple):
    """A loop that runs so many `times`, between reading its constants and showing its results."""

    name: str
    before: str
    body: str
    times: int
    after: str
    readings: tuple[int, ...] = ()  # of DISTANCE, in units; the first again after the last
    has_robot: bool = False  # its loop reads a sensor and sets motors

    @property
    def text(self) -> str:
        return f"{self.before} LOOP({self.times}); {self.body} END_LOOP; {self.after}"

    @property
    def thousandths(self) -> list[int]:
        return [1000 * reading for reading in self.readings]


class Ran(NamedTuple):
    """What a machine made of a work: values shown in thousandths, and instructions that ran."""

    shown: tuple[int, ...]
    steps: int


class WrongResult(Exception):
    """A machine that is fast and wrong."""


WORKS = (
    Work("A", "K = DISTANCE; X = 0;", "X = X + K;", 10_000, "SHOW(X);", (3,)),
    Work(
        "B",
        "D = 0; E = 0;",
        "D = D + 1; IF(D > 500); E = E + 1; ENDIF;",
        1000,
        "SHOW(D); SHOW(E);",
    ),
    # S, M, B and L are words of the language: the sum is Y here, and what it meets P, Q and N
    Work(
        "C",
        "P = DISTANCE; Q = DISTANCE; N = DISTANCE; A = 0; Y = 0;",
        "Y = Y + A*P; Y = Y/Q; Y = Y%N; A = A + 1;",
        1000,
        "SHOW(Y); SHOW(A);",
        (3, 7, 100),
    ),
)

# What comes beside C alone, compiled for the same chip.
MORE_WORKS = (
    Work("A2", "X = 0;", "X = X + 3;", 10_000, "SHOW(X);"),
    # the paper's obstacle loop: moves set the motors and do not wait
    Work(
        "D",
        "N = 0;",
        "M(80, 80); IF(DISTANCE < 10); STOP; M(60, -60); N = N + 1; ENDIF;",
        1000,
        "SHOW(N);",
        (50, 9, 30, 12, 8, 100, 10, 7),
        has_robot=True,
    ),
    Work(
        "E",
        "K = DISTANCE;",
        "E = DISTANCE - 5; M(50 + K*E, 50 - K*E);",
        1000,
        "SHOW(E);",
        (4, 5, 7, 3, 9, 1, 6, 2),
        has_robot=True,
    ),
    Work("F", "X = 0; DEF UP; X = X + 1; END_DEF;", "UP;", 1000, "SHOW(X);"),
)
ALL_WORKS = (*WORKS, *MORE_WORKS)

# Cycles of one iteration of A, B and C in the shipped sketch.
MUST = (120.0, 200.0, 2400.0)
AIM = (72.0, 120.0, 1500.0)

# The same works in other engines: its numbers, and its cycles.
OTHERS: tuple[tuple[str, str, tuple[float, ...]], ...] = (
    ("C, compiled, variables in RAM", "int32", (32, 47.5, 1380)),
    ("C, compiled, float", "float", (155, 260, 1039)),
    ("C, compiled, thousandths with int64", "thousandths", (32, 47.5, 3031)),
    ("FlashForth 5, compiles on the chip", "int16", (125, 205, 1294)),
    ("wasm3 0.5.0, on an ATmega1284P", "int32", (459, 737, 2454)),
    ("Aseba", "int16", (2234, 3323, 5330)),
    ("Snek 1.9", "float", (2877, 4815, 9598)),
    ("NanoVM 1.5 (Java)", "int31", (2964, 4552, 8926)),
    ("Microvium 8 (JavaScript)", "int32", (3843, 3956, 7085)),
    ("uLisp 4.8g, on an ATmega2560", "int16", (3451, 7751, 17232)),
    ("TinyBASIC Plus 0.15", "int16", (5513, 9571, 20084)),
    ("Bitlash 2.0", "int32", (8270, 13361, 17418)),
    ("uBASIC", "int16", (8893, 15836, 27855)),
)

# Mean cycles of the same operations as functions in C, called with numbers of the same kind.
OF_C = {"ADD": 4.0, "SUB": 4.0, "MUL": 1073.0, "DIV": 1070.0, "MOD": 606.0, "LT": 29.0}

# What others take on an AVR: what is measured, bytes of flash, bytes of RAM before anything runs.
OTHER_SIZES: tuple[tuple[str, str, int, int | str], ...] = (
    ("Aseba", "machine, no functions", 2584, 300),
    ("uBASIC", "core", 3040, 158),
    ("NanoVM 1.5", "whole program", 7712, 1073),
    ("TinyBASIC Plus 0.15", "whole program", 8132, 1375),
    ("FlashForth 5", "whole program", 8470, ""),
    ("Bitlash 2.0", "whole program", 15950, 996),
    ("Microvium 8", "machine, no float", 18433, 684),
    ("Snek 1.9", "whole program", 32204, 2048),
    ("uLisp 4.8g", "whole program, ATmega2560", 68268, 6147),
    ("wasm3 0.5.0", "whole program, ATmega1284P", 82266, 6250),
)


@lru_cache
def image_of(work: Work) -> bytes:
    compiled = compile_text(work.text, KIT)
    assert compiled.image, compiled.diagnostics
    return compiled.image


def code_of(work: Work) -> bytes:
    return image_of(work)[HEADER_BYTES:]


@lru_cache
def expected(work: Work) -> Ran:
    """Return what the machine in Python says."""
    shown: list[int] = []
    steps = 0
    for event in _events(work):
        if isinstance(event, Ending):
            assert event.what == "DONE", event
            steps = event.steps
        elif event.what == "SHOW":
            shown += event.values
    return Ran(tuple(shown), steps)


@lru_cache
def driven(work: Work) -> tuple[int, int]:
    """Return what the motors were told last; 0 and 0 where they never were."""
    told = (0, 0)
    for event in _events(work):
        if not isinstance(event, Ending) and event.what == "MOTORS":
            left, right = event.values
            told = (left, right)
    return told


def _events(work: Work) -> Iterator[Event | Ending]:
    readings = list(islice(cycle(work.thousandths), work.times + len(work.readings)))
    return run(code_of(work), KIT, Senses(KIT, {SENSOR: readings}))


def check(machine: str, work: Work, shown: Sequence[int], steps: int | None = None) -> None:
    """Raise WrongResult where a machine does not say the same as the one in Python.

    That of the AVR does not count instructions.
    """
    wanted = expected(work)
    ran = Ran(tuple(shown), wanted.steps if steps is None else steps)
    if ran != wanted:
        raise WrongResult(f"{machine}, work {work.name}: {ran}, not {wanted}")
