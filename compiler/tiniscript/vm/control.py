"""The handlers of jumps, loops and calls."""

from __future__ import annotations

from tiniscript.base.fixed_point import ONE, round_to_whole
from tiniscript.vm.handlers import HANDLERS, Handler, Step, handles
from tiniscript.vm.state import Drive
from tiniscript.vm.values import COMPARISONS, Compare


@handles("IF", "IF_FAR")
def _if(machine: Drive, next_pc: int, target: int) -> Step:
    pop = machine.task.stack.pop
    return lambda: next_pc if pop() else target


@handles("IF_NOT", "IF_NOT_FAR")
def _if_not(machine: Drive, next_pc: int, target: int) -> Step:
    return _if(machine, target, next_pc)


def _if_comparison_handler(compare: Compare) -> Handler:
    def handler(machine: Drive, next_pc: int, number: int, target: int) -> Step:
        pop, constant = machine.task.stack.pop, number * ONE
        return lambda: next_pc if compare(pop(), constant) else target

    return handler


def _if_var_comparison_handler(compare: Compare) -> Handler:
    def handler(machine: Drive, next_pc: int, variable: int, number: int, target: int) -> Step:
        variables, constant = machine.task.variables, number * ONE
        return lambda: next_pc if compare(variables[variable], constant) else target

    return handler


for _name, _compare in COMPARISONS.items():
    HANDLERS[f"IF8_{_name}"] = HANDLERS[f"IF16_{_name}"] = _if_comparison_handler(_compare)
    HANDLERS[f"IF_VAR8_{_name}"] = HANDLERS[f"IF_VAR16_{_name}"] = _if_var_comparison_handler(
        _compare
    )


@handles("ELSE", "ELSE_FAR", "BREAK", "BREAK_FAR", "DEF", "DEF_FAR")
def jump(machine: Drive, next_pc: int, target: int) -> Step:
    return lambda: target


@handles("AGAIN", "AGAIN_FAR")
def _jump_back(machine: Drive, next_pc: int, target: int) -> Step:
    return machine.go_back(target)


@handles("FOREVER", "WHILE", "WHILE_FAR")
def _do_nothing(machine: Drive, next_pc: int, target: int = 0) -> Step:
    return lambda: next_pc


@handles("LOOP8")
def _loop8(machine: Drive, next_pc: int, times: int) -> Step:
    def step() -> int:
        machine.task.counters.append(times)
        return next_pc

    return step


@handles("LOOP", "LOOP_FAR")
def _loop(machine: Drive, next_pc: int, target: int) -> Step:
    def step() -> int:
        times = round_to_whole(machine.task.stack.pop())
        if times < 1:
            return target
        machine.task.counters.append(times)
        return next_pc

    return step


@handles("NEXT", "NEXT_FAR")
def _next(machine: Drive, next_pc: int, target: int) -> Step:
    counters, go_back = machine.task.counters, machine.go_back(target)

    def step() -> int:
        times_left = counters[-1] - 1
        if times_left:
            counters[-1] = times_left
            return go_back()
        counters.pop()
        return next_pc

    return step


@handles("BREAK_LOOP", "BREAK_LOOP_FAR")
def _break_loop(machine: Drive, next_pc: int, target: int) -> Step:
    def step() -> int:
        machine.task.counters.pop()
        return target

    return step


@handles("CALL", "CALL_FAR")
def _call(machine: Drive, next_pc: int, target: int) -> Step:
    calls = machine.task.calls

    def step() -> int:
        calls.append(next_pc)
        return target

    return step


@handles("RETURN")
def _return(machine: Drive, next_pc: int) -> Step:
    return machine.task.calls.pop


@handles("END")
def _end(machine: Drive, next_pc: int) -> Step:
    return machine.end
