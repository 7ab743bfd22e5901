"""A program that was read: instructions, their blocks and their expressions.

Numbers are Python integers that count thousandths; yes/no values are bools.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

Value = int | bool


@dataclass(frozen=True)
class Expression:
    """An operator, a function or a leaf.

    `operator` is NUMBER, TRUTH, VARIABLE, OWN, SENSOR, TIME, MINUS, NOT, or the word or sign of the
    language. OWN is a value of the DEF around it; its name has both names: `SIDE.SIZE`.
    `is_literal` marks a number on its own: with or without one minus, and without parentheses.
    """

    operator: str
    is_yes_no: bool
    parts: tuple[Expression, ...] = ()
    value: Value = 0
    name: str = ""
    is_literal: bool = False


@dataclass
class Do:
    """An instruction without a body; the FOREVER of a move or wait is a None argument.

    `reads` are the readings that are taken before anything of the instruction is evaluated,
    `until_reads` those before each check of UNTIL.
    """

    word: str
    name: str = ""
    arguments: tuple[Expression | None, ...] = ()
    until: Expression | None = None
    reads: tuple[str, ...] = ()
    until_reads: tuple[str, ...] = ()
    unit: str = ""  # CM or DEG: the first argument is a way


@dataclass
class Arm:
    """An arm of an IF: its condition (None for ELSE) and its body."""

    condition: Expression | None
    body: list[Statement]
    reads: tuple[str, ...] = ()


@dataclass
class If:
    """An IF with its ELSEIFs and its ELSE."""

    arms: list[Arm]


@dataclass
class Loop:
    """A LOOP; the count None is FOREVER."""

    count: Expression | None
    body: list[Statement]
    reads: tuple[str, ...] = ()


@dataclass
class While:
    """A WHILE."""

    condition: Expression
    body: list[Statement]
    reads: tuple[str, ...] = ()


Statement = Do | If | Loop | While


@dataclass
class Task:
    """A TASK, or a WHEN with its condition and the readings before each look."""

    condition: Expression | None
    body: list[Statement]
    reads: tuple[str, ...] = ()


@dataclass
class Program:
    """A program that has passed every check. `tasks` are in the order of the text."""

    main: list[Statement]
    defs: dict[str, list[Statement]]
    variables: dict[str, bool]  # name: is it a yes/no value
    values: dict[str, tuple[str, ...]] = field(default_factory=dict)  # the names of a DEF's values
    tasks: list[Task] = field(default_factory=list)


class Facts(NamedTuple):
    """The effects of calling a DEF."""

    nesting: int  # blocks open in it at once
    calling: int  # DEFs that it has open at once, itself not counted
    surely_read: frozenset[str]


def stack_need(expression: Expression) -> int:
    """Return the number of values that an expression keeps at once."""
    return max([1, *(i + stack_need(part) for i, part in enumerate(expression.parts))])


def sensors_in(expressions: Iterable[Expression | None]) -> tuple[str, ...]:
    """The sensors that are named, each once, in order of appearance."""
    sensors: dict[str, None] = {}

    def look(expression: Expression) -> None:
        if expression.operator == "SENSOR":
            sensors[expression.name] = None
        for part in expression.parts:
            look(part)

    for expression in expressions:
        if expression is not None:
            look(expression)
    return tuple(sensors)
