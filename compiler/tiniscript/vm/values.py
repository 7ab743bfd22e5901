"""The handlers of instructions that only calculate: values on the stack, and variables."""

from __future__ import annotations

import operator
from collections.abc import Callable

from tiniscript.base import fixed_point
from tiniscript.base.fixed_point import ONE, in_range, next_random, random_between
from tiniscript.base.words import COMPARATORS
from tiniscript.bytecode.opcodes import PUSHED_NUMBERS
from tiniscript.vm.handlers import HANDLERS, STAY, Handler, Step, handles
from tiniscript.vm.state import Execution

Compare = Callable[[int, int], bool]

# -- values -------------------------------------------------------------------------------------


@handles("PUSH_MILLI", "PUSH32")
def _push(m: Execution, after: int, n: int) -> Step:
    push = m.task.stack.append

    def step() -> int:
        push(n)
        return after

    return step


@handles("PUSH8", "PUSH16")
def _push_whole(m: Execution, after: int, n: int) -> Step:
    return _push(m, after, n * ONE)


@handles("PUSH_TENTHS")
def _push_tenths(m: Execution, after: int, n: int) -> Step:
    return _push(m, after, n * 100)


def _push_handler(n: int) -> Handler:
    return lambda m, after: _push(m, after, n)


HANDLERS["PUSH_FALSE"] = _push_handler(0)
HANDLERS["PUSH_TRUE"] = _push_handler(1)
for _number in PUSHED_NUMBERS:
    HANDLERS[f"PUSH_NUM_{_number}"] = _push_handler(_number * ONE)


def _push_of(m: Execution, after: int, values: list[int], number: int) -> Step:
    push = m.task.stack.append

    def step() -> int:
        push(values[number])
        return after

    return step


@handles("PUSH_VAR")
def _push_var(m: Execution, after: int, v: int) -> Step:
    return _push_of(m, after, m.task.variables, v)


@handles("PUSH_SENSOR")
def _push_sensor(m: Execution, after: int, s: int) -> Step:
    return _push_of(m, after, m.task.readings, s)


@handles("READ")
def _read(m: Execution, after: int, s: int) -> Step:
    readings = m.task.readings

    def step() -> int:
        reading = m.robot.read(s)
        if reading is None:
            return STAY
        readings[s] = reading
        return after

    return step


@handles("PUSH_READ")
def _push_read(m: Execution, after: int, s: int) -> Step:
    read, push = _read(m, after, s), _push_sensor(m, after, s)

    def step() -> int:
        return STAY if read() == STAY else push()

    return step


@handles("TIME")
def _time(m: Execution, after: int) -> Step:
    task = m.task

    def step() -> int:
        task.stack.append(in_range(m.now_ms - task.started_ms))
        return after

    return step


@handles("RANDOM")
def _random(m: Execution, after: int) -> Step:
    task = m.task

    def step() -> int:
        high, low = task.stack.pop(), task.stack.pop()
        task.random = next_random(task.random)
        task.stack.append(random_between(low, high, task.random))
        return after

    return step


def _binary(calculate: Callable[[int, int], int]) -> Handler:
    def handler(m: Execution, after: int) -> Step:
        stack = m.task.stack

        def step() -> int:
            right = stack.pop()
            stack[-1] = calculate(stack[-1], right)
            return after

        return step

    return handler


def _comparison_handler(compare: Compare) -> Handler:
    def handler(m: Execution, after: int) -> Step:
        stack = m.task.stack

        def step() -> int:
            right = stack.pop()
            stack[-1] = 1 if compare(stack[-1], right) else 0
            return after

        return step

    return handler


def _unary(calculate: Callable[[int], int]) -> Handler:
    def handler(m: Execution, after: int) -> Step:
        stack = m.task.stack

        def step() -> int:
            stack[-1] = calculate(stack[-1])
            return after

        return step

    return handler


COMPARE: dict[str, Compare] = {name: getattr(operator, name.lower()) for name, _ in COMPARATORS}
_CALCULATE: dict[str, Callable[[int, int], int]] = {
    "ADD": fixed_point.add, "SUB": fixed_point.subtract, "MUL": fixed_point.multiply,
    "DIV": fixed_point.divide, "MOD": fixed_point.modulo, "MIN": min, "MAX": max,
    "ROUND": fixed_point.round_to,
    "AND": lambda a, b: 1 if a and b else 0,
    "OR": lambda a, b: 1 if a or b else 0,
}  # fmt: skip
HANDLERS.update((name, _binary(calculate)) for name, calculate in _CALCULATE.items())
HANDLERS.update((name, _comparison_handler(compare)) for name, compare in COMPARE.items())
HANDLERS["NEG"] = _unary(fixed_point.negate)
HANDLERS["ABS"] = _unary(fixed_point.absolute)
HANDLERS["NOT"] = _unary(lambda a: 0 if a else 1)


@handles("AND_THEN", "AND_THEN_FAR")
def _and_then(m: Execution, after: int, to: int) -> Step:
    stack = m.task.stack

    def step() -> int:
        if not stack[-1]:
            return to
        stack.pop()
        return after

    return step


@handles("OR_ELSE", "OR_ELSE_FAR")
def _or_else(m: Execution, after: int, to: int) -> Step:
    stack = m.task.stack

    def step() -> int:
        if stack[-1]:
            return to
        stack.pop()
        return after

    return step


# -- variables ----------------------------------------------------------------------------------


@handles("SET_VAR")
def _set_var(m: Execution, after: int, v: int) -> Step:
    variables, pop = m.task.variables, m.task.stack.pop

    def step() -> int:
        variables[v] = pop()
        return after

    return step


@handles("SET_VAR8")
def _set_var8(m: Execution, after: int, v: int, n: int) -> Step:
    variables, value = m.task.variables, n * ONE

    def step() -> int:
        variables[v] = value
        return after

    return step


@handles("ADD_VAR8")
def _add_var8(m: Execution, after: int, v: int, n: int) -> Step:
    variables, value = m.task.variables, n * ONE

    def step() -> int:
        variables[v] = in_range(variables[v] + value)
        return after

    return step


@handles("INC_VAR")
def _inc_var(m: Execution, after: int, v: int) -> Step:
    return _add_var8(m, after, v, 1)


@handles("DEC_VAR")
def _dec_var(m: Execution, after: int, v: int) -> Step:
    return _add_var8(m, after, v, -1)


@handles("ADD_VAR")
def _add_var(m: Execution, after: int, v: int, w: int) -> Step:
    variables = m.task.variables

    def step() -> int:
        variables[v] = in_range(variables[v] + variables[w])
        return after

    return step
