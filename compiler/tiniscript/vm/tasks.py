"""The machine with a scheduler, for programs with TASK and WHEN.

Knows when each task has its turn, and which one has the motors. Instructions are implemented in the
same place for all programs; this module has their effects in a task. `bytecode_spec.md` has the
same in words; `vm_arduino/src/vm/scheduler.h` and `drive.h` have the same names, but for those that
`tests/project/test_twins.py` lists.
"""

from __future__ import annotations

from typing import NamedTuple

from tiniscript.base.fixed_point import Fault
from tiniscript.base.limits import CHECK_MS
from tiniscript.vm.control import jump
from tiniscript.vm.handlers import STAY, Step, handles, mark_stop
from tiniscript.vm.machine import Machine, instruction_at
from tiniscript.vm.state import (
    CLOCK_MS,
    DONE,
    FAULT,
    FOREVER,
    LATE_MS,
    PAUSE,
    RUNNING,
    SHOW_BYTES,
    WAITING,
    Powers,
    Robot,
)

NEVER_MS = 2**31 - 1  # longest delay: nothing happens by itself
MOTORS_OFF = 0, 0


class TaskRecord:
    """The state of one task.

    A move of its own **drives**, or it is **blocked**: it waits for the motors, or does not move
    because a higher task has taken them.
    """

    __slots__ = ("calls", "check_pc", "clock_ms", "counters", "drives", "ends_at_clock",
                 "has_begun", "has_ended", "has_own_powers", "has_waited", "is_blocked",
                 "is_moving", "is_when", "keeps_motors", "move_ms", "own_powers", "pc",
                 "pc_after_move", "powers", "rank", "start_pc", "unsent_value")  # fmt: skip

    def __init__(self, pc: int, is_when: bool, rank: int, now_ms: int) -> None:
        self.start_pc = pc  # start of the task; a WHEN starts with its check
        self.pc = pc  # start of its next turn
        self.is_when = is_when
        self.rank = rank  # 0 is the highest
        self.counters: list[int] = []
        self.calls: list[int] = []
        self.clock_ms = now_ms  # its own clock, at which its next turn is due
        self.has_ended = False
        self.has_waited = False  # whether it has waited since its loop last restarted
        self.unsent_value: tuple[int, bool] | None = None  # the value of a SHOW that found no room
        # The task's move, or the wait that an UNTIL watches.
        self.powers: Powers | None = None  # None: a wait; the motors keep their state
        self.move_ms = 0  # remaining time of the move by its clock, or FOREVER
        self.has_begun = True  # whether it drives, waits or is over
        self.check_pc = 0  # start of its UNTIL's check, or of the code after it
        self.pc_after_move = 0  # start of the code after the move
        self.is_moving = False  # whether its move drives or is blocked
        self.is_blocked = False
        self.drives = False
        self.ends_at_clock = False  # the clock is the end of the move
        # The task's motor settings apart from its move.
        self.own_powers = MOTORS_OFF  # powers set by its M
        self.has_own_powers = False  # whether these powers are in force
        self.keeps_motors = False  # a WHEN has wanted the motors, and has not found FALSE since

    @property
    def wants_motors(self) -> bool:
        return self.is_moving or self.has_own_powers or self.keeps_motors

    def leave_move(self) -> None:
        """Its move is over, and so is its M. It continues after the move."""
        self.is_moving = self.is_blocked = self.drives = self.ends_at_clock = False
        self.forget_set()
        self.pc = self.pc_after_move

    def stand_still(self, now_ms: int) -> None:
        """Its move that drives loses the motors."""
        if self.move_ms != FOREVER:
            left_ms = self.clock_ms + self.move_ms - now_ms
            if left_ms <= 0:
                self.leave_move()
                return
            self.move_ms = left_ms
        self.is_blocked = True
        self.drives = self.has_begun = self.ends_at_clock = False
        self.pc = self.check_pc

    def forget_set(self) -> None:
        self.own_powers, self.has_own_powers = MOTORS_OFF, False


