"""Says of each instruction which readings it takes, and how deep blocks and DEFs are open."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from tests.oracle.ast import Do, Expression, Facts, If, Loop, Program, Statement, sensors_in
from tests.oracle.words import MAX_DEFS, MAX_VARIABLES


def inner_blocks(statement: Statement) -> list[list[Statement]]:
    """The bodies of a statement."""
    if isinstance(statement, If):
        return [arm.body for arm in statement.arms]
    return [] if isinstance(statement, Do) else [statement.body]


def depths(body: list[Statement], defs: Mapping[str, Facts]) -> tuple[int, int]:
    """Return the open blocks and DEFs of a body at once; a call adds those of its DEF."""
    nesting = calling = 0
    for statement in body:
        for inner in inner_blocks(statement):
            nesting_depth, call_depth = depths(inner, defs)
            nesting, calling = max(nesting, 1 + nesting_depth), max(calling, call_depth)
        if isinstance(statement, Do) and statement.word == "CALL":
            facts = defs[statement.name]
            nesting, calling = max(nesting, facts.nesting), max(calling, 1 + facts.calling)
    return nesting, calling


def fit(program: Program) -> bool:
    """Return whether a machine has room for each task's own values."""
    calls = {name: set(list_called_defs(body)) for name, body in program.defs.items()}
    bodies = [program.main, *(task.body for task in program.tasks)]
    reached = [set(list_called_defs(body)) for body in bodies]
    owning: set[str] = set()
    for name in program.defs:  # calls only look back
        if program.values[name] or calls[name] & owning:
            owning.add(name)
    for names in reached:
        for name in reversed(program.defs):
            if name in names:
                names |= calls[name]
    variables, defs = len(program.variables), 0
    for name in program.defs:
        users = sum(name in names for names in reached) if name in owning else 1
        variables += max(1, users) * len(program.values[name])
        defs += max(1, users)
    return variables <= MAX_VARIABLES and defs <= MAX_DEFS


def list_called_defs(body: list[Statement]) -> Iterator[str]:
    """The DEFs that a body calls itself."""
    for statement in body:
        if isinstance(statement, Do) and statement.word == "CALL":
            yield statement.name
        for inner in inner_blocks(statement):
            yield from list_called_defs(inner)


def settle_readings(
    body: list[Statement], sure: frozenset[str], defs: Mapping[str, Facts]
) -> frozenset[str]:
    """Writes down which readings each instruction takes.

    `sure` are the sensors certainly read by name before the body; return those certainly read after
    it. Only `X;` certainly reads X.
    """

    def missing(
        expressions: Iterable[Expression | None], known_names: frozenset[str]
    ) -> tuple[str, ...]:
        return tuple(name for name in sensors_in(expressions) if name not in known_names)

    nothing: frozenset[str] = frozenset()
    for statement in body:
        if isinstance(statement, Do):
            statement.reads = missing(statement.arguments, sure)
            # UNTIL watches: it reads every sensor of its condition at every check.
            statement.until_reads = sensors_in((statement.until,))
            if statement.word == "READ":
                sure |= {statement.name}
            elif statement.word == "CALL":
                # A DEF's body begins without known readings, and a call adds its results.
                sure |= defs[statement.name].surely_read
        elif isinstance(statement, If):
            used_names = sure  # sensors that this chain need not read again
            branch_ends: list[frozenset[str]] = []
            for arm in statement.arms:
                arm.reads = missing((arm.condition,), used_names)
                used_names |= set(arm.reads)
                # The readings for conditions are the compiler's: they do not count as certain.
                branch_ends.append(settle_readings(arm.body, sure, defs))
            if statement.arms[-1].condition is not None:
                branch_ends.append(sure)  # a missing ELSE is an empty arm
            sure = frozenset.intersection(*branch_ends)
        elif isinstance(statement, Loop):
            statement.reads = missing((statement.count,), sure)
            settle_readings(statement.body, nothing, defs)
        else:
            statement.reads = missing((statement.condition,), nothing)
            settle_readings(statement.body, nothing, defs)
    return sure
