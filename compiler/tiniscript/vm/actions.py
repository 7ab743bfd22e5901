"""The handlers of instructions that use the robot, or wait."""

from __future__ import annotations

from tiniscript.base.fixed_point import ONE, clamp, round_to_whole
from tiniscript.bytecode.opcodes import time8_ms
from tiniscript.vm.handlers import HANDLERS, Handler, Step, handles
from tiniscript.vm.state import FOREVER, PAUSE, Drive, Powers
from tiniscript.vm.values import COMPARISONS, Compare


def _duration(time_milli: int) -> int:
    """Return milliseconds: a time in thousandths of a second, not below 0."""
    return max(time_milli, 0)


def _percent(power: int, least_power: int) -> int:
    return clamp(round_to_whole(power), least_power, 100)


@handles("SHOW")
def _show(machine: Drive, next_pc: int) -> Step:
    return lambda: machine.show(machine.task.stack[-1], False, next_pc)


@handles("SHOW_YES_NO")
def _show_yes_no(machine: Drive, next_pc: int) -> Step:
    return lambda: machine.show(1 if machine.task.stack[-1] else 0, True, next_pc)


@handles("SET")
def _set(machine: Drive, next_pc: int, actuator: int) -> Step:
    def step() -> int:
        machine.robot.set(actuator, machine.task.stack.pop())
        return next_pc

    return step


def _add_move_handlers(direction: str, left: int, right: int) -> None:
    """Make the handlers of the four instructions that drive in one direction."""

    def powers(power: int) -> Powers:
        return left * power, right * power

    def pop_powers(machine: Drive) -> Powers:
        return powers(_percent(machine.task.stack.pop(), 0))

    def move8(machine: Drive, next_pc: int, time8: int, power: int) -> Step:
        return lambda: machine.drive(time8_ms(time8), powers(power), next_pc)

    def move(machine: Drive, next_pc: int) -> Step:
        def step() -> int:
            move_powers = pop_powers(machine)
            return machine.drive(_duration(machine.task.stack.pop()), move_powers, next_pc)

        return step

    def watch(machine: Drive, next_pc: int) -> Step:
        def step() -> int:
            move_powers = pop_powers(machine)
            return machine.watch(_duration(machine.task.stack.pop()), move_powers, next_pc)

        return step

    def watch_forever(machine: Drive, next_pc: int) -> Step:
        return lambda: machine.watch(FOREVER, pop_powers(machine), next_pc)

    def pop_extent_move(machine: Drive) -> tuple[int, Powers]:
        percent = _percent(machine.task.stack.pop(), 0)
        return machine.robot.go_ms(machine.task.stack.pop(), percent, left != right), powers(
            percent
        )

    def go(machine: Drive, next_pc: int) -> Step:
        return lambda: machine.drive(*pop_extent_move(machine), next_pc)

    def watch_go(machine: Drive, next_pc: int) -> Step:
        return lambda: machine.watch(*pop_extent_move(machine), next_pc)

    HANDLERS[f"GO_{direction}"] = go
    HANDLERS[f"WATCH_GO_{direction}"] = watch_go
    HANDLERS[f"MOVE8_{direction}"] = move8
    HANDLERS[f"MOVE_{direction}"] = move
    HANDLERS[f"WATCH_{direction}"] = watch
    HANDLERS[f"WATCH_FOREVER_{direction}"] = watch_forever


_add_move_handlers("F", 1, 1)
_add_move_handlers("B", -1, -1)
_add_move_handlers("L", -1, 1)
_add_move_handlers("R", 1, -1)


@handles("WAIT")
def _wait(machine: Drive, next_pc: int) -> Step:
    return lambda: machine.wait(_duration(machine.task.stack.pop()), PAUSE, next_pc)


@handles("WAIT8")
def _wait8(machine: Drive, next_pc: int, time8: int) -> Step:
    return lambda: machine.wait(time8_ms(time8), PAUSE, next_pc)


@handles("WATCH_WAIT")
def _watch_wait(machine: Drive, next_pc: int) -> Step:
    return lambda: machine.watch(_duration(machine.task.stack.pop()), None, next_pc)


@handles("WATCH_FOREVER_WAIT")
def _watch_forever_wait(machine: Drive, next_pc: int) -> Step:
    return lambda: machine.watch(FOREVER, None, next_pc)


@handles("UNTIL")
def _until(machine: Drive, next_pc: int) -> Step:
    return lambda: machine.until(bool(machine.task.stack.pop()), next_pc)


def _until_comparison_handler(compare: Compare) -> Handler:
    def handler(machine: Drive, next_pc: int, number: int) -> Step:
        return lambda: machine.until(compare(machine.task.stack.pop(), number * ONE), next_pc)

    return handler


for _name, _compare in COMPARISONS.items():
    HANDLERS[f"UNTIL8_{_name}"] = HANDLERS[f"UNTIL16_{_name}"] = _until_comparison_handler(_compare)


@handles("STOP")
def _stop(machine: Drive, next_pc: int) -> Step:
    def step() -> int:
        machine.stop_motors()
        return next_pc

    return step


@handles("MOTORS")
def _motors(machine: Drive, next_pc: int) -> Step:
    def step() -> int:
        right, left = machine.task.stack.pop(), machine.task.stack.pop()
        machine.motors(_percent(left, -100), _percent(right, -100))
        return next_pc

    return step


@handles("MOTORS8")
def _motors8(machine: Drive, next_pc: int, left: int, right: int) -> Step:
    def step() -> int:
        machine.motors(left, right)
        return next_pc

    return step


@handles("BEEP")
def _beep(machine: Drive, next_pc: int) -> Step:
    def step() -> int:
        hertz, time_milli = machine.task.stack.pop(), machine.task.stack.pop()
        return _sound(machine, next_pc, round_to_whole(hertz), _duration(time_milli))

    return step


@handles("BEEP8")
def _beep8(machine: Drive, next_pc: int, time8: int, hertz: int) -> Step:
    return lambda: _sound(machine, next_pc, hertz, time8_ms(time8))


def _sound(machine: Drive, next_pc: int, hertz: int, duration_ms: int) -> int:
    machine.robot.beep(clamp(hertz, 31, 20_000), duration_ms)
    return machine.wait(duration_ms, PAUSE, next_pc)
