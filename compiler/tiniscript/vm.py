"""The machine, in Python.

Runs verified code. Time comes in as `now_ms`; the world is behind `Robot`. `tick` does a
little and returns: nothing here waits. What each instruction does is in `vm_instructions`.
The C++ machine has the same names and the same order.
"""

from __future__ import annotations

from typing import Protocol

from tiniscript.bytecode import CHECK_MS, VARIABLES
from tiniscript.thousandths import Fault

LATE_MS = 20  # later than this, a program's own clock no longer catches up
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
    """What a machine may ask of the world. Numbers are thousandths, TRUE is 1."""

    def motors(self, left: int, right: int) -> None:
        """Set both motors, -100 to 100 percent."""

    def off(self) -> None:
        """Motors off: the program has ended or faulted."""

    def read(self, sensor: int) -> int | None:
        """Return a reading, or None while it is not there yet: the machine asks again."""

    def beep(self, hertz: int, duration_ms: int) -> None:
        """Start a sound; it ends by itself."""

    def show(self, value: int, is_yes_no: bool) -> bool:
        """Send a value; return FALSE while there is no room: the machine tries again."""

    def set(self, actuator: int, value: int) -> None:
        """Set an actuator; the robot rounds and limits the value to its range."""


class Task:
    """All that a running program is: one small record."""

    __slots__ = ("begun_ms", "calls", "clock_ms", "counters", "is_watching", "move_ms", "pc",
                 "powers", "random", "readings", "stack", "started_ms", "variables", "wait",
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
        self.is_watching = False  # it has begun,
        self.begun_ms = now_ms  # at this time


class Machine:
    """Runs the code of one image on one robot."""

    def __init__(
        self, code: bytes, robot: Robot, sensors: int = 0, seed: int = 1, now_ms: int = 0
    ) -> None:
        """`code` must be verified for a kit with so many sensors; `seed` is 1 to 4294967295."""
        from tiniscript.vm_instructions import decoded

        self.robot = robot
        self.task = Task(seed, sensors, now_ms)
        self.now_ms = now_ms
        self.status = RUNNING
        self.fault = ""
        self.at = 0  # where the instruction that runs, or has faulted, begins
        self.steps = 0  # instructions that have run
        self._code = decoded(code)

    def tick(self, now_ms: int, budget: int) -> str:
        """Run at most `budget` instructions at the time `now_ms`; return the status."""
        if self.status in (DONE, FAULT):
            return self.status
        self.now_ms = now_ms
        task = self.task
        if task.wait != NOTHING:
            if now_ms < task.wake_ms:
                return WAITING
            if task.wait == MOVE:
                self.robot.motors(0, 0)
            task.wait = NOTHING
        self.status = RUNNING
        code = self._code
        left = budget
        try:
            while left:
                left -= 1
                self.at = at = task.pc
                handler, operands, task.pc = code[at]
                if handler(self, task, *operands):
                    break
        except Fault as fault:
            self.robot.off()
            self.status, self.fault = FAULT, fault.name
        self.steps += budget - left
        return self.status

    def wait(self, duration_ms: int, what: str) -> bool:
        """Begin a wait where the one before ended, or now where that is too long ago."""
        task = self.task
        self.begin()
        task.clock_ms += duration_ms
        task.wake_ms = task.clock_ms
        task.wait = what
        self.status = WAITING
        return True

    def begin(self) -> None:
        """Set the program's clock to when a wait or a move that comes now begins."""
        if self.now_ms - self.task.clock_ms > LATE_MS:
            self.task.clock_ms = self.now_ms

    def until(self, stop: bool, check: int) -> bool:
        """End the watched move or go on with it, and check again at the offset `check`."""
        task = self.task
        if stop:
            if task.is_watching:
                task.clock_ms = self.now_ms
                if task.powers is not None:
                    self.robot.motors(0, 0)
            return False
        if not task.is_watching:
            task.is_watching = True
            self.begin()
            task.begun_ms = task.clock_ms
            if task.powers is not None:
                self.robot.motors(*task.powers)
        gone_ms = self.now_ms - task.begun_ms
        next_ms = (gone_ms // CHECK_MS + 1) * CHECK_MS
        if task.move_ms != FOREVER and next_ms >= task.move_ms:
            task.clock_ms = task.wake_ms = task.begun_ms + task.move_ms
            task.wait = PAUSE if task.powers is None else MOVE
        else:
            task.clock_ms = task.wake_ms = task.begun_ms + next_ms
            task.wait = PAUSE
            task.pc = check
        self.status = WAITING
        return True

    def retry(self) -> bool:
        """Run this instruction again at the next tick: the robot is not ready."""
        self.task.pc = self.at
        return True
