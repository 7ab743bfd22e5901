"""How long a program runs, if this can be known in advance.

Knows the checked program. Only moves, waits and beeps count; readings and other instructions take
no time.
"""

from __future__ import annotations

from typing import NamedTuple

from tiniscript.fixed_point import whole
from tiniscript.semantics.ir import (
    Beep,
    Body,
    Call,
    Expression,
    If,
    Loop,
    Move,
    Program,
    Statement,
    While,
    bodies,
    loops_end,
)
from tiniscript.semantics.optimizer import constant, fold


class Duration(NamedTuple):
    """Milliseconds from `least` to `most`, which is None without an upper bound.

    `never_ends`: the program never ends by itself.
    """

    least: int
    most: int | None
    never_ends: bool = False


_NONE = Duration(0, 0)
_UNKNOWN = Duration(0, None)


def duration(program: Program) -> Duration:
    """Return how long `program`, best an optimised one, runs."""
    known: list[Duration] = []
    for procedure in program.procedures:
        known.append(_body(procedure.body, known))
    return _body(program.body, known)


def _body(body: Body, known: list[Duration]) -> Duration:
    least, most = 0, 0
    for statement in body:
        this = _statement(statement, known)
        least += this.least
        if this.never_ends:
            return Duration(least, None, True)
        if this.most is None:
            most = -1
        elif most >= 0:
            most += this.most
    return Duration(least, None if most < 0 else most)


def _statement(statement: Statement, known: list[Duration]) -> Duration:
    if isinstance(statement, Move):
        longest = _time(statement.time)
        return longest if statement.until is None else Duration(0, longest.most)
    if isinstance(statement, Beep):
        return _time(statement.time)
    if isinstance(statement, Call):
        return known[statement.procedure]
    if isinstance(statement, If):
        arms = [_body(body, known) for body in bodies(statement)]
        bounds = [arm.most for arm in arms if arm.most is not None]
        most = max(bounds) if len(bounds) == len(arms) else None
        return Duration(min(arm.least for arm in arms), most, all(arm.never_ends for arm in arms))
    if isinstance(statement, (Loop, While)):
        return _loop(statement, known)
    return _NONE


def _time(time: Expression | None) -> Duration:
    value = None if time is None else constant(fold(time))
    return _UNKNOWN if value is None else Duration(max(value, 0), max(value, 0))


def _loop(loop: Loop | While, known: list[Duration]) -> Duration:
    body = _body(loop.body, known)
    if isinstance(loop, Loop) and loop.times is None:
        return _UNKNOWN if loops_end(loop.body) else Duration(0, None, True)
    count = None if isinstance(loop, While) or loop.times is None else constant(fold(loop.times))
    if count is None:
        return _UNKNOWN if isinstance(loop, While) or body.most != 0 else _NONE
    times = max(whole(count), 0)
    if body.never_ends and times and not loops_end(loop.body):
        return Duration(body.least, None, True)
    most = None if body.most is None else times * body.most
    return Duration(0 if loops_end(loop.body) else times * body.least, most)
