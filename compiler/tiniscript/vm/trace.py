"""Runs a program without a robot, and says what the robot did.

The clock is simulated: only moves, waits and beeps move it. Yields the trace, one line for
each thing that the robot did. Knows no files, no ports and no terminal.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple, Protocol

from tiniscript.base.fixed_point import as_text, limited, whole
from tiniscript.base.kit import Kit
from tiniscript.vm.state import DONE, FAULT, WAITING, Robot
from tiniscript.vm.tasks import machine_of as python_machine

SLICE = 10_000  # instructions between two looks at the limit


class Event(NamedTuple):
    """What a robot did at `time_ms`: MOTORS, READ, BEEP, SHOW, SET, DONE, FAULT or LIMIT.

    `values` are percent for MOTORS, hertz and milliseconds for BEEP, the number of the device
    and thousandths for READ and SET, thousandths for SHOW; `text` is what a trace prints.
    """

    time_ms: int
    what: str
    values: tuple[int, ...]
    text: str

    def __str__(self) -> str:
        return f"{self.time_ms} {self.text}"


class Ending(NamedTuple):
    """How a run ended: `what` is DONE, FAULT or LIMIT; `offset` is where the code was."""

    what: str
    fault: str
    offset: int
    steps: int


class Senses:
    """Readings from lists: each takes the next value, the last one repeats, no list is 0."""

    def __init__(self, kit: Kit, lists: Mapping[int, Sequence[int]]) -> None:
        """`lists` maps the number of a sensor to its readings, in thousandths."""
        self.lists = [list(lists.get(i, ())) or [0] for i in range(len(kit.sensors))]
        self.taken = [0] * len(kit.sensors)

    def __call__(self, sensor: int) -> int:
        values = self.lists[sensor]
        value = values[min(self.taken[sensor], len(values) - 1)]
        self.taken[sensor] += 1
        return value


class TracedRobot:
    """A robot that only records what it is told to do."""

    def __init__(self, kit: Kit, senses: Callable[[int], int]) -> None:
        self.kit = kit
        self.senses = senses
        self.now_ms = 0
        self.events: list[Event] = []

    def say(self, what: str, values: tuple[int, ...], text: str) -> None:
        self.events.append(Event(self.now_ms, what, values, text))

    def motors(self, left: int, right: int) -> None:
        self.say("MOTORS", (left, right), f"MOTORS {left} {right}")

    def off(self) -> None:
        """Record nothing: the final stop is not part of a trace."""

    def read(self, sensor: int) -> int | None:
        value = self.senses(sensor)
        device = self.kit.sensors[sensor]
        self.say("READ", (sensor, value), f"READ {device.name} {device.text(value)}")
        return value

    def go_ms(self, way: int, power: int, turns: bool) -> int:
        return self.kit.go_ms(way, power, turns)

    def beep(self, hertz: int, duration_ms: int) -> None:
        self.say("BEEP", (hertz, duration_ms), f"BEEP {hertz} {duration_ms}")

    def show(self, value: int, is_yes_no: bool) -> bool:
        shown = ("TRUE" if value else "FALSE") if is_yes_no else as_text(value)
        self.say("SHOW", (value,), f"SHOW {shown}")
        return True

    def set(self, actuator: int, value: int) -> None:
        device = self.kit.actuators[actuator]
        if not device.is_yes_no:
            value = limited(whole(value) * 1000, device.low, device.high)
        self.say("SET", (actuator, value), f"SET {device.name} {device.text(value)}")


class AnyMachine(Protocol):
    """What a run asks of a machine: `vm.Machine` and the one in C++ both answer."""

    @property
    def wake_ms(self) -> int: ...

    @property
    def steps(self) -> int: ...

    @property
    def fault(self) -> str: ...

    @property
    def at(self) -> int: ...

    def tick(self, now_ms: int, budget: int) -> str: ...


MachineOf = Callable[[bytes, Robot, int, int], AnyMachine]  # code, robot, sensors, seed


def run(
    code: bytes,
    kit: Kit,
    senses: Callable[[int], int],
    max_ms: int = 60_000,
    max_steps: int = 10_000_000,
    seed: int = 1,
    machine_of: MachineOf = python_machine,
) -> Iterator[Event | Ending]:
    """Yield what a robot with this kit does with verified `code`; the last one is its Ending.

    `max_ms` cuts a wait that would pass it. `max_steps` limits the instructions that run without
    time passing: it ends loops that take no time.
    """
    robot = TracedRobot(kit, senses)
    machine = machine_of(code, robot, len(kit.sensors), seed)
    before = 0  # instructions that ran before the clock last moved
    while True:
        left = max_steps - (machine.steps - before)
        status = machine.tick(robot.now_ms, min(SLICE, left))
        yield from robot.events
        robot.events.clear()
        if status in (DONE, FAULT):
            what = status.upper()
        elif status == WAITING and machine.wake_ms <= max_ms:
            if machine.wake_ms > robot.now_ms:
                before = machine.steps
            robot.now_ms = machine.wake_ms
            if machine.steps - before < max_steps:
                continue
            what = "LIMIT"
        elif status == WAITING:
            robot.now_ms, what = max_ms, "LIMIT"
        elif machine.steps - before >= max_steps:
            what = "LIMIT"
        else:
            continue
        text = f"FAULT {machine.fault}" if what == "FAULT" else what
        yield Event(robot.now_ms, what, (), text)
        yield Ending(what, machine.fault, machine.at, machine.steps)
        return
