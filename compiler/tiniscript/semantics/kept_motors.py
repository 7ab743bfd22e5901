"""Warns where two tasks drive at once: the lower one waits, or never gets the motors.

Is silent where a task lets the motors go now and then, as far as that can be seen. Knows the IR,
before it is optimised.
"""

from __future__ import annotations

from functools import partial

from tiniscript.base.source import Source
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.semantics import ir
from tiniscript.semantics.optimizer import known_value


def kept_motors(program: ir.Program, source: Source) -> list[Diagnostic]:
    """Return a warning for each task that waits for a higher TASK, or never drives again."""
    motors = _Motors(program)
    all_of = partial(ir.with_calls, procedures=program.procedures)
    higher = [each.body for each in program.tasks if each.look is not None]
    tasks = [each for each in program.tasks if each.look is None]
    lower = [*(each.body for each in tasks), program.body]
    for task in tasks:
        del lower[0]
        is_stopped = any(isinstance(each, ir.Stop) for body in higher for each in all_of(body))
        if not is_stopped and motors.are_kept(task.body):
            line = str(source.position(task.span.start)[0])
            waiting = [next(filter(drives, all_of(endless(body))), None) for body in lower]
            return [Diagnostic(codes.NO_MOTORS, each.span, {"line": line})
                    for each in waiting if each is not None]  # fmt: skip
        higher.append(task.body)
    return _waiting(program, [each.body for each in tasks], source)


def _waiting(program: ir.Program, tasks: list[ir.Body], source: Source) -> list[Diagnostic]:
    """`TASK;F(4, 60);END_TASK;TASK;R(4, 60);END_TASK`: they take turns, and make no curve."""
    begin = [body[0] for body in (*tasks, program.body) if body and drives(body[0])]
    if len(begin) < 2 or not tasks[0] or begin[0] is not tasks[0][0]:
        return []
    values = {"first": source[begin[0].span], "both": "M(60, 30);W(4)"}
    return [Diagnostic(codes.NO_MOTORS, each.span, values) for each in begin[1:]]


class _Motors:
    def __init__(self, program: ir.Program) -> None:
        self._procedures = program.procedures

    def are_kept(self, body: ir.Body) -> bool:
        """Whether a task surely drives for ever at its end, and never lets the motors go there."""
        rest = endless(body)
        if not any(isinstance(each, ir.Motors) or (drives(each) and _lasts(each)) for each in rest):
            return False
        return self._repeated(rest, False) is not None or self._repeated(rest, True) is True

    def _after(self, body: ir.Body, wants: bool) -> bool | None:
        """Return whether the motors are wanted behind a body, None where it may let them go."""
        found: bool | None = wants
        for each in body:
            if found is None or isinstance(each, ir.Break):
                return None
            if isinstance(each, ir.Motors):
                found = True
            elif isinstance(each, ir.Stop) or drives(each):
                found = False
            elif isinstance(each, (ir.Move, ir.Beep)):
                found = found or None
            elif isinstance(each, ir.Call):
                found = self._after(self._procedures[each.procedure].body, found)
            elif isinstance(each, ir.If):
                arms = [self._after(arm, found) for arm in ir.bodies(each)]
                found = None if None in arms else all(arms)
            elif isinstance(each, (ir.Loop, ir.While)):
                found = self._repeated(each.body, found)
        return found

    def _repeated(self, body: ir.Body, wants: bool) -> bool | None:
        once = self._after(body, wants)
        if once is None or self._after(body, once) is None:
            return None
        takes_time = once or any(map(_lasts, body))  # else a turn of it waits for 1 ms
        return wants and once if takes_time else None


def endless(body: ir.Body) -> ir.Body:
    """Return what a body does for ever at its end: a move, or what a loop repeats."""
    last = body[-1] if body else None
    if isinstance(last, ir.Loop) and last.times is None:
        return last.body
    is_move = isinstance(last, ir.Move) and last.time is None and last.until is None
    return body[-1:] if is_move else ()


def drives(statement: ir.Statement) -> bool:
    return isinstance(statement, ir.Motors) or (
        isinstance(statement, ir.Move) and statement.power is not None
    )


def _lasts(statement: ir.Statement) -> bool:
    """Whether a statement surely takes time."""
    if not isinstance(statement, (ir.Move, ir.Beep)):
        return False
    if isinstance(statement, ir.Move) and (statement.time is None or statement.until is not None):
        return statement.until is None
    assert statement.time is not None
    return (known_value(statement.time) or 0) > 0
