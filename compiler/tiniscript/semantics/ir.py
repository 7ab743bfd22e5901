"""The IR: a checked program, with every sensor reading as a step of its own.

The checker writes it, the optimiser rewrites it, `lower` turns it into instructions. Names are
numbers here: variables, sensors, actuators and DEFs by their order. Numbers are thousandths,
TRUE is 1 and FALSE is 0. All mistakes have been reported before.
"""

# No `from __future__ import annotations`: typing would compile each field's again, one by one.
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any, NamedTuple

from tiniscript.base.kit import Kit
from tiniscript.base.source import Span
from tiniscript.base.words import Argument, Word

# An expression is flat, in the order in which a stack machine meets it. `op` is NUMBER, YES_NO,
# VARIABLE, SENSOR, TIME, AND_LEFT, OR_LEFT, AND, OR or the name of a value instruction that
# takes its operands from the stack (ADD, NEG, ROUND, ...).


class Term(NamedTuple):
    op: str
    value: int = 0


Expression = tuple[Term, ...]


class Read(NamedTuple):
    sensor: int
    span: Span


class Until(NamedTuple):
    """The check of a move: its readings, then its condition."""

    reads: tuple[int, ...]
    condition: Expression


class Move(NamedTuple):
    """`direction` is F, B, L, R or W; a wait has no power. `time` is None for FOREVER.

    `unit` is CM or DEG where `time` is not a time but a way.
    """

    direction: str
    time: Expression | None
    power: Expression | None
    until: Until | None
    span: Span
    unit: str = ""


class Motors(NamedTuple):
    left: Expression
    right: Expression
    span: Span


class Stop(NamedTuple):
    span: Span


class Act(NamedTuple):
    """An action of a robot with values, other than with its motors.

    The row of its word has its properties. It becomes the instruction, and in a sketch the helper,
    that is named as the role of the word.
    """

    word: Word
    values: tuple[Expression, ...]
    span: Span

    @property
    def arguments(self) -> tuple[tuple[Argument, Expression], ...]:
        return tuple(zip(self.word.arguments, self.values, strict=True))

    @property
    def time(self) -> Expression | None:
        """Return its duration, if it has one."""
        return next((value for argument, value in self.arguments if argument.unit == "s"), None)


class Show(NamedTuple):
    value: Expression
    is_yes_no: bool
    span: Span


class Set(NamedTuple):
    actuator: int
    value: Expression
    span: Span


class Assign(NamedTuple):
    variable: int
    value: Expression
    span: Span


class Arm(NamedTuple):
    reads: tuple[int, ...]
    condition: Expression
    body: "tuple[Statement, ...]"
    span: Span


class If(NamedTuple):
    """`has_else`: the text has an ELSE, perhaps with nothing after it."""

    arms: tuple[Arm, ...]
    else_body: "tuple[Statement, ...]"
    span: Span
    has_else: bool = False


class Loop(NamedTuple):
    """`times` is None for FOREVER."""

    times: Expression | None
    body: "tuple[Statement, ...]"
    span: Span


class While(NamedTuple):
    reads: tuple[int, ...]
    condition: Expression
    body: "tuple[Statement, ...]"
    span: Span


class Break(NamedTuple):
    span: Span


class Call(NamedTuple):
    procedure: int
    span: Span


Statement = (
    Read | Move | Motors | Stop | Act | Show | Set | Assign | If | Loop | While | Break | Call
)
Body = tuple[Statement, ...]


class Procedure(NamedTuple):
    """A DEF that is not `is_called` becomes no code.

    `values` are the variables of the names in its brackets: right before a call each is assigned.
    """

    name: str
    body: Body
    span: Span
    is_called: bool = True
    values: tuple[int, ...] = ()


class Task(NamedTuple):
    """TASK, or a WHEN with the check `until`, parallel to the main task."""

    until: Until | None
    body: Body
    span: Span

    @property
    def word(self) -> Span:
        """Return the span of the word TASK or WHEN."""
        return Span(self.span.start, self.span.start + len("TASK"))


class Program(NamedTuple):
    """`variables` are names in the order of their numbers; `start` is SI, SB or PING.

    `body` is the main task; `tasks` are the others in the order of the text.
    """

    start: str
    variables: tuple[str, ...]
    procedures: tuple[Procedure, ...]
    body: Body
    tasks: tuple[Task, ...] = ()


def bodies(statement: Statement) -> tuple[Body, ...]:
    """Return the blocks that a statement holds."""
    if isinstance(statement, If):
        return (*(arm.body for arm in statement.arms), statement.else_body)
    if isinstance(statement, (Loop, While)):
        return (statement.body,)
    return ()


def walk(body: Body) -> Iterator[Statement]:
    """Yield every statement of `body`, those of its blocks included, in order of the text."""
    for statement in body:
        yield statement
        for inner in bodies(statement):
            yield from walk(inner)


