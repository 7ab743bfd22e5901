"""Runs a TiniScript program straight from its text and tells what a robot does.

The interpreter shares nothing with the compiler and the bytecode machine, so that the tests can
ask both and compare. It follows the language reference as literally as it can and prefers plain
code to fast code. Numbers are Python integers that count thousandths; yes/no values are bools.
"""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from tests.oracle.text import Parser
from tests.oracle.tree import Do, Expression, If, Loop, Program, Statement, Value, While
from tests.oracle.words import COMPARATORS, HIGHEST, LOWEST, MOVES, PAPER_KIT, Device, Kit, Mistake

__all__ = ["PAPER_KIT", "Device", "Kit", "Mistake", "run"]


# --- Arithmetic -------------------------------------------------------------------------------


class Ending(Exception):
    """The run is over: FAULT …, or LIMIT."""


class Break(Exception):
    """BREAK, on its way to the loop that it leaves."""


def divided(value: int, divisor: int) -> int:
    """The quotient rounded to a whole number, half away from zero."""
    size = (2 * abs(value) + abs(divisor)) // (2 * abs(divisor))
    return size if (value < 0) == (divisor < 0) else -size


def whole(value: int) -> int:
    """Thousandths rounded to a whole number; this never faults."""
    return divided(value, 1000)


def limited(value: int, low: int, high: int) -> int:
    """The nearest value in the range."""
    return max(low, min(high, value))


def in_range(value: int) -> int:
    """The same value, or the fault."""
    if not LOWEST <= value <= HIGHEST:
        raise Ending("FAULT OVERFLOW")
    return value


def rounded(value: int, decimals: int) -> int:
    """ROUND: decimals is a whole number here; 3 or more change nothing, below 0 is tens."""
    if decimals >= 3:
        return value
    unit = int(10 ** (3 - max(decimals, -10)))  # beyond -10 everything is 0
    return divided(value, unit) * unit


def written(value: Value) -> str:
    """A value as the run prints it."""
    if isinstance(value, bool):
        return "TRUE" if value else "FALSE"
    sign = "-" if value < 0 else ""
    return (f"{sign}{abs(value) // 1000}.{abs(value) % 1000:03}").rstrip("0").rstrip(".")


# --- Runs -------------------------------------------------------------------------------------


