"""The state of a running program, and its interface to the robot.

Knows the record `Task`, its waits, the robot's seam and the words for what a machine is doing. Does
not know what instructions do (`handlers`) nor when they run (`machine`).
"""

from __future__ import annotations

from typing import Protocol

from tiniscript.base.limits import CHECK_MS, VARIABLES
from tiniscript.vm.handlers import STAY, Step, mark_stop

CLOCK_MS = 2**32  # value at which a machine's clock wraps around
LATE_MS = 20  # later than this, a program's own clock no longer catches up
SHOW_BYTES = 1  # bytes of a SHOW instruction
FOREVER = -1  # the time of a move that only its UNTIL ends

Powers = tuple[int, int]  # left and right, in percent

# Results of `tick`.
RUNNING = "running"  # there is more to do now
WAITING = "waiting"  # there is nothing to do before `task.wake_ms`
DONE = "done"
FAULT = "fault"

# Reasons why a task waits.
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

    def go_ms(self, extent: int, power: int, is_turn: bool) -> int:
        """Return the duration of a move, or a turn if `is_turn`, at 0 to 100 %. Raises Fault."""

    def beep(self, hertz: int, duration_ms: int) -> None:
        """Start a sound; it ends by itself."""

    def show(self, value: int, is_yes_no: bool) -> bool:
        """Send a value; return FALSE while there is no room: the machine tries again.

        The machine's `shown_at` says where its SHOW is.
        """

    def set(self, actuator: int, value: int) -> None:
        """Set an actuator; the robot rounds and limits the value to its range."""


class Task:
    """The whole state of a running program: one small record."""

    __slots__ = ("calls", "check_pc", "clock_ms", "counters", "is_watching", "move_ms", "pc",
                 "powers", "random_state", "readings", "stack", "started_ms", "variables",
                 "wait", "wake_ms")  # fmt: skip

    def __init__(self, seed: int, sensor_count: int, now_ms: int) -> None:
        self.pc = 0
        self.stack: list[int] = []
        self.counters: list[int] = []
        self.calls: list[int] = []
        self.variables = [0] * VARIABLES
        self.readings = [0] * sensor_count
        self.random_state = seed
        self.started_ms = now_ms
        self.clock_ms = now_ms  # the program's own clock: where its last wait ended
        self.wait = NOTHING
        self.wake_ms = now_ms
        # the move that an UNTIL watches
        self.powers: Powers | None = None  # None: a wait; the motors keep their state
        self.move_ms = 0  # remaining time of the move by the clock, or FOREVER
        self.check_pc = 0  # start of the check
        self.is_watching = False  # whether the watch has begun


class Drive:
    """A program that runs on a robot: its waits and moves, as its instructions use them.

    In C++ it is `vm_arduino/src/vm/drive.h`, with the same names but for those that
    `tests/project/test_twins.py` lists.
    """

    def __init__(self, robot: Robot, task: Task, now_ms: int) -> None:
        self.robot = robot
        self.task = task
        self.now_ms = now_ms
        self.status = RUNNING
        self.shown_at = 0  # place of the SHOW whose value the robot gets

    @property
    def wake_ms(self) -> int:
        """Return the time before which a waiting machine has nothing to do."""
        return self.task.wake_ms

    def motors(self, left: int, right: int) -> None:
        """Set the motors, and continue at once."""
        self.robot.motors(left, right)

    def stop_motors(self) -> None:
        self.robot.motors(0, 0)

    def drive(self, move_ms: int, powers: Powers, next_pc: int) -> int:
        """Begin a move, and return where the program continues, like a step."""
        self.robot.motors(*powers)
        return self.wait(move_ms, MOVE, next_pc)

    def watch(self, move_ms: int, powers: Powers | None, next_pc: int) -> int:
        """Keep the move or the wait that an UNTIL watches; its check begins at `next_pc`."""
        task = self.task
        task.move_ms, task.powers, task.is_watching = move_ms, powers, False
        task.check_pc = next_pc
        return next_pc

    def show(self, value: int, is_yes_no: bool, next_pc: int) -> int:
        """Send the value that is on the stack."""
        self.shown_at = next_pc - SHOW_BYTES
        if not self.robot.show(value, is_yes_no):
            return STAY
        self.task.stack.pop()
        return next_pc

    def go_back(self, target: int) -> Step:
        """Return the step that goes back to the start of a loop."""
        return lambda: target

    def end(self) -> int:
        """Finish the program."""
        self.robot.off()
        self.status = DONE
        return STAY

    def wait(self, duration_ms: int, wait_kind: str, next_pc: int) -> int:
        """Begin a wait at the end of the previous one, or now if that is too long ago.

        Like a step, this and `until` return where the program continues.
        """
        task = self.task
        self.begin()
        task.clock_ms += duration_ms
        task.wake_ms = task.clock_ms
        task.wait = wait_kind
        self.status = WAITING
        return mark_stop(next_pc)

    def begin(self) -> None:
        """Set the program's clock to the start time of the next wait or move."""
        if (self.now_ms - self.task.clock_ms) % CLOCK_MS > LATE_MS:
            self.task.clock_ms = self.now_ms

    def until(self, is_met: bool, next_pc: int) -> int:
        """End the watched move or continue it, and check again."""
        task = self.task
        if is_met:
            if task.is_watching:
                task.clock_ms = self.now_ms
                if task.powers is not None:
                    self.robot.motors(0, 0)
            return next_pc
        if not task.is_watching:
            task.is_watching = True
            self.begin()
            if task.powers is not None:
                self.robot.motors(*task.powers)
        late_ms = (self.now_ms - task.clock_ms) % CLOCK_MS
        next_ms = (late_ms // CHECK_MS + 1) * CHECK_MS
        is_last = task.move_ms != FOREVER and next_ms >= task.move_ms
        due_ms = task.move_ms if is_last else next_ms
        if task.move_ms != FOREVER:
            task.move_ms -= due_ms
        task.clock_ms += due_ms
        task.wake_ms = task.clock_ms
        task.wait = MOVE if is_last and task.powers is not None else PAUSE
        self.status = WAITING
        return mark_stop(next_pc if is_last else task.check_pc)
