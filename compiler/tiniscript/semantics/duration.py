"""How long a program runs, if this can be known in advance.

Knows the checked program. Only moves, waits and beeps count; readings and other instructions take
no time.
"""

from __future__ import annotations

from typing import NamedTuple

from tiniscript.base.fixed_point import Fault, whole
from tiniscript.base.kit import Kit
from tiniscript.semantics import ir
from tiniscript.semantics.optimizer import known_value
from tiniscript.semantics.ways import way_ms


class Duration(NamedTuple):
    """Milliseconds from `least_ms` to `most_ms`, which is None without an upper bound.

    `never_ends`: the program never ends by itself.
    """

    least_ms: int
    most_ms: int | None
    never_ends: bool = False


_NONE = Duration(0, 0)
_UNKNOWN = Duration(0, None)


def duration(program: ir.Program, kit: Kit) -> Duration:
    """Return how long `program`, best an optimised one, runs.

    Of several tasks it is known how long they run where no more than one moves: a move waits for
    the motors, and S ends one.
    """
    result = _Durations(program, kit)
    bodies = (program.body, *(task.body for task in program.tasks))
    durations = [result.duration_of(body) for body in bodies]
    least_ms = max(one.least_ms for one in durations)
    if any(task.until is not None for task in program.tasks):
        return Duration(least_ms, None, True)
    if sum(result.drives(body) for body in bodies) > 1:
        return Duration(0, None)
    bounds = [one.most_ms for one in durations if one.most_ms is not None]
    most_ms = max(bounds) if len(bounds) == len(durations) else None
    return Duration(least_ms, most_ms, any(one.never_ends for one in durations))


class _Durations:
    """Those of the bodies of one program."""

    def __init__(self, program: ir.Program, kit: Kit) -> None:
        self.kit = kit
        self.turn_ms = 1 if program.tasks else 0  # what a turn of a loop takes that has no wait
        self.known: list[Duration] = []
        self.procedures = program.procedures
        for procedure in program.procedures:
            self.known.append(self.duration_of(procedure.body))

    def drives(self, body: ir.Body) -> bool:
        """Whether a body has a move or an S, or calls something that has one."""
        return any(
            isinstance(call, ir.Stop) or (isinstance(call, ir.Move) and call.power is not None)
            for call in ir.walk_with_calls(body, self.procedures)
        )

    def duration_of(self, body: ir.Body) -> Duration:
        least_ms, most_ms = 0, 0
        for statement in body:
            part = self.statement(statement)
            least_ms += part.least_ms
            if part.never_ends:
                return Duration(least_ms, None, True)
            if part.most_ms is None:
                most_ms = -1
            elif most_ms >= 0:
                most_ms += part.most_ms
        return Duration(least_ms, None if most_ms < 0 else most_ms)

    def statement(self, statement: ir.Statement) -> Duration:
        if isinstance(statement, ir.Move):
            if statement.time is None and statement.until is None:
                return Duration(0, None, True)
            longest = self.way(statement) if statement.unit else _time(statement.time)
            return longest if statement.until is None else Duration(0, longest.most_ms)
        if isinstance(statement, ir.Beep):
            return _time(statement.time)
        if isinstance(statement, ir.Call):
            return self.known[statement.procedure]
        if isinstance(statement, ir.If):
            arms = [self.duration_of(body) for body in ir.bodies(statement)]
            bounds = [arm.most_ms for arm in arms if arm.most_ms is not None]
            most_ms = max(bounds) if len(bounds) == len(arms) else None
            never_ends = all(arm.never_ends for arm in arms)
            return Duration(min(arm.least_ms for arm in arms), most_ms, never_ends)
        if isinstance(statement, (ir.Loop, ir.While)):
            return self.loop(statement)
        return _NONE

    def way(self, move: ir.Move) -> Duration:
        """How long a move takes by its way; one that faults ends the program."""
        try:
            time_ms = way_ms(move, self.kit)
        except Fault:
            time_ms = None
        return _UNKNOWN if time_ms is None else Duration(time_ms, time_ms)

    def loop(self, loop: ir.Loop | ir.While) -> Duration:
        body = self.duration_of(loop.body)
        if isinstance(loop, ir.Loop) and loop.times is None:
            return _UNKNOWN if ir.breaks_out(loop.body) else Duration(0, None, True)
        count = known_value(loop.times) if isinstance(loop, ir.Loop) else None
        if body.least_ms == 0 and body.most_ms is not None:
            body = body._replace(most_ms=body.most_ms + self.turn_ms)
        if count is None:
            return _UNKNOWN if isinstance(loop, ir.While) or body.most_ms != 0 else _NONE
        times = max(whole(count), 0)
        if body.never_ends and times and not ir.breaks_out(loop.body):
            return Duration(body.least_ms, None, True)
        most_ms = None if body.most_ms is None else times * body.most_ms
        return Duration(0 if ir.breaks_out(loop.body) else times * body.least_ms, most_ms)


def _time(time: ir.Expression | None) -> Duration:
    value = known_value(time)
    return _UNKNOWN if value is None else Duration(max(value, 0), max(value, 0))
