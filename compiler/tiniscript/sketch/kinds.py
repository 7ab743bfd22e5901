"""What kind of numbers a sketch needs."""

from __future__ import annotations

from tiniscript.robots.profile import Robot
from tiniscript.semantics import ir
from tiniscript.semantics.optimizer import constant
from tiniscript.sketch.expressions import FUNCTIONS, is_float
from tiniscript.sketch.wiring import is_count, is_small


def needs_numbers(program: ir.Program, robot: Robot) -> bool:
    """Whether a program calculates: then it needs numbers that are exact."""
    kit, wired = robot.kit, robot.board.sensors
    for statement in ir.every(program):
        if isinstance(statement, ir.Show) and not statement.is_yes_no:
            value = statement.value[0]
            if value.op == "SENSOR" and not is_count(kit.sensors[value.value], wired[value.value]):
                return True
        if isinstance(statement, ir.Assign) or any(map(_is_computed, _arguments(statement, robot))):
            return True
        for expression in ir.expressions(statement):
            if any(_calculates(term) for term in expression):
                return True
    return not is_small(kit.sensors)


def _arguments(statement: ir.Statement, robot: Robot) -> tuple[ir.Expression | None, ...]:
    """Return the arguments that are numbers."""
    if isinstance(statement, ir.Move):
        return statement.time, statement.power
    if isinstance(statement, ir.Motors):
        return statement.left, statement.right
    if isinstance(statement, ir.Beep):
        return statement.time, statement.hertz
    if isinstance(statement, ir.Loop):
        return (statement.times,)
    if isinstance(statement, ir.Set) and not robot.kit.actuators[statement.actuator].is_yes_no:
        return (statement.value,)
    return ()


def _is_computed(expression: ir.Expression | None) -> bool:
    return expression is not None and constant(expression) is None


def _calculates(term: ir.Term) -> bool:
    if term.op == "NUMBER":
        return not is_float(term.value) or abs(term.value) >= 2**24
    return term.op in FUNCTIONS or term.op in ("ADD", "SUB", "MUL", "DIV", "MOD", "NEG", "ABS",
                                               "TIME")  # fmt: skip
