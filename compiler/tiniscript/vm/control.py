"""The handlers of jumps, loops and calls."""

from __future__ import annotations

from tiniscript.base.fixed_point import ONE, whole
from tiniscript.vm.handlers import HANDLERS, Handler, Step, handles
from tiniscript.vm.state import Execution
from tiniscript.vm.values import COMPARE, Compare


@handles("IF", "IF_FAR")
def _if(m: Execution, after: int, to: int) -> Step:
    pop = m.task.stack.pop
    return lambda: after if pop() else to


@handles("IF_NOT", "IF_NOT_FAR")
def _if_not(m: Execution, after: int, to: int) -> Step:
    return _if(m, to, after)


def _if_comparison_handler(compare: Compare) -> Handler:
    def handler(m: Execution, after: int, n: int, to: int) -> Step:
        pop, constant = m.task.stack.pop, n * ONE
        return lambda: after if compare(pop(), constant) else to

    return handler


def _if_var_comparison_handler(compare: Compare) -> Handler:
    def handler(m: Execution, after: int, v: int, n: int, to: int) -> Step:
        variables, constant = m.task.variables, n * ONE
        return lambda: after if compare(variables[v], constant) else to

    return handler


for _name, _compare in COMPARE.items():
    HANDLERS[f"IF8_{_name}"] = HANDLERS[f"IF16_{_name}"] = _if_comparison_handler(_compare)
    HANDLERS[f"IF_VAR8_{_name}"] = HANDLERS[f"IF_VAR16_{_name}"] = _if_var_comparison_handler(
        _compare
    )


@handles("ELSE", "ELSE_FAR", "BREAK", "BREAK_FAR", "DEF", "DEF_FAR")
def go(m: Execution, after: int, to: int) -> Step:
    return lambda: to


@handles("AGAIN", "AGAIN_FAR")
def _again(m: Execution, after: int, to: int) -> Step:
    return m.back_to(to)


@handles("FOREVER", "WHILE", "WHILE_FAR")
def _mark(m: Execution, after: int, to: int = 0) -> Step:
    return lambda: after


@handles("LOOP8")
def _loop8(m: Execution, after: int, n: int) -> Step:
    def step() -> int:
        m.task.counters.append(n)
        return after

    return step


@handles("LOOP", "LOOP_FAR")
def _loop(m: Execution, after: int, to: int) -> Step:
    def step() -> int:
        n = whole(m.task.stack.pop())
        if n < 1:
            return to
        m.task.counters.append(n)
        return after

    return step


@handles("NEXT", "NEXT_FAR")
def _next(m: Execution, after: int, to: int) -> Step:
    counters, back = m.task.counters, m.back_to(to)

    def step() -> int:
        left = counters[-1] - 1
        if left:
            counters[-1] = left
            return back()
        counters.pop()
        return after

    return step


@handles("BREAK_LOOP", "BREAK_LOOP_FAR")
def _break_loop(m: Execution, after: int, to: int) -> Step:
    def step() -> int:
        m.task.counters.pop()
        return to

    return step


@handles("CALL", "CALL_FAR")
def _call(m: Execution, after: int, to: int) -> Step:
    calls = m.task.calls

    def step() -> int:
        calls.append(after)
        return to

    return step


@handles("RETURN")
def _return(m: Execution, after: int) -> Step:
    return m.task.calls.pop


@handles("END")
def _end(m: Execution, after: int) -> Step:
    return m.end