class TaskMachine(Machine):
    """Runs the code of one image with tasks on one robot."""

    def __init__(
        self, code: bytes, robot: Robot, sensor_count: int = 0, seed: int = 1, now_ms: int = 0
    ) -> None:
        """`code` must be verified for a kit with so many sensors; `seed` is 1 to 4294967295."""
        super().__init__(code, robot, sensor_count, seed, now_ms)
        starts = [*sorted(find_tasks(code), key=lambda task: not task.is_when), Start(0, False)]
        # The tasks in order of rank, the main task last.
        self.tasks = [TaskRecord(*start, rank, now_ms) for rank, start in enumerate(starts)]
        self.current_task = self.tasks[-1]  # the task whose turn it is, or was last
        self.is_in_turn = True  # a turn has begun and is not over
        self.is_first_turn = True  # whether it is the main task's first turn, before all others
        self.is_first_round = True  # the main task has had its turn in it
        self.next_rank = 0  # next rank in this round
        self.holder: TaskRecord | None = None  # the task that controls the motors
        self.powers = MOTORS_OFF  # powers last given to the motors

    # -- turns --------------------------------------------------------------------------------

    @property
    def wake_ms(self) -> int:
        """Return when the next task is due, possibly now or earlier."""
        due_times_ms = (task.clock_ms for task in self.tasks if self._waits_for_clock(task))
        return min(due_times_ms, default=self.now_ms + NEVER_MS)

    def tick(self, now_ms: int, most_steps: int) -> str:
        """Run at most `most_steps` instructions of one round of turns; return the status."""
        if self.status in (DONE, FAULT):
            return self.status
        self.now_ms = now_ms
        self.status = RUNNING
        offset, steps_left = self.offset, most_steps
        try:
            while steps_left and self._finds_turn():
                steps, pc = self._steps, self.current_task.pc
                while steps_left:
                    steps_left -= 1
                    offset = pc
                    pc = steps[offset]()
                    if pc < 0:
                        break
                self.current_task.pc = offset if pc == STAY else mark_stop(pc) if pc < 0 else pc
                if self.status == DONE:
                    break
                if pc < 0 and not (pc == STAY and self.is_first_turn):
                    self._end_turn()
                elif pc < 0:  # the first turn waits for readings too
                    break
        except Fault as fault:
            self.robot.off()
            self.status, self.fault = FAULT, fault.name
            self.current_task.pc = instruction_at(self._code, offset)[1]
        self.offset = offset
        self.steps += most_steps - steps_left
        return self.status

    def _finds_turn(self) -> bool:
        """Go on with a turn, or begin the next one of the round; FALSE: the round is over."""
        while not self.is_in_turn:
            if self.next_rank == len(self.tasks):
                self.next_rank = 0
                self.is_first_round = False
                self.status = WAITING
                return False
            task = self.tasks[self.next_rank]
            self.next_rank += 1
            if self._is_due(task):
                self._begin_turn(task)
        return True

    def _waits_for_clock(self, task: TaskRecord) -> bool:
        return self.holder is task if task.is_blocked else not task.has_ended

    def _is_due(self, task: TaskRecord) -> bool:
        return self._waits_for_clock(task) and task.clock_ms <= self.now_ms

    def _begin_turn(self, task: TaskRecord) -> None:
        self.current_task, self.is_in_turn = task, True
        self.task.counters[:], self.task.calls[:] = task.counters, task.calls
        if task.unsent_value is not None:
            self.shown_at = task.pc - SHOW_BYTES
            if not self.robot.show(*task.unsent_value):
                self._end_turn()
                return
            task.unsent_value = None
        if task.is_blocked:
            task.is_blocked = False
            task.clock_ms = self.now_ms
            if task.check_pc == task.pc_after_move:
                self._go_to(self._begin_move())
        elif task.ends_at_clock:
            self._end_move()
        elif not task.has_begun and self._blocks():
            self._go_to(mark_stop(task.check_pc))  # the motors were lost during its check

    def _go_to(self, pc: int) -> None:
        """Go on where a step says."""
        self.current_task.pc = mark_stop(pc) if pc < 0 else pc
        if pc < 0:
            self._end_turn()

    def _end_turn(self) -> None:
        current_task, self.is_in_turn = self.current_task, False
        current_task.counters[:] = self.task.counters
        current_task.calls[:] = self.task.calls
        if self.is_first_turn:
            self.is_first_turn = False
            for task in self.tasks[:-1]:
                task.clock_ms = self.now_ms
        self._pass_on()

    def end(self) -> int:
        """Finish this task, and the program with the last one."""
        return super().end() if self._end_task() else mark_stop(self.current_task.pc)

    def _end_task(self) -> bool:
        """Finish this task; return whether it was the last one."""
        self.current_task.has_ended = True
        self.current_task.forget_set()
        return all(task.has_ended for task in self.tasks)

    # -- time ---------------------------------------------------------------------------------

    def begin(self) -> None:
        if self.now_ms - self.current_task.clock_ms > LATE_MS:
            self.current_task.clock_ms = self.now_ms

    def wait(self, duration_ms: int, wait_kind: str, next_pc: int) -> int:
        self.begin()
        self.current_task.clock_ms += duration_ms
        if not duration_ms:
            return next_pc
        self.current_task.has_waited = True
        return mark_stop(next_pc)

    def go_back(self, target: int) -> Step:
        def step() -> int:
            task = self.current_task
            if not task.has_waited:
                self.begin()
                task.clock_ms += 1
                return mark_stop(target)
            task.has_waited = False
            return target

        return step

    def look(self, is_true: bool, next_pc: int) -> int:
        """Go on in a WHEN, or look once more."""
        if is_true:
            return next_pc
        self.current_task.keeps_motors = False
        self.current_task.forget_set()
        return self.look_again()

    def look_again(self) -> int:
        return self.wait(CHECK_MS, PAUSE, self.current_task.start_pc)

    def show(self, value: int, is_yes_no: bool, next_pc: int) -> int:
        if self.is_first_turn:  # the first turn waits for room too
            return super().show(value, is_yes_no, next_pc)
        self.task.stack.pop()
        self.shown_at = next_pc - SHOW_BYTES
        if self.robot.show(value, is_yes_no):
            return next_pc
        self.current_task.unsent_value = value, is_yes_no
        return mark_stop(next_pc)

    # -- moves --------------------------------------------------------------------------------

    def drive(self, move_ms: int, powers: Powers, next_pc: int) -> int:
        self._keep_move(move_ms, powers, next_pc)
        self.current_task.pc_after_move = next_pc
        return mark_stop(next_pc) if self._blocks() else self._begin_move()

    def watch(self, move_ms: int, powers: Powers | None, next_pc: int) -> int:
        self._keep_move(move_ms, powers, next_pc)
        self.current_task.pc_after_move = -1  # after its UNTIL
        return mark_stop(next_pc) if self._blocks() else next_pc

    def _keep_move(self, move_ms: int, powers: Powers | None, check_pc: int) -> None:
        task = self.current_task
        task.move_ms, task.powers, task.check_pc, task.has_begun = move_ms, powers, check_pc, False

    def until(self, is_met: bool, next_pc: int) -> int:
        task = self.current_task
        task.pc_after_move = next_pc
        if is_met:
            if task.has_begun:
                task.clock_ms = self.now_ms
            if task.drives:
                self._end_move()
            elif task.is_moving:  # the task waited for the motors, or did not move
                task.leave_move()
            task.has_begun = True
            return next_pc
        if not task.has_begun:
            self._begin_watched()
        late_ms = (self.now_ms - task.clock_ms) % CLOCK_MS
        next_ms = (late_ms // CHECK_MS + 1) * CHECK_MS
        if task.move_ms == FOREVER or next_ms < task.move_ms:
            return self._drive_on(task.check_pc, next_ms, False)
        return self._drive_on(next_pc, task.move_ms, True)

    def _begin_move(self) -> int:
        """Begin a move that no UNTIL watches."""
        self._begin_watched()
        return self._drive_on(self.current_task.pc_after_move, self.current_task.move_ms, True)

    def _begin_watched(self) -> None:
        task = self.current_task
        if task.powers is not None:
            self._take_motors()
            task.forget_set()
            task.is_moving = task.drives = True
            self._set_motors(task.powers)
        task.has_begun = True
        self.begin()

    def _drive_on(self, pc: int, due_ms: int, is_last: bool) -> int:
        """Wait this long, and continue at `pc`; `is_last`: that is the end of the move."""
        task = self.current_task
        task.ends_at_clock = is_last and task.drives
        if due_ms == 0:
            if task.drives:
                self._end_move()
            return pc
        if task.move_ms != FOREVER:
            task.move_ms -= due_ms
        task.clock_ms += due_ms
        task.has_waited = True
        return mark_stop(pc)

    def _end_move(self) -> None:
        self.current_task.leave_move()
        self._set_motors(MOTORS_OFF)

    def _blocks(self) -> bool:
        """Wait for the motors where its move needs them and a higher task has them."""
        task = self.current_task
        if task.powers is None or not self._is_below():
            return False
        task.forget_set()
        task.is_moving = task.is_blocked = task.has_waited = True
        task.drives = False
        task.keeps_motors = task.is_when
        return True

    # -- the motors ---------------------------------------------------------------------------

    def motors(self, left: int, right: int) -> None:
        task = self.current_task
        task.own_powers, task.has_own_powers, task.keeps_motors = (left, right), True, task.is_when
        if not self._is_below():
            self._take_motors()
            self._set_motors(task.own_powers)

    def stop_motors(self) -> None:
        task, holder = self.current_task, self.holder
        task.forget_set()
        task.keeps_motors = task.is_when
        if self._is_below():
            return
        self._set_motors(MOTORS_OFF)
        if holder is not None:
            holder.forget_set()
            if holder.drives:
                holder.leave_move()
                holder.clock_ms = self.now_ms

    def _is_below(self) -> bool:
        """Return whether a higher task has the motors."""
        return self.holder is not None and self.holder.rank < self.current_task.rank

    def _take_motors(self) -> None:
        """Assign the motors to the current task; no higher one has them."""
        if self.holder is not None and self.holder is not self.current_task and self.holder.drives:
            self.holder.stand_still(self.now_ms)
        self.holder = self.current_task
        self.current_task.keeps_motors = self.current_task.is_when

    def _pass_on(self) -> None:
        """After a turn: give the motors to the highest task that wants them, if it is another."""
        highest_task = next((task for task in self.tasks if task.wants_motors), None)
        if highest_task is not self.holder:
            self.holder = highest_task
            if highest_task is not None and highest_task.is_blocked:
                highest_task.clock_ms = self.now_ms + self.is_first_round
            powers = MOTORS_OFF if highest_task is None else highest_task.own_powers
            if powers != self.powers:
                self._set_motors(powers)

    def _set_motors(self, powers: Powers) -> None:
        self.powers = powers
        self.robot.motors(*powers)


def machine_of(
    code: bytes, robot: Robot, sensor_count: int = 0, seed: int = 1, now_ms: int = 0
) -> Machine:
    """Return the machine for `code`, which is verified: one with a scheduler where it has tasks."""
    machine_class = TaskMachine if find_tasks(code) else Machine
    return machine_class(code, robot, sensor_count, seed, now_ms)


# -- the code ------------------------------------------------------------------------------------


class Start(NamedTuple):
    """The start of a task."""

    pc: int
    is_when: bool


def find_tasks(code: bytes) -> list[Start]:
    """Return the tasks of verified code in their order, without the main one."""
    tasks = []
    offset = 0
    while offset < len(code):
        op, offset = instruction_at(code, offset)
        if op.name in ("TASK", "WHEN"):
            tasks.append(Start(offset, op.name == "WHEN"))
    return tasks


handles("TASK", "WHEN")(jump)


@handles("END_TASK")
def _end_task(machine: TaskMachine, next_pc: int) -> Step:
    return machine.end


@handles("LOOK")
def _look(machine: TaskMachine, next_pc: int) -> Step:
    return lambda: machine.look(bool(machine.task.stack.pop()), next_pc)


@handles("END_WHEN")
def _end_when(machine: TaskMachine, next_pc: int) -> Step:
    return machine.look_again
