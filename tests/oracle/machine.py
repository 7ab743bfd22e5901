"""A second machine for the bytecode, written from the words of `bytecode_spec.md` alone.

It shares nothing with the package: opcodes and operands come from the tables of the page. It runs
verified code without tasks on the clock of a trace, plainly and slowly. What a robot has comes in
as the kit of the interpreter beside it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from tests.oracle.arithmetic import (
    COMPARE,
    WRAP,
    Fault,
    answer,
    calculated,
    divided,
    fits,
    printed,
    random_between,
    stepped,
    time8,
    whole,
    within,
)
from tests.oracle.spec_tables import Instruction, decoded
from tests.oracle.words import ACTS, TIME, Device, Kit

TOO_MANY = "TOO MANY STEPS"  # the last line of a run that this machine gives up

WAYS = {"F": (1, 1), "B": (-1, -1), "L": (-1, 1), "R": (1, -1)}


def always_ready(sensor: int, passed: int) -> bool:
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
    late: Callable[[int, int], int]  # how much later the call comes: see `trace`
    begin_ms: int = 0
    is_slow: Callable[[int, int], bool] = always_ready
    waited: int = 0  # how many times
    lines: list[str] = field(default_factory=list)
    taken: dict[int, int] = field(default_factory=dict)
    passed: int = 0  # since the start; what `now` is without wrapping around
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

    def note(self, what: str) -> None:
        self.lines.append(f"{self.passed} {what}\n")

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
        """Let the time pass, unless that of the run is over before."""
        passes = (self.clock - self.now) % WRAP
        if passes >= WRAP // 2:  # the clock was reached before
            passes = 0
        self.wait_to(self.passed + passes)
        if self.waits == "MOVE":
            self.motors((0, 0))
        self.waits = ""

    def wait_to(self, reached: int) -> None:
        """Let the time pass to the next call that is not before `reached`."""
        self.waited += 1
        reached += self.late(self.waited, reached)
        if reached > self.max_ms:
            raise Over
        self.passed = reached

    def step(self) -> None:
        row, operands, after, to = decoded(self.code, self.pc)
        self.pc = after
        self.do(row, row.stem, operands, to)

    def do(self, row: Instruction, name: str, operands: Sequence[int], to: int) -> None:
        """What an instruction does; short and far forms do the same as the others."""
        taken = [self.stack.pop() for _ in range(row.takes)][::-1]
        family, _, last = name.rpartition("_")
        if family in ("IF8", "IF16", "UNTIL8", "UNTIL16", "IF_VAR8", "IF_VAR16"):
            *first, constant = operands[: 2 if family.startswith("IF_VAR") else 1]
            value = self.variables[first[0]] if first else taken[0]
            holds = COMPARE[last](value, 1000 * constant)
            if family.startswith("UNTIL"):
                self.until(holds)
            elif not holds:
                self.pc = to
        elif last in WAYS:
            if "GO" in family:
                taken[0] = self.way(taken[0], within(whole(taken[1]), 0, 100), last in "LR")
            self.drive(family, WAYS[last], taken, operands)
        elif name in ("WATCH_WAIT", "WATCH_FOREVER_WAIT"):
            self.watch(None, max(taken[0], 0) if taken else None)
        elif row.role == "value":
            self.stack.append(self.value(name, taken, operands))
        else:
            self.other(name, taken, operands, to)

    def value(self, name: str, taken: list[int], operands: Sequence[int]) -> int:
        """What an instruction leaves that is part of an expression."""
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
                return fits(self.passed)
            case "RANDOM":
                self.random = stepped(self.random)
                return random_between(taken[0], taken[1], self.random)
            case _:
                return calculated(name, *taken)

    def other(self, name: str, taken: list[int], operands: Sequence[int], to: int) -> None:
        """Instructions that are no part of an expression, and joins."""
        match name:
            case "AND_THEN" | "OR_ELSE":
                if (taken[0] != 0) == (name == "OR_ELSE"):
                    self.stack.append(taken[0])
                    self.pc = to
            case "SET_VAR":
                self.variables[operands[0]] = taken[0]
            case "SET_VAR8":
                self.variables[operands[0]] = 1000 * operands[1]
            case "ADD_VAR8" | "ADD_VAR" | "INC_VAR" | "DEC_VAR":
                by = {"INC_VAR": 1000, "DEC_VAR": -1000, "ADD_VAR8": 1000 * operands[-1]}
                more = by[name] if name in by else self.variables[operands[1]]
                self.variables[operands[0]] = fits(self.variables[operands[0]] + more)
            case "READ":
                self.read(operands[0])
            case "SHOW" | "SHOW_YES_NO":
                self.note(f"SHOW {printed(taken[0]) if name == 'SHOW' else answer(taken[0])}")
            case "SET":
                self.set(self.kit.actuators[operands[0]], taken[0])
            case "WAIT" | "WAIT8":
                self.wait(time8(operands[0]) if operands else max(taken[0], 0), "PAUSE")
            case "UNTIL":
                self.until(taken[0] != 0)
            case "STOP":
                self.motors((0, 0))
            case "MOTORS" | "MOTORS8":
                left, right = operands or (within(whole(value), -100, 100) for value in taken)
                self.motors((left, right))
            case _ if name.removesuffix("8") in ACTS:
                act = ACTS[name.removesuffix("8")]
                operands_and_ranges = zip(operands, act.ranges, strict=not taken)
                values = [
                    time8(value) if of == TIME else 1000 * value
                    for value, of in operands_and_ranges
                ]
                act_values = act.values(taken or values)
                self.note(act.note.format(*act_values))
                if act.waits:
                    self.wait(act_values[0], "PAUSE")
            case _:
                self.control(name, taken, operands, to)

    def control(self, name: str, taken: list[int], operands: Sequence[int], to: int) -> None:
        match name:
            case "FOREVER" | "WHILE":
                pass
            case "IF" | "IF_NOT":
                if (taken[0] != 0) == (name == "IF_NOT"):
                    self.pc = to
            case "LOOP8" | "LOOP":
                times = whole(taken[0]) if taken else operands[0]
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
        while self.is_slow(number, self.passed):  # nothing of the instruction has happened
            self.wait_to(self.passed + 1)
        sensor = self.kit.readings[number]
        values = self.readings.get(sensor.name) or (0,)
        count = self.taken.get(number, 0)
        self.taken[number] = count + 1
        value = values[min(count, len(values) - 1)]
        self.kept[number] = value
        self.note(f"READ {sensor.name} {answer(value) if sensor.is_yes_no else printed(value)}")
        return value

    def set(self, actuator: Device, value: int) -> None:
        rounded = within(1000 * whole(value), actuator.low, actuator.high)
        text = answer(value) if actuator.is_yes_no else printed(rounded)
        self.note(f"SET {actuator.name} {text}")

    # Time

    def begin(self) -> None:
        """At the clock, or now if that is more than 20 ms ago."""
        if (self.now - self.clock) % WRAP > 20:
            self.clock = self.now

    def wait(self, duration: int, what: str) -> None:
        self.begin()
        self.clock = (self.clock + duration) % WRAP
        self.waits = what

    def drive(
        self, family: str, way: tuple[int, int], taken: list[int], operands: Sequence[int]
    ) -> None:
        """MOVE and WATCH in one of the four directions."""
        power = operands[-1] if operands else within(whole(taken[-1]), 0, 100)
        powers = way[0] * power, way[1] * power
        time = None
        if "FOREVER" not in family:
            time = time8(operands[0]) if operands else max(taken[0], 0)
        if family.startswith("WATCH"):
            self.watch(powers, time)
        else:
            assert time is not None
            self.motors(powers)
            self.wait(time, "MOVE")

    def way(self, way: int, power: int, turns: bool) -> int:
        """How many milliseconds a way takes."""
        if way <= 0:
            return 0
        per_second = (self.kit.turn if turns else self.kit.speed) * power
        if per_second == 0:
            raise Fault("NO_POWER")
        return fits(divided(100_000 * way, per_second))

    def watch(self, powers: tuple[int, int] | None, time: int | None) -> None:
        """Keep a prepared move; its check begins after the instruction."""
        self.watched = Watched(powers, time, self.pc)

    def until(self, stop: bool) -> None:
        """Steps 1 to 3."""
        move = self.watched
        if stop:
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
    late: Callable[[int, int], int] = lambda waited, reached: 0,
    begin_ms: int = 0,
    is_slow: Callable[[int, int], bool] = always_ready,
) -> str:
    """Return what a run of verified code prints; `max_steps` instructions run at most.

    On a robot that is `late`, the call after each wait comes some milliseconds after the clock: it
    is given which wait it is, from 1, and when the clock is reached. `is_slow` says whether a
    sensor is not ready so long after the start.
    """
    run = Run(code, kit, readings, max_ms, seed, max_steps, late, begin_ms, is_slow, clock=begin_ms)
    run.run()
    return "".join(run.lines)