@dataclass
class Robot:
    """A robot on a clock that only moves, waits and beeps move."""

    program: Program
    kit: Kit
    sensors: Mapping[str, Sequence[int]]
    max_time: int
    max_steps: int
    state: int
    now: int = 0
    steps: int = 0
    trace: list[str] = field(default_factory=list)
    variables: dict[str, Value] = field(default_factory=dict)
    kept: dict[str, Value] = field(default_factory=dict)
    taken: dict[str, int] = field(default_factory=dict)  # how many readings so far

    def run(self) -> None:
        """Runs the program to its end."""
        for name, is_yes_no in self.program.variables.items():
            self.variables[name] = False if is_yes_no else 0
        try:
            self.block(self.program.main)
            self.note("DONE")
        except Ending as ending:
            self.note(str(ending))

    def note(self, what: str) -> None:
        """Prints a line with the time."""
        self.trace.append(f"{self.now} {what}\n")

    def step(self) -> None:
        """Counts something that could go on without any time passing."""
        self.steps += 1
        if self.steps > self.max_steps:
            raise Ending("LIMIT")

    def wait(self, duration: int) -> None:
        """Lets time pass; a wait that would pass the end of the run is cut there."""
        if self.now + duration > self.max_time:
            self.now = self.max_time
            raise Ending("LIMIT")
        self.now += duration
        if duration:
            self.steps = 0

    def motors(self, left: int, right: int) -> None:
        """Sets both motors."""
        self.note(f"MOTORS {left} {right}")

    def read(self, names: Iterable[str]) -> None:
        """Takes a reading of each sensor and keeps it."""
        for name in names:
            device = next(device for device in self.kit.sensors if device.name == name)
            values = self.sensors.get(name) or (0,)
            count = self.taken.get(name, 0)
            self.taken[name] = count + 1
            raw = values[min(count, len(values) - 1)]
            self.kept[name] = bool(raw) if device.is_yes_no else raw
            self.note(f"READ {name} {written(self.kept[name])}")

    # Statements

    def block(self, body: list[Statement]) -> None:
        """Does instructions one after the other."""
        for statement in body:
            self.step()
            if isinstance(statement, Do):
                self.do(statement)
            elif isinstance(statement, If):
                self.choose(statement)
            else:
                with contextlib.suppress(Break):
                    self.repeat(statement)

    def choose(self, statement: If) -> None:
        """Does the first arm whose condition holds."""
        for arm in statement.arms:
            self.read(arm.reads)
            if arm.condition is None or self.value(arm.condition):
                self.block(arm.body)
                return

    def repeat(self, statement: Loop | While) -> None:
        """Repeats a body; LOOP evaluates its count once, WHILE checks before every turn."""
        if isinstance(statement, While):
            while True:
                self.step()
                self.read(statement.reads)
                if not self.value(statement.condition):
                    return
                self.block(statement.body)
        self.read(statement.reads)
        turns = None if statement.count is None else whole(self.value(statement.count))
        while turns is None or turns > 0:
            self.step()
            self.block(statement.body)
            turns = None if turns is None else turns - 1

    def do(self, statement: Do) -> None:
        """Does an instruction that has no body."""
        word = statement.word
        self.read(statement.reads)
        values = self.values(statement)
        if word in (*MOVES, "W"):
            self.move(statement, values)
            return
        if word == "S":
            self.motors(0, 0)
        elif word == "READ":
            self.read((statement.name,))
        elif word == "CALL":
            self.block(self.program.defs[statement.name])
        elif word == "BREAK":
            raise Break
        elif word == "M":
            left, right = (limited(whole(v or 0), -100, 100) for v in values)
            self.motors(left, right)
        elif word == "BEEP":
            duration, hertz = max(0, values[0] or 0), limited(whole(values[1] or 0), 31, 20_000)
            self.note(f"BEEP {hertz} {duration}")
            self.wait(duration)
        else:
            (value,) = values
            assert value is not None
            if word == "=":
                self.variables[statement.name] = value
            elif word == "SHOW":
                self.note(f"SHOW {written(value)}")
            else:
                self.set(statement.name, value)

    def values(self, statement: Do) -> list[Value | None]:
        """The values of an instruction; a way becomes the time that it takes."""
        values = [None if each is None else self.value(each) for each in statement.arguments]
        if statement.unit:
            way, power = max(0, values[0] or 0), limited(whole(values[1] or 0), 0, 100)
            speed = self.kit.speed if statement.unit == "CM" else self.kit.turn
            if way > 0 and power == 0:
                raise Ending("FAULT NO_POWER")
            values[0] = in_range(divided(1000 * way * 100, speed * power)) if way > 0 else 0
        return values

    def set(self, name: str, value: Value) -> None:
        """Sets an actuator: a number is rounded, then limited to the actuator's range."""
        device = next(device for device in self.kit.actuators if device.name == name)
        if not device.is_yes_no:
            value = limited(1000 * whole(value), device.low, device.high)
        self.note(f"SET {name} {written(value)}")

    def move(self, statement: Do, values: list[Value | None]) -> None:
        """F B L R W. UNTIL is checked before, and then every 20 ms while time is left."""
        left = values[0] if values[0] is None else max(0, values[0])
        if self.may_end(statement):
            return  # the motors are not touched
        if statement.word != "W":
            power = limited(whole(values[1] or 0), 0, 100)
            sides = {"F": (1, 1), "B": (-1, -1), "L": (-1, 1), "R": (1, -1)}[statement.word]
            self.motors(sides[0] * power, sides[1] * power)
        if statement.until is None:
            assert left is not None
            self.wait(left)
        else:
            while left is None or left > 0:
                pause = 20 if left is None else min(20, left)
                self.wait(pause)
                left = None if left is None else left - pause
                if left != 0 and self.may_end(statement):
                    break
        if statement.word != "W":
            self.motors(0, 0)

    def may_end(self, statement: Do) -> bool:
        """Takes the readings of an UNTIL, if there is one, and checks it."""
        if statement.until is None:
            return False
        self.step()
        self.read(statement.until_reads)
        return bool(self.value(statement.until))

    # Values

    def value(self, expression: Expression) -> Value:
        """The value of an expression: operands once each, from left to right."""
        operator = expression.operator
        if operator in ("NUMBER", "TRUTH"):
            return expression.value
        if operator == "VARIABLE":
            return self.variables[expression.name]
        if operator == "SENSOR":
            return self.kept[expression.name]
        if operator == "TIME":
            return in_range(self.now)
        first = self.value(expression.parts[0])
        if operator == "NOT":
            return not first
        if operator == "MINUS":
            return in_range(-first)
        if operator == "ABS":
            return in_range(abs(first))
        if (operator == "AND" and not first) or (operator == "OR" and first):
            return first  # the right side is not evaluated
        second = self.value(expression.parts[1])
        if operator in ("AND", "OR"):
            return second
        if operator in COMPARATORS:
            return {
                "=": first == second,
                "<>": first != second,
                "<": first < second,
                ">": first > second,
                "<=": first <= second,
                ">=": first >= second,
            }[operator]
        if operator in ("/", "%") and second == 0:
            raise Ending("FAULT DIVIDE_BY_ZERO")
        return in_range(self.calculated(operator, first, second))

    def calculated(self, operator: str, first: int, second: int) -> int:
        """A result of two numbers, perhaps out of range."""
        if operator == "+":
            return first + second
        if operator == "-":
            return first - second
        if operator == "*":
            return divided(first * second, 1000)
        if operator == "/":
            return divided(first * 1000, second)
        if operator == "%":
            return first % second  # Python's % is exact and takes the sign of the divisor too
        if operator == "MIN":
            return min(first, second)
        if operator == "MAX":
            return max(first, second)
        if operator == "ROUND":
            return rounded(first, whole(second))
        assert operator == "RANDOM"
        low, high = sorted((whole(first), whole(second)))
        return 1000 * (low + self.random() % (high - low + 1))

    def random(self) -> int:
        """One step of xorshift32."""
        self.state ^= self.state << 13 & 0xFFFFFFFF
        self.state ^= self.state >> 17
        self.state ^= self.state << 5 & 0xFFFFFFFF
        return self.state


