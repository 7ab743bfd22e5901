"""The sequence of a program's instructions, in one task or in several.

Written only from the language reference, section "Tasks" included, not from the compiler or the
machine: there a task is a record, here it is a generator that yields whenever it has to wait.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Generator, Iterable
from dataclasses import dataclass, field

from tests.oracle.arithmetic import nearest_in_range, nearest_whole
from tests.oracle.ast import Do, If, Loop, Statement, Task, Value, While
from tests.oracle.robot import Break, Ending, Robot
from tests.oracle.words import ACTS, MOVES

Turns = Generator[None, None, None]  # a task gives up its turn with `yield`
Powers = tuple[int, int]
IsSlow = Callable[[str, int], bool]  # whether a sensor is not ready at a time
LATE = 20  # more than this, and a task's clock does not catch up
PAUSE = 20  # between two looks of an UNTIL
SIDES = {"F": (1, 1), "B": (-1, -1), "L": (-1, 1), "R": (1, -1)}


def always_ready(name: str, now_ms: int) -> bool:
    return False


@dataclass(eq=False)
class Runner:
    """A running task. `due` is the time of its next turn, None while it waits for the motors."""

    rank: int
    is_when: bool
    clock: int = 0
    due: int | None = 0
    turns: Turns | None = None
    has_waited: bool = False  # whether it has waited since its loop last restarted
    # The task's relation to the motors.
    m: Powers | None = None
    is_moving: bool = False
    driving_until: int | None = None  # time at which its move ends
    drives_forever: bool = False
    insists: bool = False  # a WHEN, until a look finds FALSE
    robbed_at: int | None = None  # a higher task has taken the motors then
    was_stopped: bool = False  # an S has ended its move
    own: dict[str, Value] = field(default_factory=dict)  # the values of DEFs, `SIDE.SIZE`

    @property
    def wants(self) -> bool:
        """Return whether it wants the motors."""
        return self.is_moving or self.m is not None or self.insists

    @property
    def is_interrupted(self) -> bool:
        """Return whether its move has lost the motors, or an S has ended it."""
        return self.was_stopped or self.robbed_at is not None

    @property
    def drives(self) -> bool:
        """Return whether its move turns the wheels."""
        return self.drives_forever or self.driving_until is not None


@dataclass
class TaskRobot(Robot):
    """A robot that does several things at once."""

    runners: list[Runner] = field(default_factory=list)
    who: Runner = field(default_factory=lambda: Runner(0, False))  # the runner whose turn it is
    owner: Runner | None = None  # owner of the motors
    wheels: Powers = (0, 0)
    is_first_round: bool = True  # whether this is the round after the main task's first turn
    is_slow: IsSlow = always_ready
    call_interval_ms: int = 1  # it resumes at multiples of this time
    was_slow: bool = False  # a reading was not ready in this round

    @property
    def own(self) -> dict[str, Value]:
        return self.who.own

    def play(self) -> None:
        whens = [task for task in self.program.tasks if task.condition is not None]
        others = [task for task in self.program.tasks if task.condition is None]
        for rank, task in enumerate([*whens, *others]):
            runner = Runner(rank, task.condition is not None)
            runner.turns = self.watching(task) if runner.is_when else self.body(task.body)
            self.runners.append(runner)
        main = Runner(len(self.runners), False)
        main.turns = self.body(self.program.main)
        self.runners.append(main)
        self.turn(main)
        while self.was_slow:  # a reading does not end this turn
            self.go_to(self.now)
            self.turn(main)
        for runner in self.runners[:-1]:
            runner.clock = runner.due = self.now
        while any(runner.turns is not None for runner in self.runners):
            self.round()

    def round(self) -> None:
        """Goes to the next time at which something is due, and gives each its turn."""
        due = [
            runner.due
            for runner in self.runners
            if runner.turns is not None and runner.due is not None
        ]
        next_time = min(due, default=self.max_time + 1)
        self.go_to(next_time)
        for runner in self.runners:
            if runner.turns is not None and runner.due is not None and runner.due <= self.now:
                self.turn(runner)
        self.is_first_round = False

    def go_to(self, time: int) -> None:
        """Goes on then; at the next possible time where a reading was not ready."""
        time = max(time, self.now + self.was_slow)
        self.was_slow = False
        time += -time % self.call_interval_ms
        if time > self.max_time:
            self.now = self.max_time
            raise Ending("LIMIT")
        if time > self.now:
            self.steps = 0
        self.now = time

    def turn(self, runner: Runner) -> None:
        """Run one task until it has to wait, and then find the owner of the motors."""
        self.who = runner
        assert runner.turns is not None
        try:
            next(runner.turns)
        except StopIteration:
            runner.turns = None
            runner.m = None
        if all(runner.turns is None for runner in self.runners):
            return
        owner = next((runner for runner in self.runners if runner.wants), None)
        if owner is not self.owner:
            self.owner = owner
            powers = (0, 0) if owner is None else owner.m or (0, 0)
            if powers != self.wheels:
                self.motors(*powers)
            if owner is not None and owner.due is None:
                owner.due = self.now + self.is_first_round  # the main task has had its turn

    # -- waiting ------------------------------------------------------------------------------

    def begin(self) -> None:
        """Begins a wait or a move where the one before has ended, or now where that is long ago."""
        if self.now - self.who.clock > LATE:
            self.who.clock = self.now

    def reading(self, names: Iterable[str]) -> Turns:
        """Takes readings. One that is not ready ends the turn."""
        for name in names:
            while self.is_slow(name, self.now):
                self.was_slow = True
                self.who.due = self.now
                yield
            self.read(name)

    def looking(self, statement: Do) -> Generator[None, None, bool]:
        """Looks at an UNTIL, if there is one. For a move that has lost the motors: no more."""
        me = self.who
        if statement.until is None:
            return False
        self.step()
        for _ in self.reading(statement.until_reads):
            yield
            if statement.word in MOVES and (self.is_outranked or me.is_interrupted):
                return False
        return bool(self.value(statement.until))

    def pausing(self, statement: Do, pause_left: int | None) -> Generator[None, None, int]:
        """Waits until the next look of an UNTIL, or the end; returns how long that was."""
        me = self.who
        pause = self.max_time + 1 if pause_left is None else pause_left
        if statement.until is not None:
            look = ((self.now - me.clock) // PAUSE + 1) * PAUSE
            pause = look if pause_left is None else min(look, pause_left)
        yield from self.until_clock(pause)
        return pause

    def until_clock(self, duration: int) -> Turns:
        """Waits on the task's own clock."""
        me = self.who
        me.clock += duration
        if duration > 0:
            me.due = me.clock
            me.has_waited = True
            yield

    def back_to_start(self) -> Turns:
        """Return to the start of a loop, which takes a millisecond if there are tasks."""
        me = self.who
        self.step()
        if not me.has_waited and self.program.tasks:
            self.begin()
            me.clock += 1
            me.due = me.clock
            yield
        me.has_waited = False

    # -- the motors ---------------------------------------------------------------------------

    def motors(self, left: int, right: int) -> None:
        self.wheels = left, right
        self.note(f"MOTORS {left} {right}")

    @property
    def is_outranked(self) -> bool:
        """Return whether a higher task has the motors."""
        return self.owner is not None and self.owner.rank < self.who.rank

    def seize(self) -> None:
        """Give the motors to the current task."""
        loser = self.owner
        if loser is not None and loser is not self.who and loser.drives:
            if loser.driving_until is not None and loser.driving_until <= self.now:
                loser.is_moving = False  # the move is over
                loser.m = None
            else:
                loser.due = None
            loser.robbed_at = self.now
            loser.driving_until, loser.drives_forever = None, False  # the robot does not move
        self.owner = self.who

    # -- statements ---------------------------------------------------------------------------

    def watching(self, task: Task) -> Turns:
        """A WHEN: looks forever."""
        assert task.condition is not None
        me = self.who
        while True:
            self.step()
            yield from self.reading(task.reads)
            if self.value(task.condition):
                yield from self.body(task.body)
            else:
                me.m, me.insists = None, False
            self.begin()
            yield from self.until_clock(20)

    def body(self, body: list[Statement]) -> Turns:
        """Does instructions one after the other."""
        for statement in body:
            self.step()
            if isinstance(statement, If):
                yield from self.choosing(statement)
            elif isinstance(statement, Do):
                yield from self.doing(statement)
            else:
                with contextlib.suppress(Break):
                    yield from self.repeating(statement)

    def choosing(self, statement: If) -> Turns:
        """Execute the first arm whose condition is true."""
        for arm in statement.arms:
            yield from self.reading(arm.reads)
            if arm.condition is None or self.value(arm.condition):
                yield from self.body(arm.body)
                return

    def repeating(self, statement: Loop | While) -> Turns:
        if isinstance(statement, While):
            yield from self.reading(statement.reads)
            while self.value(statement.condition):
                yield from self.body(statement.body)
                yield from self.back_to_start()
                yield from self.reading(statement.reads)
            return
        yield from self.reading(statement.reads)
        turns = None if statement.count is None else nearest_whole(self.value(statement.count))
        while turns is None or turns > 0:
            yield from self.body(statement.body)
            turns = None if turns is None else turns - 1
            if turns != 0:
                yield from self.back_to_start()

    def doing(self, statement: Do) -> Turns:
        word, me = statement.word, self.who
        yield from self.reading(statement.reads)
        if word == "CALL":
            name = statement.name
            values = self.values(statement)
            for value_name, value in zip(self.program.values[name], values, strict=True):
                assert value is not None
                me.own[f"{name}.{value_name}"] = value
            yield from self.body(self.program.defs[name])
            return
        if word == "READ":
            yield from self.reading((statement.name,))
        elif word in (*MOVES, "W", *ACTS, "M", "S"):
            values = self.values(statement)
            if word in MOVES:
                yield from self.moving(statement, values)
            elif word == "W":
                yield from self.waiting(statement, values[0])
            elif word in ACTS:
                act_values = ACTS[word].values(value or 0 for value in values)
                self.note(ACTS[word].note.format(*act_values))
                if ACTS[word].waits:
                    self.begin()
                    yield from self.until_clock(act_values[0])
            elif word == "M":
                left, right = (
                    nearest_in_range(nearest_whole(value or 0), -100, 100) for value in values
                )
                me.m, me.insists = (left, right), me.is_when
                if not self.is_outranked:
                    self.seize()
                    self.motors(left, right)
            else:
                self.stopping()
        else:
            super().do(statement)

    def stopping(self) -> None:
        me, owner = self.who, self.owner
        me.m, me.insists = None, me.is_when
        if self.is_outranked:
            return
        self.motors(0, 0)
        if owner is not None:
            owner.m = None
            if owner.drives:
                owner.is_moving = False
                owner.was_stopped = True
                owner.due = self.now
                # Its move has ended, so no other task can take the motors from it.
                owner.driving_until, owner.drives_forever = None, False
        if me.is_when:
            self.seize()

    def waiting(self, statement: Do, time: Value | None) -> Turns:
        time_left = None if time is None else max(0, time)
        if (yield from self.looking(statement)):
            return
        self.begin()
        while time_left is None or time_left > 0:
            pause = yield from self.pausing(statement, time_left)
            time_left = None if time_left is None else time_left - pause
            if time_left != 0 and (yield from self.looking(statement)):
                self.who.clock = self.now
                return

    def moving(self, statement: Do, values: list[Value | None]) -> Turns:
        me = self.who
        time_left = None if values[0] is None else max(0, values[0])
        power = nearest_in_range(nearest_whole(values[1] or 0), 0, 100)
        side = SIDES[statement.word]
        powers = side[0] * power, side[1] * power
        while True:
            if self.is_outranked:
                me.m = None
                yield from self.standing()
            if (yield from self.looking(statement)):
                me.is_moving = False
                return
            if self.is_outranked:
                continue  # the motors were lost while it looked
            me.m, me.is_moving, me.insists = None, True, me.is_when
            self.seize()
            self.motors(*powers)
            self.begin()
            started_count = me.clock
            yield from self.driving(statement, time_left)
            if me.was_stopped:
                me.was_stopped = False
                me.clock = self.now
                return
            if me.robbed_at is None or not me.is_moving:
                me.robbed_at = None
                return
            if time_left is not None:
                time_left -= me.robbed_at - started_count
            me.robbed_at = None
            me.clock = self.now

    def standing(self) -> Turns:
        """Waits for the motors; when it has them, its clock is now."""
        me = self.who
        me.is_moving, me.insists, me.has_waited = True, me.is_when, True
        while self.owner is not me:
            me.due = None
            yield
        me.clock = self.now

    def driving(self, statement: Do, time_left: int | None) -> Turns:
        """Drives until the time is over, UNTIL ends it, S ends it or the motors are taken."""
        me = self.who
        me.drives_forever = time_left is None
        me.driving_until = None if time_left is None else me.clock + time_left
        while time_left is None or time_left > 0:
            pause = yield from self.pausing(statement, time_left)
            if me.is_interrupted:
                break
            time_left = None if time_left is None else time_left - pause
            if time_left != 0 and (yield from self.looking(statement)):
                me.clock = self.now
                break
            if me.is_interrupted:
                break
        me.driving_until, me.drives_forever = None, False
        if not me.was_stopped and me.robbed_at is None:
            me.is_moving = False
            self.motors(0, 0)
