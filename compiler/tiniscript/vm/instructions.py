"""What each instruction does.

One handler for each row of the table in `bytecode`; importing this fails where one is missing.
A handler gets the machine, the task and the operands, with jump targets as offsets in the code.
It returns True where the machine must stop for now.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import TYPE_CHECKING

from tiniscript import fixed_point
from tiniscript.bytecode.opcodes import BY_CODE, COMPARATORS, OPS, read_operands
from tiniscript.fixed_point import ONE, in_range, limited, next_random, random_between, whole
from tiniscript.vm.state import DONE, FOREVER, MOVE, PAUSE, Task

if TYPE_CHECKING:
    from tiniscript.vm.machine import Machine

Result = bool | None
Handler = Callable[..., Result]
Step = tuple[Handler, tuple[int, ...], int]

_HANDLERS: dict[str, Handler] = {}


def decoded(code: bytes) -> list[Step]:
    """Return the handler, the operands and the successor of the instruction at each offset.

    Behind the code stands END.
    """
    steps: list[Step] = [(_end, (), 0)] * (len(code) + 1)
    at = 0
    while at < len(code):
        op = BY_CODE[code[at]]
        assert op is not None, "the code is not verified"
        after = at + op.size
        operands = read_operands(op, code, at)
        kind = op.operands[-1].kind.name if operands else ""
        if kind.startswith("fwd"):
            operands = (*operands[:-1], after + operands[-1])
        elif kind.startswith("back"):
            operands = (*operands[:-1], after - operands[-1])
        steps[at] = (_HANDLERS[op.name], operands, after)
        at = after
    return steps


def _does(*names: str) -> Callable[[Handler], Handler]:
    def note(handler: Handler) -> Handler:
        for name in names:
            _HANDLERS[name] = handler
        return handler

    return note


def _duration(time: int) -> int:
    """Return milliseconds: a time in thousandths of a second, not below 0."""
    return max(time, 0)


# -- values -------------------------------------------------------------------------------------


@_does("PUSH8", "PUSH16")
def _push_whole(m: Machine, t: Task, n: int) -> None:
    t.stack.append(n * ONE)


@_does("PUSH_MILLI", "PUSH32")
def _push(m: Machine, t: Task, n: int) -> None:
    t.stack.append(n)


@_does("PUSH_FALSE")
def _push_false(m: Machine, t: Task) -> None:
    t.stack.append(0)


@_does("PUSH_TRUE")
def _push_true(m: Machine, t: Task) -> None:
    t.stack.append(1)


@_does("PUSH_VAR")
def _push_var(m: Machine, t: Task, v: int) -> None:
    t.stack.append(t.variables[v])


@_does("PUSH_SENSOR")
def _push_sensor(m: Machine, t: Task, s: int) -> None:
    t.stack.append(t.readings[s])


@_does("READ")
def _read(m: Machine, t: Task, s: int) -> Result:
    reading = m.robot.read(s)
    if reading is None:
        return m.retry()
    t.readings[s] = reading
    return None


@_does("PUSH_READ")
def _push_read(m: Machine, t: Task, s: int) -> Result:
    if _read(m, t, s):
        return True
    t.stack.append(t.readings[s])
    return None


@_does("TIME")
def _time(m: Machine, t: Task) -> None:
    t.stack.append(in_range(m.now_ms - t.started_ms))


@_does("RANDOM")
def _random(m: Machine, t: Task) -> None:
    high, low = t.stack.pop(), t.stack.pop()
    t.random = next_random(t.random)
    t.stack.append(random_between(low, high, t.random))


def _binary(name: str, calculate: Callable[[int, int], int]) -> None:
    def handler(m: Machine, t: Task) -> None:
        right = t.stack.pop()
        t.stack[-1] = calculate(t.stack[-1], right)

    _HANDLERS[name] = handler


def _comparing(name: str, compare: Callable[[int, int], bool]) -> None:
    def handler(m: Machine, t: Task) -> None:
        right = t.stack.pop()
        t.stack[-1] = 1 if compare(t.stack[-1], right) else 0

    _HANDLERS[name] = handler


def _unary(name: str, calculate: Callable[[int], int]) -> None:
    def handler(m: Machine, t: Task) -> None:
        t.stack[-1] = calculate(t.stack[-1])

    _HANDLERS[name] = handler


_COMPARE: dict[str, Callable[[int, int], bool]] = {
    name: getattr(operator, name.lower()) for name, _ in COMPARATORS
}
_CALCULATE: dict[str, Callable[[int, int], int]] = {
    "ADD": fixed_point.add, "SUB": fixed_point.subtract, "MUL": fixed_point.multiply,
    "DIV": fixed_point.divide, "MOD": fixed_point.modulo, "MIN": min, "MAX": max,
    "ROUND": fixed_point.round_to, "AND": operator.and_, "OR": operator.or_,
}  # fmt: skip
for _name, _function in _CALCULATE.items():
    _binary(_name, _function)
for _name, _comparison in _COMPARE.items():
    _comparing(_name, _comparison)
_unary("NEG", fixed_point.negate)
_unary("ABS", fixed_point.absolute)
_unary("NOT", lambda a: 0 if a else 1)


@_does("AND_THEN", "AND_THEN_FAR")
def _and_then(m: Machine, t: Task, to: int) -> None:
    if t.stack[-1]:
        t.stack.pop()
    else:
        t.pc = to


@_does("OR_ELSE", "OR_ELSE_FAR")
def _or_else(m: Machine, t: Task, to: int) -> None:
    if t.stack[-1]:
        t.pc = to
    else:
        t.stack.pop()


# -- variables ----------------------------------------------------------------------------------


@_does("SET_VAR")
def _set_var(m: Machine, t: Task, v: int) -> None:
    t.variables[v] = t.stack.pop()


@_does("SET_VAR8")
def _set_var8(m: Machine, t: Task, v: int, n: int) -> None:
    t.variables[v] = n * ONE


@_does("ADD_VAR8")
def _add_var8(m: Machine, t: Task, v: int, n: int) -> None:
    t.variables[v] = in_range(t.variables[v] + n * ONE)


@_does("ADD_VAR")
def _add_var(m: Machine, t: Task, v: int, w: int) -> None:
    t.variables[v] = in_range(t.variables[v] + t.variables[w])


# -- the robot ----------------------------------------------------------------------------------


@_does("SHOW")
def _show(m: Machine, t: Task) -> Result:
    return _sent(m, t, False)


@_does("SHOW_YES_NO")
def _show_yes_no(m: Machine, t: Task) -> Result:
    return _sent(m, t, True)


def _sent(m: Machine, t: Task, is_yes_no: bool) -> Result:
    if not m.robot.show(t.stack[-1], is_yes_no):
        return m.retry()
    t.stack.pop()
    return None


@_does("SET")
def _set(m: Machine, t: Task, a: int) -> None:
    m.robot.set(a, t.stack.pop())


def _percent(power: int, low: int) -> int:
    return limited(whole(power), low, 100)


def _moves(direction: str, left: int, right: int) -> None:
    """Make the handlers of the four instructions that drive in one direction."""

    def powers(power: int) -> tuple[int, int]:
        return left * power, right * power

    def move8(m: Machine, t: Task, tenths: int, power: int) -> Result:
        m.robot.motors(*powers(power))
        return m.wait(tenths * 100, MOVE)

    def move(m: Machine, t: Task) -> Result:
        power, time = t.stack.pop(), t.stack.pop()
        m.robot.motors(*powers(_percent(power, 0)))
        return m.wait(_duration(time), MOVE)

    def watch(m: Machine, t: Task) -> None:
        power, time = t.stack.pop(), t.stack.pop()
        _prepare(t, _duration(time), powers(_percent(power, 0)))

    def watch_forever(m: Machine, t: Task) -> None:
        _prepare(t, FOREVER, powers(_percent(t.stack.pop(), 0)))

    _HANDLERS[f"MOVE8_{direction}"] = move8
    _HANDLERS[f"MOVE_{direction}"] = move
    _HANDLERS[f"WATCH_{direction}"] = watch
    _HANDLERS[f"WATCH_FOREVER_{direction}"] = watch_forever


def _prepare(t: Task, move_ms: int, powers: tuple[int, int] | None) -> None:
    t.move_ms, t.powers, t.is_watching = move_ms, powers, False


_moves("F", 1, 1)
_moves("B", -1, -1)
_moves("L", -1, 1)
_moves("R", 1, -1)


@_does("WAIT")
def _wait(m: Machine, t: Task) -> Result:
    return m.wait(_duration(t.stack.pop()), PAUSE)


@_does("WAIT8")
def _wait8(m: Machine, t: Task, tenths: int) -> Result:
    return m.wait(tenths * 100, PAUSE)


@_does("WATCH_WAIT")
def _watch_wait(m: Machine, t: Task) -> None:
    _prepare(t, _duration(t.stack.pop()), None)


@_does("WATCH_FOREVER_WAIT")
def _watch_forever_wait(m: Machine, t: Task) -> None:
    _prepare(t, FOREVER, None)


@_does("UNTIL", "UNTIL_FAR")
def _until(m: Machine, t: Task, to: int) -> Result:
    return m.until(bool(t.stack.pop()), to)


@_does("STOP")
def _stop(m: Machine, t: Task) -> None:
    m.robot.motors(0, 0)


@_does("MOTORS")
def _motors(m: Machine, t: Task) -> None:
    right, left = t.stack.pop(), t.stack.pop()
    m.robot.motors(_percent(left, -100), _percent(right, -100))


@_does("MOTORS8")
def _motors8(m: Machine, t: Task, left: int, right: int) -> None:
    m.robot.motors(left, right)


@_does("BEEP")
def _beep(m: Machine, t: Task) -> Result:
    hertz, time = t.stack.pop(), t.stack.pop()
    m.robot.beep(limited(whole(hertz), 31, 20_000), _duration(time))
    return m.wait(_duration(time), PAUSE)


# -- control ------------------------------------------------------------------------------------


@_does("IF", "IF_FAR")
def _if(m: Machine, t: Task, to: int) -> None:
    if not t.stack.pop():
        t.pc = to


@_does("IF_NOT", "IF_NOT_FAR")
def _if_not(m: Machine, t: Task, to: int) -> None:
    if t.stack.pop():
        t.pc = to


@_does("ELSE", "ELSE_FAR", "AGAIN", "AGAIN_FAR", "BREAK", "BREAK_FAR", "DEF", "DEF_FAR")
def _go(m: Machine, t: Task, to: int) -> None:
    t.pc = to


@_does("FOREVER", "WHILE", "WHILE_FAR")
def _mark(m: Machine, t: Task, to: int = 0) -> None:
    pass


@_does("LOOP8")
def _loop8(m: Machine, t: Task, n: int) -> None:
    t.counters.append(n)


@_does("LOOP", "LOOP_FAR")
def _loop(m: Machine, t: Task, to: int) -> None:
    n = whole(t.stack.pop())
    if n < 1:
        t.pc = to
    else:
        t.counters.append(n)


@_does("NEXT", "NEXT_FAR")
def _next(m: Machine, t: Task, to: int) -> None:
    t.counters[-1] -= 1
    if t.counters[-1]:
        t.pc = to
    else:
        t.counters.pop()


@_does("BREAK_LOOP", "BREAK_LOOP_FAR")
def _break_loop(m: Machine, t: Task, to: int) -> None:
    t.counters.pop()
    t.pc = to


@_does("CALL", "CALL_FAR")
def _call(m: Machine, t: Task, to: int) -> None:
    t.calls.append(t.pc)
    t.pc = to


@_does("RETURN")
def _return(m: Machine, t: Task) -> None:
    t.pc = t.calls.pop()


@_does("END")
def _end(m: Machine, t: Task) -> Result:
    m.robot.off()
    m.status = DONE
    t.pc = m.at
    return True


def _compare_and_branch(name: str, compare: Callable[[int, int], bool]) -> None:
    """Make the six handlers that go on where `compare` is TRUE, and else to their target."""

    def variable(m: Machine, t: Task, v: int, n: int, to: int) -> None:
        if not compare(t.variables[v], n * ONE):
            t.pc = to

    def sensor(m: Machine, t: Task, s: int, n: int, to: int) -> None:
        if not compare(t.readings[s], n * ONE):
            t.pc = to

    def read(m: Machine, t: Task, s: int, n: int, to: int) -> Result:
        if _read(m, t, s):
            return True
        sensor(m, t, s, n, to)
        return None

    for bits in ("8", "16"):
        _HANDLERS[f"IF_VAR{bits}_{name}"] = variable
        _HANDLERS[f"IF_SENSOR{bits}_{name}"] = sensor
        _HANDLERS[f"IF_READ{bits}_{name}"] = read


for _name, _comparison in _COMPARE.items():
    _compare_and_branch(_name, _comparison)

_missing = [op.name for op in OPS if op.name not in _HANDLERS]
assert not _missing, f"no handler for {_missing}"
