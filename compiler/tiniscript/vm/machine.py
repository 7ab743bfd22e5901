"""The machine, in Python.

Runs verified code. Time comes in as `now_ms`; the world is behind `task.Robot`. `tick` does a
little and returns: nothing here waits. What each instruction does is in `vm_instructions`.
The C++ machine has the same names and the same order.
"""

from __future__ import annotations

from tiniscript.bytecode.opcodes import CHECK_MS
from tiniscript.fixed_point import Fault
from tiniscript.vm.instructions import decoded
from tiniscript.vm.state import (
    DONE,
    FAULT,
    FOREVER,
    MOVE,
    NOTHING,
    PAUSE,
    RUNNING,
    WAITING,
    Robot,
    Task,
)

LATE_MS = 20  # later than this, a program's own clock no longer catches up


class Machine:
    """Runs the code of one image on one robot."""

    def __init__(
        self, code: bytes, robot: Robot, sensors: int = 0, seed: int = 1, now_ms: int = 0
    ) -> None:
        """`code` must be verified for a kit with so many sensors; `seed` is 1 to 4294967295."""
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

    @property
    def wake_ms(self) -> int:
        """Before this time, a machine that waits has nothing to do."""
        return self.task.wake_ms

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
