"""The machine, in Python.

Runs verified code. Time comes in as `now_ms`, which does not wrap around here; the world is behind
`task.Robot`. `tick` does a little and returns: nothing here waits. What each instruction does is in
`instructions`. The C++ machine has the same names and the same order.
"""

from __future__ import annotations

from tiniscript.bytecode.opcodes import CHECK_MS
from tiniscript.fixed_point import Fault
from tiniscript.vm.handlers import STAY, stopped
from tiniscript.vm.instructions import bound, instruction
from tiniscript.vm.state import (
    CLOCK_MS,
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
        self._code = code
        self._steps = bound(self, code)

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
        run = self._steps
        at, pc = self.at, task.pc
        left = budget
        try:
            for left in range(budget - 1, -1, -1):  # noqa: B007 - it is asked for behind the loop
                at = pc
                pc = run[at]()
                if pc < 0:
                    pc = at if pc == STAY else stopped(pc)
                    break
        except Fault as fault:
            self.robot.off()
            self.status, self.fault = FAULT, fault.name
            pc = instruction(self._code, at)[1]
        self.at, task.pc = at, pc
        self.steps += budget - left
        return self.status

    @property
    def wake_ms(self) -> int:
        """Return the time before which a waiting machine has nothing to do."""
        return self.task.wake_ms

    def wait(self, duration_ms: int, what: str, after: int) -> int:
        """Begin a wait at the end of the previous one, or now if that is too long ago.

        Like a step, this and `until` return where the program goes on.
        """
        task = self.task
        self.begin()
        task.clock_ms += duration_ms
        task.wake_ms = task.clock_ms
        task.wait = what
        self.status = WAITING
        return stopped(after)

    def begin(self) -> None:
        """Set the program's clock to the start time of the next wait or move."""
        if (self.now_ms - self.task.clock_ms) % CLOCK_MS > LATE_MS:
            self.task.clock_ms = self.now_ms

    def until(self, stop: bool, after: int) -> int:
        """End the watched move or go on with it, and check again."""
        task = self.task
        if stop:
            if task.is_watching:
                task.clock_ms = self.now_ms
                if task.powers is not None:
                    self.robot.motors(0, 0)
            return after
        if not task.is_watching:
            task.is_watching = True
            self.begin()
            task.begun_ms = task.clock_ms
            if task.powers is not None:
                self.robot.motors(*task.powers)
        gone_ms = (self.now_ms - task.begun_ms) % CLOCK_MS
        next_ms = (gone_ms // CHECK_MS + 1) * CHECK_MS
        is_last = task.move_ms != FOREVER and next_ms >= task.move_ms
        due_ms = task.move_ms if is_last else next_ms
        task.clock_ms = task.wake_ms = self.now_ms - gone_ms + due_ms
        task.wait = MOVE if is_last and task.powers is not None else PAUSE
        self.status = WAITING
        return stopped(after if is_last else task.check)
