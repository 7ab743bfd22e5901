"""Runs a program without a robot, and says what the robot did.

The clock is simulated: only moves, waits and beeps move it. Yields the trace, one line for
each thing that the robot did. Knows no files, no ports and no terminal.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Protocol

from tiniscript.base.kit import Kit
from tiniscript.base.trace import Ending, Event, TracedRobot
from tiniscript.vm.state import DONE, FAULT, WAITING, Robot
from tiniscript.vm.tasks import machine_of as python_machine

SLICE_INSTRUCTIONS = 10_000  # instructions between two looks at the limit
MAX_STEPS = 10_000_000  # instructions, if no other limit is asked for


class AnyMachine(Protocol):
    """The interface of a machine for a run: that of `vm.Machine` and the one in C++."""

    @property
    def wake_ms(self) -> int: ...

    @property
    def steps(self) -> int: ...

    @property
    def fault(self) -> str: ...

    @property
    def offset(self) -> int: ...

    def tick(self, now_ms: int, most_steps: int) -> str: ...


MachineOf = Callable[[bytes, Robot, int, int], AnyMachine]  # code, robot, sensors, seed


def run(
    code: bytes,
    kit: Kit,
    read_sensor: Callable[[int], int],
    max_ms: int = 60_000,
    max_steps: int = MAX_STEPS,
    seed: int = 1,
    machine_of: MachineOf = python_machine,
) -> Iterator[Event | Ending]:
    """Yield what a robot with this kit does with verified `code`; the last one is its Ending.

    `max_ms` cuts a wait that would pass it. `max_steps` limits the instructions that run without
    time passing: it ends loops that take no time.
    """
    robot = TracedRobot(kit, read_sensor)
    machine = machine_of(code, robot, len(kit.readings), seed)
    steps_before = 0  # instructions that ran before the clock last moved
    while True:
        steps_left = max_steps - (machine.steps - steps_before)
        status = machine.tick(robot.now_ms, min(SLICE_INSTRUCTIONS, steps_left))
        yield from robot.events
        robot.events.clear()
        if status in (DONE, FAULT):
            ending = status.upper()
        elif status == WAITING and machine.wake_ms <= max_ms:
            if machine.wake_ms > robot.now_ms:
                steps_before = machine.steps
            robot.now_ms = machine.wake_ms
            if machine.steps - steps_before < max_steps:
                continue
            ending = "LIMIT"
        elif status == WAITING:
            robot.now_ms, ending = max_ms, "LIMIT"
        elif machine.steps - steps_before >= max_steps:
            ending = "LIMIT"
        else:
            continue
        text = f"FAULT {machine.fault}" if ending == "FAULT" else ending
        yield Event(robot.now_ms, ending, (), text)
        yield Ending(ending, machine.fault, machine.offset, machine.steps)
        return
