"""The state of a running program, and its interface to the robot.

Knows the record `Task`, the robot's seam and the words for what a machine is doing. Does not
know what instructions do (`instructions`) nor when they run (`machine`).
"""

from __future__ import annotations

from typing import Protocol

from tiniscript.bytecode.opcodes import VARIABLES

CLOCK_MS = 2**32  # where a machine's clock wraps around
FOREVER = -1  # the time of a move that only its UNTIL ends

# What `tick` returns
RUNNING = "running"  # there is more to do now
WAITING = "waiting"  # nothing to do before `task.wake_ms`
DONE = "done"
FAULT = "fault"

# What a task waits for
NOTHING = ""
PAUSE = "pause"  # the end of a wait or a beep, or the next check of an UNTIL
MOVE = "move"  # the end of a move: then motors off


class Robot(Protocol):
    """The robot as a machine uses it. Numbers are thousandths, TRUE is 1."""

    def motors(self, left: int, right: int) -> None:
        """Set both motors, -100 to 100 percent."""

    def off(self) -> None:
        """Motors off: the program has ended or faulted."""

    def read(self, sensor: int) -> int | None:
        """Return a reading, or None if it is not ready: the machine asks again."""

    def beep(self, hertz: int, duration_ms: int) -> None:
        """Start a sound; it ends by itself."""

    def show(self, value: int, is_yes_no: bool) -> bool:
        """Send a value; return FALSE while there is no room: the machine tries again."""

    def set(self, actuator: int, value: int) -> None:
        """Set an actuator; the robot rounds and limits the value to its range."""


class Task:
    """The whole state of a running program: one small record."""

    __slots__ = ("begun_ms", "calls", "check", "clock_ms", "counters", "is_watching", "move_ms",
                 "pc", "powers", "random", "readings", "stack", "started_ms", "variables", "wait",
                 "wake_ms")  # fmt: skip

    def __init__(self, seed: int, sensors: int, now_ms: int) -> None:
        self.pc = 0
        self.stack: list[int] = []
        self.counters: list[int] = []
        self.calls: list[int] = []
        self.variables = [0] * VARIABLES
        self.readings = [0] * sensors
        self.random = seed
        self.started_ms = now_ms
        self.clock_ms = now_ms  # the program's own clock: where its last wait ended
        self.wait = NOTHING
        self.wake_ms = now_ms
        # the move that an UNTIL watches
        self.powers: tuple[int, int] | None = None  # None: a wait, the motors stay as they are
        self.move_ms = 0  # how long it may last, or FOREVER
        self.check = 0  # where its check begins
        self.is_watching = False  # it has begun,
        self.begun_ms = now_ms  # at this time
