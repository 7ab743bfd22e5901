"""The duration of a program, if it can be known in advance.

Knows the checked program. Only moves, waits and other words whose row says that they take time
count; readings and other instructions take none.
"""

from __future__ import annotations

from typing import NamedTuple

from tiniscript.base.fixed_point import Fault, round_to_whole
from tiniscript.base.kit import Kit
from tiniscript.semantics import ir
from tiniscript.semantics.optimizer import known_value
from tiniscript.semantics.ways import extent_move_ms


class Duration(NamedTuple):
    """Milliseconds from `least_ms` to `most_ms`, which is None without an upper bound.

    `never_ends`: the program never ends by itself.
    """

    least_ms: int
    most_ms: int | None
    never_ends: bool = False


_NONE = Duration(0, 0)
_UNKNOWN = Duration(0, None)


def duration_of_program(program: ir.Program, kit: Kit) -> Duration:
    """Return the duration of `program`, preferably an optimized one.

    The duration of several tasks is known if at most one moves: a move waits for the motors, and S
    ends one.
    """
    calculator = _Durations(program, kit)
    bodies = (program.body, *(task.body for task in program.tasks))
    durations = [calculator.duration_of(body) for body in bodies]
    least_ms = max(body_duration.least_ms for body_duration in durations)
    if any(task.until is not None for task in program.tasks):
        return Duration(least_ms, None, True)
    if sum(calculator.drives(body) for body in bodies) > 1:
        return Duration(0, None)
    bounds = [
        body_duration.most_ms for body_duration in durations if body_duration.most_ms is not None
    ]
    most_ms = max(bounds) if len(bounds) == len(durations) else None
    return Duration(least_ms, most_ms, any(body_duration.never_ends for body_duration in durations))


class _Durations:
    """The durations of one program's bodies."""

    def __init__(self, program: ir.Program, kit: Kit) -> None:
        self.kit = kit
        self.turn_ms = 1 if program.tasks else 0  # time of a turn of a loop without a wait
        self.def_durations: list[Duration] = []
        self.procedures = program.procedures
        for procedure in program.procedures:
            self.def_durations.append(self.duration_of(procedure.body))

    def drives(self, body: ir.Body) -> bool:
        """Return whether a body has a move or an S, or calls something that has one."""
        return any(
            isinstance(call, ir.Stop) or (isinstance(call, ir.Move) and call.power is not None)
            for call in ir.walk_with_calls(body, self.procedures)
        )

    def duration_of(self, body: ir.Body) -> Duration:
        least_ms, most_ms = 0, 0
        for statement in body:
            statement_duration = self.duration_of_statement(statement)
            least_ms += statement_duration.least_ms
            if statement_duration.never_ends:
                return Duration(least_ms, None, True)
            if statement_duration.most_ms is None:
                most_ms = -1
            elif most_ms >= 0:
                most_ms += statement_duration.most_ms
        return Duration(least_ms, None if most_ms < 0 else most_ms)

    def duration_of_statement(self, statement: ir.Statement) -> Duration:
        if isinstance(statement, ir.Move):
            if statement.time is None and statement.until is None:
                return Duration(0, None, True)
            move_duration = (
                self.duration_of_extent(statement) if statement.unit else _time(statement.time)
            )
            return move_duration if statement.until is None else Duration(0, move_duration.most_ms)
        if isinstance(statement, ir.Act):
            return _time(statement.time) if ir.takes_time(statement) else _NONE
        if isinstance(statement, ir.Call):
            return self.def_durations[statement.procedure]
        if isinstance(statement, ir.If):
            arms = [self.duration_of(body) for body in ir.bodies(statement)]
            bounds = [arm.most_ms for arm in arms if arm.most_ms is not None]
            most_ms = max(bounds) if len(bounds) == len(arms) else None
            never_ends = all(arm.never_ends for arm in arms)
            return Duration(min(arm.least_ms for arm in arms), most_ms, never_ends)
        if isinstance(statement, (ir.Loop, ir.While)):
            return self.duration_of_loop(statement)
        return _NONE

    def duration_of_extent(self, move: ir.Move) -> Duration:
        """Return the duration of a move by distance; one that faults ends the program."""
        try:
            time_ms = extent_move_ms(move, self.kit)
        except Fault:
            time_ms = None
        return _UNKNOWN if time_ms is None else Duration(time_ms, time_ms)

    def duration_of_loop(self, loop: ir.Loop | ir.While) -> Duration:
        body_duration = self.duration_of(loop.body)
        if isinstance(loop, ir.Loop) and loop.times is None:
            return _UNKNOWN if ir.breaks_out(loop.body) else Duration(0, None, True)
        times_value = known_value(loop.times) if isinstance(loop, ir.Loop) else None
        if body_duration.least_ms == 0 and body_duration.most_ms is not None:
            body_duration = body_duration._replace(most_ms=body_duration.most_ms + self.turn_ms)
        if times_value is None:
            return _UNKNOWN if isinstance(loop, ir.While) or body_duration.most_ms != 0 else _NONE
        times = max(round_to_whole(times_value), 0)
        if body_duration.never_ends and times and not ir.breaks_out(loop.body):
            return Duration(body_duration.least_ms, None, True)
        most_ms = None if body_duration.most_ms is None else times * body_duration.most_ms
        return Duration(0 if ir.breaks_out(loop.body) else times * body_duration.least_ms, most_ms)


def _time(time: ir.Expression | None) -> Duration:
    value = known_value(time)
    return _UNKNOWN if value is None else Duration(max(value, 0), max(value, 0))
