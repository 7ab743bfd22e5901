"""The abstract syntax tree (AST): only what was written, and where.

Blocks are nested, at most as deep as the language allows. An expression is flat: its parts in the
order in which a stack machine meets them, so that deep brackets cannot exhaust Python's stack.
AND_LEFT or OR_LEFT is between the two sides of an AND or OR.
"""

# No `from __future__ import annotations`: typing would compile each field's again, one by one.
from typing import NamedTuple

from tiniscript.base.source import Span


class Part(NamedTuple):
    """`op` is NUMBER, NAME, TRUE, FALSE, TIME, FOREVER, or an operation on the parts before."""

    op: str
    value: int | str
    start: int
    end: int


Expression = tuple[Part, ...]


class Argument(NamedTuple):
    """`is_plain`: just one number, with or without a minus, and no brackets around it.

    `unit` is the CM or DEG after it, which `span` does not hold.
    """

    expression: Expression
    span: Span
    is_plain: bool
    unit: Part | None = None


class Command(NamedTuple):
    """`WORD(a, b) UNTIL(c)` or a word alone; `arguments` is None if no bracket is."""

    word: str
    word_span: Span
    arguments: tuple[Argument, ...] | None
    until: Argument | None
    span: Span


class Assign(NamedTuple):
    """`value` is None if it could not be read."""

    name: str
    name_span: Span
    value: Argument | None
    span: Span


class Arm(NamedTuple):
    """IF or ELSEIF: `condition` is None if it could not be read."""

    condition: Argument | None
    body: "tuple[Instruction, ...]"
    span: Span


class If(NamedTuple):
    """`has_else`: it contains an ELSE, perhaps with nothing after it."""

    arms: tuple[Arm, ...]
    else_body: "tuple[Instruction, ...]"
    has_else: bool
    span: Span


class Loop(NamedTuple):
    """`times` is None for FOREVER."""

    times: Argument | None
    body: "tuple[Instruction, ...]"
    span: Span


class While(NamedTuple):
    condition: Argument | None
    body: "tuple[Instruction, ...]"
    span: Span


class Break(NamedTuple):
    span: Span


class Parameter(NamedTuple):
    """A name in the brackets of a DEF."""

    name: str
    span: Span


class Def(NamedTuple):
    name: str
    name_span: Span
    parameters: tuple[Parameter, ...]
    body: "tuple[Instruction, ...]"
    span: Span


class Task(NamedTuple):
    """TASK or WHEN. `condition` is None in a TASK, or where it could not be read."""

    is_when: bool
    condition: Argument | None
    body: "tuple[Instruction, ...]"
    span: Span


Instruction = Command | Assign | If | Loop | While | Break | Def | Task


class Program(NamedTuple):
    """`start` is SI, SB or PING."""

    start: str
    body: "tuple[Instruction, ...]"
