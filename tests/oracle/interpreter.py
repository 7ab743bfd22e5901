"""Runs a TiniScript program straight from its text and returns a robot's behaviour.

The interpreter shares nothing with the compiler and the bytecode machine, so that the tests can
ask both and compare. It follows the language reference as literally as it can and prefers plain
code to fast code.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence

from tests.oracle.tasks import IsSlow, TaskRobot, always_ready
from tests.oracle.text import Parser
from tests.oracle.words import PAPER_KIT, Device, Kit, Mistake

__all__ = ["PAPER_KIT", "Device", "Kit", "Mistake", "run"]

_NO_SENSES: Mapping[str, Sequence[int]] = {}


def run(
    text: str,
    kit: Kit = PAPER_KIT,
    sensors: Mapping[str, Sequence[int]] = _NO_SENSES,
    max_time_ms: int = 60_000,
    max_steps: int = 10_000_000,
    seed: int = 1,
    is_slow: IsSlow = always_ready,
    call_interval_ms: int = 1,
) -> str:
    """Runs a program and returns all that the run prints; raises Mistake if it is wrong.

    Readings are in thousandths, 0 or 1 for yes/no. Wrong use is a ValueError. `is_slow` says
    whether a sensor is not ready at a time; the program continues at multiples of
    `call_interval_ms`.
    """
    ranges = {device.name: (device.low, device.high) for device in kit.readings}
    for name, values in sensors.items():
        if name not in ranges:
            raise ValueError(f"no sensor {name}")
        if any(not ranges[name][0] <= value <= ranges[name][1] for value in values):
            raise ValueError(f"a reading of {name} is out of its range")
    if not 1 <= seed <= 0xFFFFFFFF:
        raise ValueError("the seed is out of range")
    sys.setrecursionlimit(max(sys.getrecursionlimit(), 10_000))
    program = Parser(text, kit).program()
    robot = TaskRobot(program, kit, sensors, max_time_ms, max_steps, seed)
    robot.is_slow, robot.call_interval_ms = is_slow, call_interval_ms
    robot.run()
    return "".join(robot.trace)
