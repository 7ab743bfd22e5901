"""Tasks of the bytecode, written from the words of `bytecode_spec.md` alone.

A turn lends the machine beside it what its task has for itself. Only a run on the clock of a trace
is here: each reading is there, and each SHOW finds room.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from tests.oracle.arithmetic import WRAP, Fault, time8, whole, within
from tests.oracle.machine import TOO_MANY, Over, Run, Watched
from tests.oracle.spec_tables import instruction_at
from tests.oracle.words import Kit

OWN = ("pc", "counters", "calls", "clock", "waits", "watched")  # of the record, for each task
ITSELF = -1  # a MOVE that was blocked goes on with itself


class TooMany(Exception):
    """Steps."""


@dataclass(eq=False)
class Task:
    """What a task has for itself."""

    rank: int
    kind: str
    pc: int
    clock: int
    counters: list[int] = field(default_factory=list)
    calls: list[int] = field(default_factory=list)
    waits: str = ""
    watched: Watched = field(default_factory=lambda: Watched(None, None, 0))
    has_ended: bool = False
    waited: bool = False
    move: str = ""  # "drives", or "blocked"
    powers: tuple[int, int] = (0, 0)
    left: int | None = 0  # None: forever
    check: int = 0  # of the move, or ITSELF
    end: int = 0  # of the move
    set: tuple[int, int] | None = None
    keeps: bool = False

    def __post_init__(self) -> None:
        self.looks_at = self.pc  # a WHEN

    @property
    def wants(self) -> bool:
        """Whether it wants the motors."""
        return bool(self.move or self.set is not None or self.keeps)


class TaskRun(Run):
    """A program with tasks that runs."""

    task: Task  # whose turn it is
    has: Task | None = None  # the motors
    last: tuple[int, int] = (0, 0)
    steps = 0

    def run(self) -> None:
        """Run to the end."""
        begun = [*self.begins("when"), *self.begins("task"), ("main", 0)]
        self.tasks = [Task(rank, *each, self.clock) for rank, each in enumerate(begun)]
        main = self.tasks[-1]
        try:
            self.turn(main)
            self.round(main)
            while not self.is_over:
                self.passed += self.passes()
                self.round()
            self.note("DONE")
        except Fault as fault:
            self.note(f"FAULT {fault}")
        except Over:
            self.passed = self.max_ms
            self.note("LIMIT")
        except TooMany:
            self.note(TOO_MANY)

    def begins(self, role: str) -> Iterator[tuple[str, int]]:
        """Where each task of a kind begins, in the order of the code."""
        at = 0
        while at < len(self.code):
            row = instruction_at(self.code, at)
            at += row.size
            if row.role == role:
                yield role, at

    @property
    def is_over(self) -> bool:
        return all(task.has_ended for task in self.tasks)

    def passes(self) -> int:
        """How long it is until the next clock that will be reached."""
        due = [each for each in self.tasks if not each.has_ended and not self.is_held(each)]
        passes = min(((each.clock - self.now) % WRAP for each in due), default=self.max_ms + 1)
        if self.passed + passes > self.max_ms:
            raise Over
        return passes

    def is_held(self, task: Task) -> bool:
        return task.move == "blocked" and self.has is not task

    def round(self, began: Task | None = None) -> None:
        """Let each task that is due have a turn; one has had its turn before the first round."""
        for task in self.tasks:
            is_reached = (self.now - task.clock) % WRAP < WRAP // 2
            if is_reached and not task.has_ended and not self.is_held(task):
                self.turn(task)
                if began and began.move == "blocked" and not self.is_held(began):
                    began.clock = (self.now + 1) % WRAP

    def turn(self, task: Task) -> None:
        self.task = task
        for name in OWN:
            setattr(self, name, getattr(task, name))
        self.waits = ""
        if task.move == "drives" and self.pc == task.end:
            self.end_move()
        while not self.waits and not task.has_ended:
            self.steps += 1
            if self.steps > self.max_steps:
                raise TooMany
            self.step()
        for name in OWN:
            setattr(task, name, getattr(self, name))
        if not self.is_over:
            self.pass_motors()

    def step(self) -> None:
        if self.pc == len(self.code):
            self.end_task()
        elif self.pc == ITSELF:
            self.begin_move()
            self.wait_for_end()
        else:
            super().step()

    # The motors

    def pass_motors(self) -> None:
        """Behind a turn."""
        first = next((task for task in self.tasks if task.wants), None)
        if first is self.has:
            return
        self.has = first
        powers = (first and first.set) or (0, 0)
        if powers != self.last:
            self.motors(powers)
        if first and first.move == "blocked":
            first.clock = self.now

    def motors(self, powers: tuple[int, int]) -> None:
        self.last = powers
        super().motors(powers)

    @property
    def is_higher(self) -> bool:
        """Whether a higher task has the motors."""
        return self.has is not None and self.has.rank < self.task.rank

    def take(self) -> None:
        other, self.has = self.has, self.task
        if other is None or other is self.task or other.move != "drives":
            return
        if other.left is not None:
            other.left += (other.clock - self.now) % WRAP
        if other.left == 0:
            other.move, other.set, other.pc = "", None, other.end
        else:
            other.move, other.pc, other.waited = "blocked", other.check, True

    def keep(self) -> None:
        self.task.keeps = self.task.keeps or self.task.kind == "when"

    def set_motors(self, powers: tuple[int, int]) -> None:
        self.task.set = powers
        self.keep()
        if not self.is_higher:
            self.take()
            self.motors(powers)

    def stop(self) -> None:
        self.task.set = None
        self.keep()
        if self.is_higher:
            return
        self.motors((0, 0))
        if self.has:
            self.has.set = None
        if self.has and self.has.move == "drives":
            self.has.move, self.has.clock, self.has.pc = "", self.now, self.has.end

    # Moves

    def come(self, powers: tuple[int, int], time: int | None, check: int) -> bool:
        """Whether a move that comes, with or without a check, need not wait for the motors."""
        self.task.powers, self.task.left, self.task.check = powers, time, check
        if self.is_higher:
            self.block()
        return not self.is_higher

    def block(self) -> None:
        task = self.task
        task.move, task.set, task.waited = "blocked", None, True
        self.keep()
        self.pc, self.waits = task.check, "MOTORS"

    def begin_move(self) -> None:
        self.take()
        self.task.move, self.task.set = "drives", None
        self.keep()
        self.motors(self.task.powers)
        self.begin()

    def wait_for_end(self) -> None:
        task = self.task
        left, task.left, self.pc = task.left or 0, 0, task.end
        self.clock = (self.clock + left) % WRAP
        if left == 0:
            self.end_move()
        else:
            self.waits, task.waited = "MOVE", True

    def end_move(self) -> None:
        self.motors((0, 0))
        self.task.move, self.task.set = "", None

    def drive(
        self, family: str, way: tuple[int, int], taken: list[int], operands: Sequence[int]
    ) -> None:
        if family.startswith("WATCH"):
            return super().drive(family, way, taken, operands)
        power = operands[-1] if operands else within(whole(taken[-1]), 0, 100)
        time = time8(operands[0]) if operands else max(taken[0], 0)
        self.task.end = self.pc
        if self.come((way[0] * power, way[1] * power), time, ITSELF):
            self.begin_move()
            self.wait_for_end()

    def watch(self, powers: tuple[int, int] | None, time: int | None) -> None:
        super().watch(powers, time)
        if powers is not None:
            self.come(powers, time, self.pc)

    def until(self, stop: bool) -> None:
        task = self.task
        if self.watched.powers is None:
            super().until(stop)
            self.ends_at_once()
            return
        task.end = self.pc
        if stop and task.move == "drives":
            self.clock = self.now
            self.end_move()
        elif stop:
            task.move = ""
        elif task.move != "drives" and self.is_higher:
            self.block()
        else:
            if task.move != "drives":
                self.begin_move()
            self.go_on_driving()

    def go_on_driving(self) -> None:
        task = self.task
        following = ((self.now - self.clock) % WRAP // 20 + 1) * 20
        if task.left is not None and task.left <= following:
            return self.wait_for_end()
        self.clock = (self.clock + following) % WRAP
        if task.left is not None:
            task.left -= following
        self.pc, self.waits, task.waited = task.check, "PAUSE", True

    # Waits and ends

    def wait(self, duration: int, what: str) -> None:
        super().wait(duration, what)
        self.ends_at_once()

    def ends_at_once(self) -> None:
        """A wait of 0 ms does; any other one sets `waited`."""
        if self.waits and self.clock == self.now:
            self.waits = ""
        self.task.waited = self.task.waited or bool(self.waits)

    def end_task(self) -> None:
        self.task.has_ended, self.task.set = True, None

    def look_again(self) -> None:
        self.wait(20, "PAUSE")
        self.pc = self.task.looks_at

    def other(self, name: str, taken: list[int], operands: Sequence[int], to: int) -> None:
        match name:
            case "STOP":
                self.stop()
            case "MOTORS" | "MOTORS8":
                left, right = operands or (within(whole(each), -100, 100) for each in taken)
                self.set_motors((left, right))
            case _:
                super().other(name, taken, operands, to)

    def control(self, name: str, taken: list[int], operands: Sequence[int], to: int) -> None:
        match name:
            case "TASK" | "WHEN":
                self.pc = to
            case "END_TASK":
                self.end_task()
            case "END_WHEN":
                self.look_again()
            case "LOOK":
                if not taken[0]:
                    self.task.set, self.task.keeps = None, False
                    self.look_again()
            case _:
                super().control(name, taken, operands, to)
                if name in ("AGAIN", "NEXT") and self.pc == to:
                    self.go_back()

    def go_back(self) -> None:
        if not self.task.waited:
            self.wait(1, "PAUSE")
        self.task.waited = False


def trace(
    code: bytes, kit: Kit, readings: Mapping[str, Sequence[int]], max_ms: int, seed: int,
    max_steps: int,
) -> str:  # fmt: skip
    """Return what a run of verified code with tasks prints."""
    run = TaskRun(code, kit, readings, max_ms, seed, max_steps, lambda waited, reached: 0)
    run.run()
    return "".join(run.lines)
