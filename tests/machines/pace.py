"""The times of a machine's calls, and the readings that delay it: the same for every machine.

`vm_arduino/extras/chip/runner.cpp` is the C++ version of `trace_at`.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from struct import pack
from typing import TYPE_CHECKING, NamedTuple

from tests.machines.python import lists_of
from tiniscript.base.kit import Kit
from tiniscript.base.trace import TracedRobot
from tiniscript.bytecode.image import HEADER_BYTES
from tiniscript.vm.runner import MachineOf
from tiniscript.vm.state import DONE, FAULT

if TYPE_CHECKING:
    from tests.machines import Senses

CALL_INSTRUCTIONS = 60_000  # instructions of a call: more than a task runs in a turn


class Pace(NamedTuple):
    """A call at multiples of so many milliseconds; slow sensors, not ready from one time to
    another in each period."""

    call_interval_ms: int = 1
    slow: Sequence[str] = ()
    period_ms: int = 1
    from_ms: int = 0
    to_ms: int = 0

    def pack(self, kit: Kit) -> bytes:
        """Return the start of a request to a machine in C++."""
        names = [sensor.name for sensor in kit.readings]
        slow_sensors = sum(1 << names.index(name) for name in self.slow)
        return pack(
            "<5I", self.call_interval_ms, slow_sensors, self.period_ms, self.from_ms, self.to_ms
        )

    def is_slow(self, name: str, now_ms: int) -> bool:
        return name in self.slow and self.from_ms <= now_ms % self.period_ms < self.to_ms


NO_DELAY = Pace()
ECHO_SENSORS = ("DISTANCE",)


def random_pace(rng: random.Random) -> Pace:
    """An echo that takes a part of each period, of a robot that is called often or seldom."""
    period_ms = rng.choice((31, 50, 90, 130, 170))
    from_ms = rng.randrange(period_ms // 3)
    to_ms = rng.randint(2 * from_ms, period_ms)
    slow_sensors = rng.choice((ECHO_SENSORS, ("LIGHT_L",), ("DISTANCE", "LIGHT_L")))
    return Pace(rng.choice((1, 1, 1, 3, 7, 25)), slow_sensors, period_ms, from_ms, to_ms)


class PacedRobot(TracedRobot):
    """A robot whose slow sensors are not always ready."""

    def __init__(self, pace: Pace, kit: Kit, senses: Senses) -> None:
        super().__init__(kit, lists_of(kit, senses))
        self.pace = pace
        self.was_slow = False  # whether the current call was slow

    def read(self, sensor: int) -> int | None:
        if self.pace.is_slow(self.kit.readings[sensor].name, self.now_ms):
            self.was_slow = True
            return None
        return super().read(sensor)


def trace_at(pace: Pace, machine_of: MachineOf, image: bytes, kit: Kit, senses: Senses) -> str:
    """Return the trace of an image, which is verified, of a machine that is called at this pace."""
    robot = PacedRobot(pace, kit, senses)
    machine = machine_of(image[HEADER_BYTES:], robot, len(kit.readings), senses.seed)
    while True:
        robot.was_slow = False
        status = machine.tick(robot.now_ms, CALL_INSTRUCTIONS)
        if status in (DONE, FAULT):
            robot.record(status, (), f"FAULT {machine.fault}" if status == FAULT else "DONE")
        else:
            wake_ms = max(machine.wake_ms, robot.now_ms + robot.was_slow)
            robot.now_ms = -(-wake_ms // pace.call_interval_ms) * pace.call_interval_ms
            if robot.now_ms <= senses.max_ms:
                continue
            robot.now_ms = senses.max_ms
            robot.record("LIMIT", (), "LIMIT")
        return "".join(f"{event}\n" for event in robot.events)
