"""The handlers of instructions that use the robot, or wait."""

from __future__ import annotations

from tiniscript.base.fixed_point import ONE, clamp, whole
from tiniscript.bytecode.opcodes import time8_ms
from tiniscript.vm.handlers import HANDLERS, Handler, Step, handles
from tiniscript.vm.state import FOREVER, PAUSE, Execution, Powers
from tiniscript.vm.values import COMPARE, Compare


def _duration(time: int) -> int:
    """Return milliseconds: a time in thousandths of a second, not below 0."""
    return max(time, 0)


def _percent(power: int, low: int) -> int:
    return clamp(whole(power), low, 100)


@handles("SHOW")
def _show(m: Execution, after: int) -> Step:
    return lambda: m.show(m.task.stack[-1], False, after)


@handles("SHOW_YES_NO")
def _show_yes_no(m: Execution, after: int) -> Step:
    return lambda: m.show(1 if m.task.stack[-1] else 0, True, after)


@handles("SET")
def _set(m: Execution, after: int, a: int) -> Step:
    def step() -> int:
        m.robot.set(a, m.task.stack.pop())
        return after

    return step


def _moves(direction: str, left: int, right: int) -> None:
    """Make the handlers of the four instructions that drive in one direction."""

    def powers(power: int) -> Powers:
        return left * power, right * power

    def popped_powers(m: Execution) -> Powers:
        return powers(_percent(m.task.stack.pop(), 0))

    def move8(m: Execution, after: int, time: int, power: int) -> Step:
        return lambda: m.drive(time8_ms(time), powers(power), after)

    def move(m: Execution, after: int) -> Step:
        def step() -> int:
            move_powers = popped_powers(m)
            return m.drive(_duration(m.task.stack.pop()), move_powers, after)

        return step

    def watch(m: Execution, after: int) -> Step:
        def step() -> int:
            move_powers = popped_powers(m)
            return m.watch(_duration(m.task.stack.pop()), move_powers, after)

        return step

    def watch_forever(m: Execution, after: int) -> Step:
        return lambda: m.watch(FOREVER, popped_powers(m), after)

    def extent_move(m: Execution) -> tuple[int, Powers]:
        power = _percent(m.task.stack.pop(), 0)
        return m.robot.go_ms(m.task.stack.pop(), power, left != right), powers(power)

    def go(m: Execution, after: int) -> Step:
        return lambda: m.drive(*extent_move(m), after)

    def watch_go(m: Execution, after: int) -> Step:
        return lambda: m.watch(*extent_move(m), after)

    HANDLERS[f"GO_{direction}"] = go
    HANDLERS[f"WATCH_GO_{direction}"] = watch_go
    HANDLERS[f"MOVE8_{direction}"] = move8
    HANDLERS[f"MOVE_{direction}"] = move
    HANDLERS[f"WATCH_{direction}"] = watch
    HANDLERS[f"WATCH_FOREVER_{direction}"] = watch_forever


_moves("F", 1, 1)
_moves("B", -1, -1)
_moves("L", -1, 1)
_moves("R", 1, -1)


@handles("WAIT")
def _wait(m: Execution, after: int) -> Step:
    return lambda: m.wait(_duration(m.task.stack.pop()), PAUSE, after)


@handles("WAIT8")
def _wait8(m: Execution, after: int, time: int) -> Step:
    return lambda: m.wait(time8_ms(time), PAUSE, after)


@handles("WATCH_WAIT")
def _watch_wait(m: Execution, after: int) -> Step:
    return lambda: m.watch(_duration(m.task.stack.pop()), None, after)


@handles("WATCH_FOREVER_WAIT")
def _watch_forever_wait(m: Execution, after: int) -> Step:
    return lambda: m.watch(FOREVER, None, after)


@handles("UNTIL")
def _until(m: Execution, after: int) -> Step:
    return lambda: m.until(bool(m.task.stack.pop()), after)


def _until_comparison_handler(compare: Compare) -> Handler:
    def handler(m: Execution, after: int, n: int) -> Step:
        return lambda: m.until(compare(m.task.stack.pop(), n * ONE), after)

    return handler


for _name, _compare in COMPARE.items():
    HANDLERS[f"UNTIL8_{_name}"] = HANDLERS[f"UNTIL16_{_name}"] = _until_comparison_handler(_compare)


@handles("STOP")
def _stop(m: Execution, after: int) -> Step:
    def step() -> int:
        m.stop_motors()
        return after

    return step


@handles("MOTORS")
def _motors(m: Execution, after: int) -> Step:
    def step() -> int:
        right, left = m.task.stack.pop(), m.task.stack.pop()
        m.motors(_percent(left, -100), _percent(right, -100))
        return after

    return step


@handles("MOTORS8")
def _motors8(m: Execution, after: int, left: int, right: int) -> Step:
    def step() -> int:
        m.motors(left, right)
        return after

    return step


@handles("BEEP")
def _beep(m: Execution, after: int) -> Step:
    def step() -> int:
        hertz, time = m.task.stack.pop(), m.task.stack.pop()
        return _sound(m, after, whole(hertz), _duration(time))

    return step


@handles("BEEP8")
def _beep8(m: Execution, after: int, time: int, hertz: int) -> Step:
    return lambda: _sound(m, after, hertz, time8_ms(time))


def _sound(m: Execution, after: int, hertz: int, duration_ms: int) -> int:
    m.robot.beep(clamp(hertz, 31, 20_000), duration_ms)
    return m.wait(duration_ms, PAUSE, after)
