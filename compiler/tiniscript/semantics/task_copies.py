"""Gives each task that reaches a DEF with values a copy of it, with values of its own.

Two tasks may be in the same DEF at the same time: in one copy each would change the other's
values. A DEF without values that calls one with values is copied as well. Only programs that have
both tasks and such a DEF load this.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from tiniscript.base.limits import DEFS, VARIABLES
from tiniscript.semantics import ir


def copy_defs_per_task(program: ir.Program) -> ir.Program:
    """Return a program that does the same, in which no two tasks share a DEF's values."""
    reachable_defs = _reachable_defs(program)
    has_own_values = _has_own_values_by_def(program)
    procedures: list[ir.Procedure] = []
    variables = list(program.variables)
    numbers_by_task = [_TaskNumbers({}, {}) for _ in reachable_defs]
    for k, procedure in enumerate(program.procedures):
        tasks_reaching = [
            task for task, defs_reached in enumerate(reachable_defs) if k in defs_reached
        ]
        if not has_own_values[k] or len(tasks_reaching) < 2:
            for numbers in numbers_by_task:
                numbers.copy_of_def[k] = len(procedures)
            # A copy that is not shared keeps its variables, and calls what its task calls.
            procedures.append(
                _copy_procedure(
                    procedure, numbers_by_task[tasks_reaching[0] if tasks_reaching else 0]
                )
            )
            continue
        for task in tasks_reaching:
            numbers = numbers_by_task[task]
            if task != tasks_reaching[0]:
                for variable in procedure.values:
                    numbers.copy_of_variable[variable] = len(variables)
                    variables.append(program.variables[variable])
            numbers.copy_of_def[k] = len(procedures)
            procedures.append(_copy_procedure(procedure, numbers))
        for numbers in numbers_by_task:  # a DEF without a caller calls the first copy
            numbers.copy_of_def.setdefault(k, numbers_by_task[tasks_reaching[0]].copy_of_def[k])
    main_numbers, *other_numbers = numbers_by_task
    tasks = tuple(
        task._replace(body=_body(task.body, numbers))
        for task, numbers in zip(program.tasks, other_numbers, strict=True)
    )
    return program._replace(
        variables=tuple(variables), procedures=tuple(procedures),
        body=_body(program.body, main_numbers), tasks=tasks,
    )  # fmt: skip


class Excess(NamedTuple):
    """More copies than a machine takes, of this DEF, for these tasks: 0 is the main one."""

    procedure: int
    tasks: tuple[int, ...]
    resource: str  # "variables" or "defs"
    total: int  # total number, including copies
    limit: int


def find_excess(program: ir.Program) -> Excess | None:
    """Return the DEF whose copies a machine has no room for, if there is one."""
    has_own_values, reachable_defs = _has_own_values_by_def(program), _reachable_defs(program)
    variables, defs = len(program.variables), len(program.procedures)
    for k, procedure in enumerate(program.procedures):
        tasks_reaching = tuple(
            task for task, defs_reached in enumerate(reachable_defs) if k in defs_reached
        )
        if has_own_values[k] and len(tasks_reaching) > 1:
            variables += (len(tasks_reaching) - 1) * len(procedure.values)
            defs += len(tasks_reaching) - 1
            if variables > VARIABLES:
                return Excess(k, tasks_reaching, "variables", variables, VARIABLES)
            if defs > DEFS:
                return Excess(k, tasks_reaching, "defs", defs, DEFS)
    return None


def count_tasks_by_def(program: ir.Program) -> list[int]:
    """Return for each DEF the number of tasks that reach it."""
    reachable_defs = _reachable_defs(program)
    return [
        sum(k in defs_reached for defs_reached in reachable_defs)
        for k in range(len(program.procedures))
    ]


class _TaskNumbers(NamedTuple):
    """A task's own numbers of DEFs and variables, instead of those in the text."""

    copy_of_def: dict[int, int]
    copy_of_variable: dict[int, int]


def _reachable_defs(program: ir.Program) -> list[set[int]]:
    """Return the DEFs that each task reaches, the main task first."""
    defs_by_task = []
    for body in (program.body, *(task.body for task in program.tasks)):
        defs_reached: set[int] = set()
        for _ in ir.walk_with_calls(body, program.procedures, defs_reached):
            pass
        defs_by_task.append(defs_reached)
    return defs_by_task


def _has_own_values_by_def(program: ir.Program) -> list[bool]:
    """Return for each DEF whether it, or one that it calls, has parameters."""
    has_own_values: list[bool] = []
    for procedure in program.procedures:
        calls = [call.procedure for call in ir.walk(procedure.body) if isinstance(call, ir.Call)]
        has_own_values.append(bool(procedure.values) or any(has_own_values[k] for k in calls))
    return has_own_values


def _copy_procedure(procedure: ir.Procedure, numbers: _TaskNumbers) -> ir.Procedure:
    values = tuple(numbers.copy_of_variable.get(value, value) for value in procedure.values)
    return procedure._replace(body=_body(procedure.body, numbers), values=values)


def _body(body: ir.Body, numbers: _TaskNumbers) -> ir.Body:
    return tuple(_statement(item, numbers) for item in body)


def _statement(statement: ir.Statement, numbers: _TaskNumbers) -> ir.Statement:
    new_fields = ir.changed_values(
        statement, lambda value: _expression(value, numbers.copy_of_variable)
    )
    if isinstance(statement, ir.Call):
        new_fields["procedure"] = numbers.copy_of_def[statement.procedure]
    elif isinstance(statement, ir.Assign):
        new_fields["variable"] = numbers.copy_of_variable.get(
            statement.variable, statement.variable
        )
    elif isinstance(statement, ir.If):
        new_fields["arms"] = tuple(
            arm._replace(
                condition=_expression(arm.condition, numbers.copy_of_variable),
                body=_body(arm.body, numbers),
            )
            for arm in statement.arms
        )
        new_fields["else_body"] = _body(statement.else_body, numbers)
    elif isinstance(statement, (ir.Loop, ir.While)):
        new_fields["body"] = _body(statement.body, numbers)
    elif isinstance(statement, ir.Move) and statement.until is not None:
        condition = _expression(statement.until.condition, numbers.copy_of_variable)
        new_fields["until"] = statement.until._replace(condition=condition)
    return statement._replace(**new_fields)


def _expression(terms: ir.Expression, copy_of_variable: Mapping[int, int]) -> ir.Expression:
    return tuple(
        term._replace(value=copy_of_variable.get(term.value, term.value))
        if term.op == "VARIABLE" else term
        for term in terms
    )  # fmt: skip
