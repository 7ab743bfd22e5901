"""A second machine for the bytecode, written from the words of `bytecode_spec.md` alone.

It shares nothing with the package: opcodes and operands come from the tables of the page. It runs
verified code without tasks on the clock of a trace, plainly and slowly. The abilities of a robot
come in as the kit of the interpreter next to it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from tests.oracle.arithmetic import (
    COMPARISONS,
    WRAP,
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
    time8,
)
from tests.oracle.spec_tables import Instruction, decode
from tests.oracle.words import ACTS, TIME, Device, Kit

TOO_MANY = "TOO MANY STEPS"  # the last line of a run without a result

WAYS = {"F": (1, 1), "B": (-1, -1), "L": (-1, 1), "R": (1, -1)}


def always_ready(sensor: int, passed_ms: int) -> bool:
    return False


class Over(Exception):
    """The time of the run is over."""


@dataclass
class Watched:
    """The move or wait of an UNTIL."""

    powers: tuple[int, int] | None
    time: int | None  # None: forever
    check: int
    has_begun: bool = False


@dataclass
class Run:
    """A program that runs, and its robot."""

    code: bytes
    kit: Kit
    readings: Mapping[str, Sequence[int]]
    max_ms: int
    random: int
    max_steps: int
    late: Callable[[int, int], int]  # delay of the call; see `trace`
    begin_ms: int = 0
    is_slow: Callable[[int, int], bool] = always_ready
    waited: int = 0  # number of waits
    lines: list[str] = field(default_factory=list)
    taken: dict[int, int] = field(default_factory=dict)
    passed: int = 0  # time since the start; `now` without wrapping around
    pc: int = 0
    stack: list[int] = field(default_factory=list)
    variables: list[int] = field(default_factory=lambda: [0] * 32)
    kept: dict[int, int] = field(default_factory=dict)
    counters: list[int] = field(default_factory=list)
    calls: list[int] = field(default_factory=list)
    clock: int = 0
    waits: str = ""  # "MOVE": the motors go off at its end
    watched: Watched = field(default_factory=lambda: Watched(None, None, 0))

    @property
    def now(self) -> int:
        """The time that instructions see."""
        return (self.begin_ms + self.passed) % WRAP

    def note(self, event: str) -> None:
        self.lines.append(f"{self.passed} {event}\n")

    def run(self) -> None:
        steps = 0
        try:
            while self.pc < len(self.code):
                steps += 1
                if steps > self.max_steps:
                    self.note(TOO_MANY)
                    return
                self.step()
                if self.waits:
                    self.wait_for_the_clock()
            self.note("DONE")
        except Fault as fault:
            self.note(f"FAULT {fault}")
        except Over:
            self.passed = self.max_ms
            self.note("LIMIT")

    def wait_for_the_clock(self) -> None:
        """Advance time to the clock, unless the run's time is over."""
        passes = (self.clock - self.now) % WRAP
        if passes >= WRAP // 2:  # the clock was reached before
            passes = 0
        self.wait_to(self.passed + passes)
        if self.waits == "MOVE":
            self.motors((0, 0))
        self.waits = ""

    def wait_to(self, reached: int) -> None:
        """Advance time to the first call at or after `reached`."""
        self.waited += 1
        reached += self.late(self.waited, reached)
        if reached > self.max_ms:
            raise Over
        self.passed = reached

    def step(self) -> None:
        row, operands, next_pc, to = decode(self.code, self.pc)
        self.pc = next_pc
        self.do(row, row.stem, operands, to)

    def do(self, row: Instruction, name: str, operands: Sequence[int], to: int) -> None:
        """Execute an instruction; short and far forms act like the others."""
        popped_values = [self.stack.pop() for _ in range(row.takes)][::-1]
        family, _, suffix = name.rpartition("_")
        if family in ("IF8", "IF16", "UNTIL8", "UNTIL16", "IF_VAR8", "IF_VAR16"):
            *first, constant = operands[: 2 if family.startswith("IF_VAR") else 1]
            value = self.variables[first[0]] if first else popped_values[0]
            is_true = COMPARISONS[suffix](value, 1000 * constant)
            if family.startswith("UNTIL"):
                self.until(is_true)
            elif not is_true:
                self.pc = to
        elif suffix in WAYS:
            if "GO" in family:
                popped_values[0] = self.way(
                    popped_values[0],
                    nearest_in_range(nearest_whole(popped_values[1]), 0, 100),
                    suffix in "LR",
                )
            self.drive(family, WAYS[suffix], popped_values, operands)
        elif name in ("WATCH_WAIT", "WATCH_FOREVER_WAIT"):
            self.watch(None, max(popped_values[0], 0) if popped_values else None)
        elif row.role == "value":
            self.stack.append(self.value(name, popped_values, operands))
        else:
            self.other(name, popped_values, operands, to)

    def value(self, name: str, popped_values: list[int], operands: Sequence[int]) -> int:
        """Return the result of an instruction in an expression."""
        match name:
            case "PUSH8" | "PUSH16" | "PUSH_NUM":
                return 1000 * operands[0]
            case "PUSH_TENTHS":
                return 100 * operands[0]
            case "PUSH_MILLI" | "PUSH32":
                return operands[0]
            case "PUSH_FALSE" | "PUSH_TRUE":
                return int(name == "PUSH_TRUE")
            case "PUSH_VAR":
                return self.variables[operands[0]]
            case "PUSH_SENSOR":
                return self.kept.get(operands[0], 0)
            case "PUSH_READ":
                return self.read(operands[0])
            case "TIME":
                return result_or_fault(self.passed)
            case "RANDOM":
                self.random = next_state(self.random)
                return random_between(popped_values[0], popped_values[1], self.random)
            case _:
                return calculate(name, *popped_values)

    def other(self, name: str, popped_values: list[int], operands: Sequence[int], to: int) -> None:
        """Instructions that are no part of an expression, and joins."""
        match name:
            case "AND_THEN" | "OR_ELSE":
                if (popped_values[0] != 0) == (name == "OR_ELSE"):
                    self.stack.append(popped_values[0])
                    self.pc = to
            case "SET_VAR":
                self.variables[operands[0]] = popped_values[0]
            case "SET_VAR8":
                self.variables[operands[0]] = 1000 * operands[1]
            case "ADD_VAR8" | "ADD_VAR" | "INC_VAR" | "DEC_VAR":
                by = {"INC_VAR": 1000, "DEC_VAR": -1000, "ADD_VAR8": 1000 * operands[-1]}
                operand = by[name] if name in by else self.variables[operands[1]]
                self.variables[operands[0]] = result_or_fault(self.variables[operands[0]] + operand)
            case "READ":
                self.read(operands[0])
            case "SHOW" | "SHOW_YES_NO":
                write = print_number if name == "SHOW" else answer
                self.note(f"SHOW {write(popped_values[0])}")
            case "SET":
                self.set(self.kit.actuators[operands[0]], popped_values[0])
            case "WAIT" | "WAIT8":
                self.wait(time8(operands[0]) if operands else max(popped_values[0], 0), "PAUSE")
            case "UNTIL":
                self.until(popped_values[0] != 0)
            case "STOP":
                self.motors((0, 0))
            case "MOTORS" | "MOTORS8":
                left, right = operands or (
                    nearest_in_range(nearest_whole(value), -100, 100) for value in popped_values
                )
                self.motors((left, right))
            case _ if name.removesuffix("8") in ACTS:
                act = ACTS[name.removesuffix("8")]
                operands_and_ranges = zip(operands, act.ranges, strict=not popped_values)
                values = [
                    time8(value) if operand_kind == TIME else 1000 * value
                    for value, operand_kind in operands_and_ranges
                ]
                act_values = act.values(popped_values or values)
                self.note(act.note.format(*act_values))
                if act.waits:
                    self.wait(act_values[0], "PAUSE")
            case _:
                self.control(name, popped_values, operands, to)

    def control(
        self, name: str, popped_values: list[int], operands: Sequence[int], to: int
    ) -> None:
        match name:
            case "FOREVER" | "WHILE":
                pass
            case "IF" | "IF_NOT":
                if (popped_values[0] != 0) == (name == "IF_NOT"):
                    self.pc = to
            case "LOOP8" | "LOOP":
                times = nearest_whole(popped_values[0]) if popped_values else operands[0]
                if times < 1:
                    self.pc = to
                else:
                    self.counters.append(times)
            case "NEXT":
                count_left = self.counters.pop() - 1
                if count_left:
                    self.counters.append(count_left)
                    self.pc = to
            case "BREAK_LOOP":
                self.counters.pop()
                self.pc = to
            case "CALL":
                self.calls.append(self.pc)
                self.pc = to
            case "RETURN":
                self.pc = self.calls.pop()
            case "ELSE" | "AGAIN" | "BREAK" | "DEF":
                self.pc = to
            case _:
                raise AssertionError(f"the page does not say what {name} does")

    # The robot

    def motors(self, powers: tuple[int, int]) -> None:
        self.note(f"MOTORS {powers[0]} {powers[1]}")

    def read(self, number: int) -> int:
        while self.is_slow(number, self.passed):  # no part of the instruction has been done
            self.wait_to(self.passed + 1)
        sensor = self.kit.readings[number]
        values = self.readings.get(sensor.name) or (0,)
        count = self.taken.get(number, 0)
        self.taken[number] = count + 1
        value = values[min(count, len(values) - 1)]
        self.kept[number] = value
        self.note(
            f"READ {sensor.name} {answer(value) if sensor.is_yes_no else print_number(value)}"
        )
        return value

    def set(self, actuator: Device, value: int) -> None:
        rounded_value = nearest_in_range(1000 * nearest_whole(value), actuator.low, actuator.high)
        text = answer(value) if actuator.is_yes_no else print_number(rounded_value)
        self.note(f"SET {actuator.name} {text}")

    # Time

    def begin(self) -> None:
        """Begin at the clock, or now if the clock is more than 20 ms late."""
        if (self.now - self.clock) % WRAP > 20:
            self.clock = self.now

    def wait(self, duration: int, condition: str) -> None:
        self.begin()
        self.clock = (self.clock + duration) % WRAP
        self.waits = condition

    def drive(
        self, family: str, way: tuple[int, int], popped_values: list[int], operands: Sequence[int]
    ) -> None:
        """MOVE and WATCH in one of the four directions."""
        power = (
            operands[-1] if operands else nearest_in_range(nearest_whole(popped_values[-1]), 0, 100)
        )
        powers = way[0] * power, way[1] * power
        time = None
        if "FOREVER" not in family:
            time = time8(operands[0]) if operands else max(popped_values[0], 0)
        if family.startswith("WATCH"):
            self.watch(powers, time)
        else:
            assert time is not None
            self.motors(powers)
            self.wait(time, "MOVE")

    def way(self, way: int, power: int, is_turn: bool) -> int:
        """Return the duration of a move by distance, in milliseconds."""
        if way <= 0:
            return 0
        per_second = (self.kit.turn if is_turn else self.kit.speed) * power
        if per_second == 0:
            raise Fault("NO_POWER")
        return result_or_fault(divide(100_000 * way, per_second))

    def watch(self, powers: tuple[int, int] | None, time: int | None) -> None:
        """Keep a prepared move; its check begins after the instruction."""
        self.watched = Watched(powers, time, self.pc)

    def until(self, is_stopped: bool) -> None:
        """Steps 1 to 3."""
        move = self.watched
        if is_stopped:
            if move.has_begun:
                self.clock = self.now
                if move.powers is not None:
                    self.motors((0, 0))
            return
        if not move.has_begun:
            self.begin()
            move.has_begun = True
            if move.powers is not None:
                self.motors(move.powers)
        following = ((self.now - self.clock) % WRAP // 20 + 1) * 20
        if move.time is not None and move.time <= following:
            self.clock = (self.clock + move.time) % WRAP
            self.waits = "PAUSE" if move.powers is None else "MOVE"
        else:
            self.clock = (self.clock + following) % WRAP
            if move.time is not None:
                move.time -= following
            self.waits = "PAUSE"
            self.pc = move.check


def trace(
    code: bytes,
    kit: Kit,
    readings: Mapping[str, Sequence[int]],
    max_ms: int = 60_000,
    seed: int = 1,
    max_steps: int = 10_000,
    late_ms: Callable[[int, int], int] = lambda waited_ms, reached: 0,
    begin_ms: int = 0,
    is_slow: Callable[[int, int], bool] = always_ready,
) -> str:
    """Return the trace of a run of verified code; at most `max_steps` instructions run.

    On a robot that is `late`, the call after each wait comes some milliseconds after the clock: it
    is given which wait it is, from 1, and when the clock is reached. `is_slow` says whether a
    sensor is not ready so long after the start.
    """
    run = Run(
        code, kit, readings, max_ms, seed, max_steps, late_ms, begin_ms, is_slow, clock=begin_ms
    )
    run.run()
    return "".join(run.lines)
