"""The parts of a robot, and the immediate effects of instructions: readings, values, actuators, the
trace.

Numbers are Python integers that count thousandths; yes/no values are bools.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from tests.oracle.arithmetic import (
    Fault,
    answer,
    calculate,
    divide,
    nearest_in_range,
    nearest_whole,
    next_state,
    print_number,
    random_between,
    result_or_fault,
)
from tests.oracle.ast import Do, Expression, Program, Value
from tests.oracle.words import Kit

# The operations of the language's words and signs.
NAMES = {
    "+": "ADD", "-": "SUB", "*": "MUL", "/": "DIV", "%": "MOD", "MINUS": "NEG",
    "=": "EQ", "<>": "NE", "<": "LT", ">": "GT", "<=": "LE", ">=": "GE",
    **{word: word for word in ("ABS", "MIN", "MAX", "ROUND", "AND", "OR", "NOT")},
}  # fmt: skip


class Ending(Exception):
    """The run is over: LIMIT."""


class Break(Exception):
    """BREAK, on its way to the loop that it leaves."""


def print_value(value: Value) -> str:
    """A value as the run prints it."""
    return answer(value) if isinstance(value, bool) else print_number(value)


# --- Runs -------------------------------------------------------------------------------------


@dataclass
class Robot:
    """A robot, its clock and its trace: all of it but how the instructions follow each other."""

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
    taken: dict[str, int] = field(default_factory=dict)  # number of readings so far, by sensor

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

    @property
    def own(self) -> dict[str, Value]:
        """The values of DEFs in the current task."""
        raise NotImplementedError

    def play(self) -> None:
        """Execute the program to its end."""
        raise NotImplementedError

    def note(self, event: str) -> None:
        self.trace.append(f"{self.now} {event}\n")

    def step(self) -> None:
        """Count a step that could repeat without any time passing."""
        self.steps += 1
        if self.steps > self.max_steps:
            raise Ending("LIMIT")

    def read(self, name: str) -> None:
        """Takes a reading of a sensor and keeps it."""
        device = next(device for device in self.kit.readings if device.name == name)
        values = self.sensors.get(name) or (0,)
        count = self.taken.get(name, 0)
        self.taken[name] = count + 1
        raw = values[min(count, len(values) - 1)]
        self.kept[name] = bool(raw) if device.is_yes_no else raw
        self.note(f"READ {name} {print_value(self.kept[name])}")

    # Statements

    def do(self, statement: Do) -> None:
        """Execute an instruction that takes no time and does not involve the motors.

        Its readings have been taken.
        """
        word, values = statement.word, self.values(statement)
        if word == "BREAK":
            raise Break
        else:
            (value,) = values
            assert value is not None
            if word == "=":
                (self.own if "." in statement.name else self.variables)[statement.name] = value
            elif word == "SHOW":
                self.note(f"SHOW {print_value(value)}")
            else:
                self.set(statement.name, value)

    def values(self, statement: Do) -> list[Value | None]:
        """The values of an instruction; a way becomes the time that it takes."""
        values = [
            None if argument is None else self.value(argument) for argument in statement.arguments
        ]
        if statement.unit:
            way, power = (
                max(0, values[0] or 0),
                nearest_in_range(nearest_whole(values[1] or 0), 0, 100),
            )
            speed = self.kit.speed if statement.unit == "CM" else self.kit.turn
            if way > 0 and power == 0:
                raise Fault("NO_POWER")
            values[0] = result_or_fault(divide(1000 * way * 100, speed * power)) if way > 0 else 0
        return values

    def set(self, name: str, value: Value) -> None:
        """Sets an actuator: a number is rounded, then limited to the actuator's range."""
        device = next(device for device in self.kit.actuators if device.name == name)
        if not device.is_yes_no:
            value = nearest_in_range(1000 * nearest_whole(value), device.low, device.high)
        self.note(f"SET {name} {print_value(value)}")

    # Values

    def value(self, expression: Expression) -> Value:
        """The value of an expression: operands once each, from left to right."""
        operator = expression.operator
        if operator in ("NUMBER", "TRUTH"):
            return expression.value
        if operator == "VARIABLE":
            return self.variables[expression.name]
        if operator == "OWN":
            return self.own[expression.name]
        if operator == "SENSOR":
            return self.kept[expression.name]
        if operator == "TIME":
            return result_or_fault(self.now)
        first = self.value(expression.parts[0])
        if (operator == "AND" and not first) or (operator == "OR" and first):
            return first  # the right side is not evaluated
        values = [first, *map(self.value, expression.parts[1:])]
        if operator == "RANDOM":
            self.state = next_state(self.state)
            return random_between(values[0], values[1], self.state)
        result = calculate(NAMES[operator], *values)
        return bool(result) if expression.is_yes_no else result