_NO_SENSES: Mapping[str, Sequence[int]] = {}


def run(
    text: str,
    kit: Kit = PAPER_KIT,
    sensors: Mapping[str, Sequence[int]] = _NO_SENSES,
    max_time_ms: int = 60_000,
    max_steps: int = 10_000_000,
    seed: int = 1,
) -> str:
    """Runs a program and returns all that the run prints; raises Mistake if it is wrong.

    Readings are in thousandths, 0 or 1 for yes/no. Wrong use is a ValueError.
    """
    ranges = {device.name: (device.low, device.high) for device in kit.sensors}
    for name, values in sensors.items():
        if name not in ranges:
            raise ValueError(f"no sensor {name}")
        if any(not ranges[name][0] <= value <= ranges[name][1] for value in values):
            raise ValueError(f"a reading of {name} is out of its range")
    if not 1 <= seed <= 0xFFFFFFFF:
        raise ValueError("the seed is out of range")
    sys.setrecursionlimit(max(sys.getrecursionlimit(), 10_000))
    program = Parser(text, kit).program()
    robot = Robot(program, kit, sensors, max_time_ms, max_steps, seed)
    if program.tasks:
        from tests.oracle.tasks import TaskRobot  # it is made of this one

        robot = TaskRobot(program, kit, sensors, max_time_ms, max_steps, seed)
    robot.run()
    return "".join(robot.trace)
