"""The handlers of instructions that only calculate: values on the stack, and variables."""

from __future__ import annotations

import operator
from collections.abc import Callable

from tiniscript.base import fixed_point
from tiniscript.base.fixed_point import ONE, in_range, next_random, random_between
from tiniscript.base.words import COMPARATORS
from tiniscript.bytecode.opcodes import PUSHED_NUMBERS
from tiniscript.vm.handlers import HANDLERS, STAY, Handler, Step, handles
from tiniscript.vm.state import Drive

Compare = Callable[[int, int], bool]

# -- values -------------------------------------------------------------------------------------


@handles("PUSH_MILLI", "PUSH32")
def _push(machine: Drive, next_pc: int, value: int) -> Step:
    push = machine.task.stack.append

    def step() -> int:
        push(value)
        return next_pc

    return step


@handles("PUSH8", "PUSH16")
def _push_whole(machine: Drive, next_pc: int, number: int) -> Step:
    return _push(machine, next_pc, number * ONE)


@handles("PUSH_TENTHS")
def _push_tenths(machine: Drive, next_pc: int, tenths: int) -> Step:
    return _push(machine, next_pc, tenths * 100)


def _push_handler(value: int) -> Handler:
    return lambda machine, next_pc: _push(machine, next_pc, value)


HANDLERS["PUSH_FALSE"] = _push_handler(0)
HANDLERS["PUSH_TRUE"] = _push_handler(1)
for _number in PUSHED_NUMBERS:
    HANDLERS[f"PUSH_NUM_{_number}"] = _push_handler(_number * ONE)


def _push_element(machine: Drive, next_pc: int, values: list[int], number: int) -> Step:
    push = machine.task.stack.append

    def step() -> int:
        push(values[number])
        return next_pc

    return step


@handles("PUSH_VAR")
def _push_var(machine: Drive, next_pc: int, variable: int) -> Step:
    return _push_element(machine, next_pc, machine.task.variables, variable)


@handles("PUSH_SENSOR")
def _push_sensor(machine: Drive, next_pc: int, sensor: int) -> Step:
    return _push_element(machine, next_pc, machine.task.readings, sensor)


@handles("READ")
def _read(machine: Drive, next_pc: int, sensor: int) -> Step:
    readings = machine.task.readings

    def step() -> int:
        reading = machine.robot.read(sensor)
        if reading is None:
            return STAY
        readings[sensor] = reading
        return next_pc

    return step


@handles("PUSH_READ")
def _push_read(machine: Drive, next_pc: int, sensor: int) -> Step:
    read, push = _read(machine, next_pc, sensor), _push_sensor(machine, next_pc, sensor)

    def step() -> int:
        return STAY if read() == STAY else push()

    return step


@handles("TIME")
def _time(machine: Drive, next_pc: int) -> Step:
    task = machine.task

    def step() -> int:
        task.stack.append(in_range(machine.now_ms - task.started_ms))
        return next_pc

    return step


@handles("RANDOM")
def _random(machine: Drive, next_pc: int) -> Step:
    task = machine.task

    def step() -> int:
        high, low = task.stack.pop(), task.stack.pop()
        task.random_state = next_random(task.random_state)
        task.stack.append(random_between(low, high, task.random_state))
        return next_pc

    return step


def _binary_handler(calculate: Callable[[int, int], int]) -> Handler:
    def handler(machine: Drive, next_pc: int) -> Step:
        stack = machine.task.stack

        def step() -> int:
            right = stack.pop()
            stack[-1] = calculate(stack[-1], right)
            return next_pc

        return step

    return handler


def _comparison_handler(compare: Compare) -> Handler:
    def handler(machine: Drive, next_pc: int) -> Step:
        stack = machine.task.stack

        def step() -> int:
            right = stack.pop()
            stack[-1] = 1 if compare(stack[-1], right) else 0
            return next_pc

        return step

    return handler


def _unary_handler(calculate: Callable[[int], int]) -> Handler:
    def handler(machine: Drive, next_pc: int) -> Step:
        stack = machine.task.stack

        def step() -> int:
            stack[-1] = calculate(stack[-1])
            return next_pc

        return step

    return handler


COMPARISONS: dict[str, Compare] = {name: getattr(operator, name.lower()) for name, _ in COMPARATORS}
_CALCULATIONS: dict[str, Callable[[int, int], int]] = {
    "ADD": fixed_point.add, "SUB": fixed_point.subtract, "MUL": fixed_point.multiply,
    "DIV": fixed_point.divide, "MOD": fixed_point.modulo, "MIN": min, "MAX": max,
    "ROUND": fixed_point.round_to,
    "AND": lambda a, b: 1 if a and b else 0,
    "OR": lambda a, b: 1 if a or b else 0,
}  # fmt: skip
HANDLERS.update((name, _binary_handler(calculate)) for name, calculate in _CALCULATIONS.items())
HANDLERS.update((name, _comparison_handler(compare)) for name, compare in COMPARISONS.items())
HANDLERS["NEG"] = _unary_handler(fixed_point.negate)
HANDLERS["ABS"] = _unary_handler(fixed_point.absolute)
HANDLERS["NOT"] = _unary_handler(lambda a: 0 if a else 1)


@handles("AND_THEN", "AND_THEN_FAR")
def _and_then(machine: Drive, next_pc: int, target: int) -> Step:
    stack = machine.task.stack

    def step() -> int:
        if not stack[-1]:
            return target
        stack.pop()
        return next_pc

    return step


@handles("OR_ELSE", "OR_ELSE_FAR")
def _or_else(machine: Drive, next_pc: int, target: int) -> Step:
    stack = machine.task.stack

    def step() -> int:
        if stack[-1]:
            return target
        stack.pop()
        return next_pc

    return step


# -- variables ----------------------------------------------------------------------------------


@handles("SET_VAR")
def _set_var(machine: Drive, next_pc: int, variable: int) -> Step:
    variables, pop = machine.task.variables, machine.task.stack.pop

    def step() -> int:
        variables[variable] = pop()
        return next_pc

    return step


@handles("SET_VAR8")
def _set_var8(machine: Drive, next_pc: int, variable: int, number: int) -> Step:
    variables, value = machine.task.variables, number * ONE

    def step() -> int:
        variables[variable] = value
        return next_pc

    return step


@handles("ADD_VAR8")
def _add_var8(machine: Drive, next_pc: int, variable: int, number: int) -> Step:
    variables, value = machine.task.variables, number * ONE

    def step() -> int:
        variables[variable] = in_range(variables[variable] + value)
        return next_pc

    return step


@handles("INC_VAR")
def _inc_var(machine: Drive, next_pc: int, variable: int) -> Step:
    return _add_var8(machine, next_pc, variable, 1)


@handles("DEC_VAR")
def _dec_var(machine: Drive, next_pc: int, variable: int) -> Step:
    return _add_var8(machine, next_pc, variable, -1)


@handles("ADD_VAR")
def _add_var(machine: Drive, next_pc: int, variable: int, other_variable: int) -> Step:
    variables = machine.task.variables

    def step() -> int:
        variables[variable] = in_range(variables[variable] + variables[other_variable])
        return next_pc

    return step
