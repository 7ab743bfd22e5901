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

from tests.oracle.arithmetic import (
    Fault,
    answer,
    calculated,
    divided,
    fits,
    printed,
    random_between,
    stepped,
    whole,
    within,
)
from tests.oracle.text import Parser
from tests.oracle.tree import Do, Expression, If, Loop, Program, Statement, Value, While
from tests.oracle.words import MOVES, PAPER_KIT, Device, Kit, Mistake

__all__ = ["PAPER_KIT", "Device", "Kit", "Mistake", "run"]


# What the words and signs of the language calculate.
NAMES = {
    "+": "ADD", "-": "SUB", "*": "MUL", "/": "DIV", "%": "MOD", "MINUS": "NEG",
    "=": "EQ", "<>": "NE", "<": "LT", ">": "GT", "<=": "LE", ">=": "GE",
    **{word: word for word in ("ABS", "MIN", "MAX", "ROUND", "AND", "OR", "NOT")},
}  # fmt: skip


class Ending(Exception):
    """The run is over: LIMIT."""


class Break(Exception):
    """BREAK, on its way to the loop that it leaves."""


def written(value: Value) -> str:
    """A value as the run prints it."""
    return answer(value) if isinstance(value, bool) else printed(value)


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
        for name, is_yes_no in self.program.variables.items():
            self.variables[name] = False if is_yes_no else 0
        try:
            self.play()
            self.note("DONE")
        except Fault as fault:
            self.note(f"FAULT {fault}")
        except Ending as ending:
            self.note(str(ending))

    def play(self) -> None:
        self.block(self.program.main)

    def note(self, what: str) -> None:
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
            left, right = (within(whole(v or 0), -100, 100) for v in values)
            self.motors(left, right)
        elif word == "BEEP":
            duration, hertz = max(0, values[0] or 0), within(whole(values[1] or 0), 31, 20_000)
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
            way, power = max(0, values[0] or 0), within(whole(values[1] or 0), 0, 100)
            speed = self.kit.speed if statement.unit == "CM" else self.kit.turn
            if way > 0 and power == 0:
                raise Fault("NO_POWER")
            values[0] = fits(divided(1000 * way * 100, speed * power)) if way > 0 else 0
        return values

    def set(self, name: str, value: Value) -> None:
        """Sets an actuator: a number is rounded, then limited to the actuator's range."""
        device = next(device for device in self.kit.actuators if device.name == name)
        if not device.is_yes_no:
            value = within(1000 * whole(value), device.low, device.high)
        self.note(f"SET {name} {written(value)}")

    def move(self, statement: Do, values: list[Value | None]) -> None:
        """F B L R W. UNTIL is checked before, and then every 20 ms while time is left."""
        left = values[0] if values[0] is None else max(0, values[0])
        if self.may_end(statement):
            return  # the motors are not touched
        if statement.word != "W":
            power = within(whole(values[1] or 0), 0, 100)
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
            return fits(self.now)
        first = self.value(expression.parts[0])
        if (operator == "AND" and not first) or (operator == "OR" and first):
            return first  # the right side is not evaluated
        values = [first, *map(self.value, expression.parts[1:])]
        if operator == "RANDOM":
            self.state = stepped(self.state)
            return random_between(values[0], values[1], self.state)
        found = calculated(NAMES[operator], *values)
        return bool(found) if expression.is_yes_no else found


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