def walk_with_calls(
    body: Body, procedures: Sequence[Procedure], called_procedures: set[int] | None = None
) -> Iterator[Statement]:
    """Yield every statement of `body`, and after a call those of its DEF: of each DEF once."""
    called_procedures = set() if called_procedures is None else called_procedures
    for statement in walk(body):
        yield statement
        if isinstance(statement, Call) and statement.procedure not in called_procedures:
            called_procedures.add(statement.procedure)
            yield from walk_with_calls(
                procedures[statement.procedure].body, procedures, called_procedures
            )


def all_statements(program: Program) -> Iterator[Statement]:
    """Yield every statement of a program, those of its DEFs first, then those of its tasks."""
    for body in routines(program):
        yield from walk(body)


def first_extent_move(program: Program) -> Span | None:
    """Return the span of the first move by centimetres or degrees."""
    moves = (move for move in all_statements(program) if isinstance(move, Move) and move.unit)
    return min((move.span for move in moves), default=None)


def routines(program: Program) -> tuple[Body, ...]:
    """Return the bodies of the DEFs, those of the tasks, and the main task."""
    procedures = (procedure.body for procedure in program.procedures)
    return (*procedures, *(task.body for task in program.tasks), program.body)


_YES_NO_OPS = frozenset(("YES_NO", "NOT", "AND", "OR", "LT", "LE", "GT", "GE", "EQ", "NE"))


def yes_no_variables(program: Program, kit: Kit) -> list[bool]:
    """Return for each variable whether it is a yes-no value."""
    are_yes_no = [False] * len(program.variables)
    copies: list[Assign] = []  # the value is another variable
    for statement in all_statements(program):
        if not isinstance(statement, Assign):
            continue
        last_term = statement.value[-1]
        if last_term.op == "VARIABLE":
            copies.append(statement)
        elif last_term.op == "SENSOR":
            are_yes_no[statement.variable] = kit.readings[last_term.value].is_yes_no
        else:
            are_yes_no[statement.variable] = last_term.op in _YES_NO_OPS
    known_count = -1
    while known_count < sum(are_yes_no):  # a DEF may copy a variable that is set below it
        known_count = sum(are_yes_no)
        for copy in copies:
            are_yes_no[copy.variable] |= are_yes_no[copy.value[-1].value]
    return are_yes_no


# The fields of statements that are expressions; new statements must use these names.
_VALUE_FIELDS = frozenset(("time", "power", "left", "right", "value", "times", "condition"))


def values_of(statement: Statement) -> dict[str, Expression]:
    """Return the expressions of a statement, by their names, in their order."""
    if isinstance(statement, Act):
        return {argument.name: value for argument, value in statement.arguments}
    fields: dict[str, Any] = statement._asdict()
    return {
        name: value for name, value in fields.items() if name in _VALUE_FIELDS and value is not None
    }


def changed_values(
    statement: Statement, change: Callable[[Expression], Expression]
) -> dict[str, Any]:
    """Return the fields of a statement that hold its expressions, each changed."""
    new_values = {name: change(value) for name, value in values_of(statement).items()}
    return {"values": (*new_values.values(),)} if isinstance(statement, Act) else new_values


def takes_time(statement: Statement) -> bool:
    """Return whether a statement takes time: a move, a wait or a sound."""
    return isinstance(statement, Move) or (
        isinstance(statement, Act) and statement.word.role.takes_time
    )


def time_of(statement: Statement) -> Expression | None:
    """Return the time after which the next statement starts, if it is fixed; a distance is not."""
    if isinstance(statement, (Move, Act)) and takes_time(statement):
        return None if isinstance(statement, Move) and statement.unit else statement.time
    return None


def expressions(statement: Statement | Task) -> Iterator[Expression]:
    """Yield the expressions of a statement or a WHEN itself, not those of its blocks' bodies."""
    if isinstance(statement, Task):
        if statement.until is not None:
            yield statement.until.condition
        return
    yield from values_of(statement).values()
    if isinstance(statement, Move) and statement.until is not None:
        yield statement.until.condition
    elif isinstance(statement, If):
        for arm in statement.arms:
            yield arm.condition


def referenced_numbers(op: str, statements: Iterable[Statement | Task]) -> set[int]:
    """Return the numbers of the variables or sensors that an expression of these has."""
    return {
        term.value
        for statement in statements
        for expression in expressions(statement)
        for term in expression
        if term.op == op
    }


def breaks_out(body: Body) -> bool:
    """Return whether a BREAK in `body` leaves the loop around it."""
    for statement in body:
        if isinstance(statement, Break):
            return True
        if isinstance(statement, If) and any(map(breaks_out, bodies(statement))):
            return True
    return False


def falls_through(body: Body) -> bool:
    """Return whether the end of `body` can be reached, whatever its conditions."""
    for statement in body:
        if isinstance(statement, Break):
            return False
        if isinstance(statement, Loop) and statement.times is None:
            if not breaks_out(statement.body):
                return False
        elif isinstance(statement, If) and not any(map(falls_through, bodies(statement))):
            return False
    return True
