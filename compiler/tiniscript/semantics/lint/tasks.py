"""Warns of tasks: of two that drive at once, of one alone, and of one that is over too soon.

The lower of two waits, or never gets the motors; that is not said where a task lets the motors go
now and then, as far as that can be seen. `TASK;BEEP(0.2, 440);W(1);END_TASK` waits before nothing,
and after `WHEN(DISTANCE < 10);S;END_WHEN` a loop drives on.
"""

from __future__ import annotations

import re
from functools import partial

from tiniscript.base.source import Edit, Source, Span
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic, Repair
from tiniscript.semantics import ir
from tiniscript.semantics.lint.context import LintContext
from tiniscript.semantics.optimizer import known_value

_WHEN_HEADER = r"(?i)WHEN[ \t]*(\(.*\))[ \t]*(?=$|[;\r\n]|//)"
_MOST_INSTRUCTIONS = 6  # instructions that a suggestion shows
_INSTANT_STATEMENTS = (ir.Read, ir.Assign, ir.Show, ir.Set, ir.Stop, ir.Call)


def report_kept_motors(context: LintContext) -> None:
    """Warn of each task that waits for a higher TASK, or never drives again."""
    program = context.program
    motors = _Motors(program)
    all_of = partial(ir.walk_with_calls, procedures=program.procedures)
    higher_bodies = [task.body for task in program.tasks if task.until is not None]
    tasks = [task for task in program.tasks if task.until is None]
    lower_bodies = [*(task.body for task in tasks), program.body]
    for task in tasks:
        del lower_bodies[0]
        is_stopped = any(
            isinstance(item, ir.Stop) for body in higher_bodies for item in all_of(body)
        )
        if not is_stopped and motors.are_kept(task.body):
            line = str(context.source.position(task.span.start)[0])
            for body in lower_bodies:
                waiting_move = next(filter(_is_move, all_of(_endless_part(body))), None)
                if waiting_move is not None:
                    context.report(codes.NO_MOTORS, waiting_move.span, line=line)
            return
        higher_bodies.append(task.body)
    _take_turns([task.body for task in tasks], context)


def _take_turns(tasks: list[ir.Body], context: LintContext) -> None:
    """`TASK;F(4, 60);END_TASK;TASK;R(4, 60);END_TASK`: they take turns, and make no curve."""
    first_moves = [body[0] for body in (*tasks, context.program.body) if body and _is_move(body[0])]
    if len(first_moves) < 2 or not tasks[0] or first_moves[0] is not tasks[0][0]:
        return
    first = context.source[first_moves[0].span]
    values = {"first": first, "both": "M(60, 30);W(4)"}
    spans = sorted(item.span for body in (*tasks, context.program.body) for item in body)
    orders = [context.source[span] for span in spans]
    if len(orders) <= _MOST_INSTRUCTIONS and not any("\n" in order for order in orders):
        values["after"] = ";".join(orders)
    for item in first_moves[1:]:
        context.report(codes.NO_MOTORS, item.span, **values)


class _Motors:
    def __init__(self, program: ir.Program) -> None:
        self._procedures = program.procedures

    def are_kept(self, body: ir.Body) -> bool:
        """Whether a task surely drives for ever at its end, and never lets the motors go there."""
        rest = _endless_part(body)
        if not any(
            isinstance(item, ir.Motors) or (_is_move(item) and _takes_time(item)) for item in rest
        ):
            return False
        return (
            self._wants_motors_in_loop(rest, False) is not None
            or self._wants_motors_in_loop(rest, True) is True
        )

    def _wants_motors_after(self, body: ir.Body, is_wanted: bool) -> bool | None:
        """Return whether the motors are wanted after a body, None where it may let them go."""
        result: bool | None = is_wanted
        for call in body:
            if result is None or isinstance(call, ir.Break):
                return None
            if isinstance(call, ir.Motors):
                result = True
            elif isinstance(call, ir.Stop) or _is_move(call):
                result = False
            elif isinstance(call, (ir.Move, ir.Beep)):
                result = result or None
            elif isinstance(call, ir.Call):
                result = self._wants_motors_after(self._procedures[call.procedure].body, result)
            elif isinstance(call, ir.If):
                arms = [self._wants_motors_after(arm, result) for arm in ir.bodies(call)]
                result = None if None in arms else all(arms)
            elif isinstance(call, (ir.Loop, ir.While)):
                result = self._wants_motors_in_loop(call.body, result)
        return result

    def _wants_motors_in_loop(self, body: ir.Body, is_wanted: bool) -> bool | None:
        once = self._wants_motors_after(body, is_wanted)
        if once is None or self._wants_motors_after(body, once) is None:
            return None
        takes_time = once or any(map(_takes_time, body))  # else a turn of it waits for 1 ms
        return is_wanted and once if takes_time else None


def report_brief_tasks(context: LintContext) -> None:
    """Warn of a TASK that is done once, and of a WHEN whose S lasts no longer than its answer."""
    program = context.program
    lower_bodies = [program.body, *(task.body for task in program.tasks if task.until is None)]
    driving_statements = [
        body[-1] for body in lower_bodies
        if any(map(_is_move, ir.walk_with_calls(_endless_part(body), program.procedures)))
    ]  # fmt: skip
    for task in program.tasks:
        statements = [*ir.walk_with_calls(task.body, program.procedures)]
        if task.until is None:
            if task.body and _is_pause(task.body[-1]) and not any(map(_repeats, statements)):
                context.diagnostics.append(_single_run_diagnostic(task, context.source))
        elif driving_statements and known_value(task.until.condition) is None:
            is_brief = all(isinstance(item, _INSTANT_STATEMENTS) for item in statements)
            if is_brief and any(isinstance(item, ir.Stop) for item in statements):
                _report_resumed_move(task, driving_statements[0], context)


def _is_pause(statement: ir.Statement) -> bool:
    is_move = isinstance(statement, ir.Move) and statement.power is None
    return is_move and statement.until is None  # type: ignore[union-attr]


def _repeats(statement: ir.Statement) -> bool:
    return isinstance(statement, (ir.Loop, ir.While))


def _single_run_diagnostic(task: ir.Task, source: Source) -> Diagnostic:
    """It says to write a loop around all of it, on lines of its own where the TASK has them."""
    text = source[task.span]
    end = re.search(r"\w+\Z", text)
    assert end is not None
    after, before = task.word.end, task.span.start + end.start()
    separator = "\n" if "\n" in text else ";"
    edits = (Edit(Span(after, after), f"{separator}LOOP(FOREVER)"),
             Edit(Span(before, before), f"END_LOOP{separator}"))  # fmt: skip
    return Diagnostic(codes.TASK_DONE_ONCE, task.word, {}, None, Repair(edits, False))


def report_lone_task(context: LintContext) -> None:
    """`TASK;F(5, 50);BEEP(5, 440);END_TASK` alone: in it one comes after the other."""
    program = context.program
    is_idle = all(isinstance(each, (ir.Read, ir.Assign)) for each in program.body)
    (task, *other_tasks) = program.tasks
    if other_tasks or task.until is not None or not task.body or not is_idle:
        return
    text = context.source[task.span]
    statements = [each for each in task.body if not isinstance(each, ir.Read)]
    moves_last = sorted(statements, key=_is_move)
    if [*map(_is_move, moves_last)] != [False, True] or not isinstance(moves_last[0], ir.Beep):
        context.report(codes.LONE_TASK, task.word)
        return
    parts = [
        "TASK",
        context.source[moves_last[0].span],
        "END_TASK",
        context.source[moves_last[1].span],
    ]
    edit = Edit(task.span, ("\n" if "\n" in text else ";").join(parts))
    repair = (
        None if "//" in text or not isinstance(moves_last[1], ir.Move) else Repair((edit,), False)
    )
    values = {"fix": ";".join(parts)} if repair else {}
    place = task.span if repair else None
    context.diagnostics.append(Diagnostic(codes.LONE_TASK, task.word, values, place, repair))


def _report_resumed_move(
    task: ir.Task, driving_statements: ir.Statement, context: LintContext
) -> None:
    head = re.match(_WHEN_HEADER, context.source[task.span])
    values = {"line": str(context.source.position(driving_statements.span.start)[0])}
    if head is not None:
        ended_move = (
            f"IF{head[1]};BREAK;ENDIF"
            if isinstance(driving_statements, ir.Loop)
            else f"UNTIL{head[1]}"
        )
        values["ended"] = ended_move
    # a DEF that is called may have it
    stops = [each for each in task.body if isinstance(each, (ir.Stop, ir.Call))]
    stop = min(stops, key=lambda each: isinstance(each, ir.Call))
    context.report(codes.WHEN_GOES_ON, stop.span, **values)


def _endless_part(body: ir.Body) -> ir.Body:
    """Return what a body does for ever at its end: a move, or what a loop repeats."""
    last = body[-1] if body else None
    if isinstance(last, ir.Loop) and last.times is None:
        return last.body
    is_move = isinstance(last, ir.Move) and last.time is None and last.until is None
    return body[-1:] if is_move else ()


def _is_move(statement: ir.Statement) -> bool:
    return isinstance(statement, ir.Motors) or (
        isinstance(statement, ir.Move) and statement.power is not None
    )


def _takes_time(statement: ir.Statement) -> bool:
    """Whether a statement surely takes time."""
    if not isinstance(statement, (ir.Move, ir.Beep)):
        return False
    if isinstance(statement, ir.Move) and (statement.time is None or statement.until is not None):
        return statement.until is None
    assert statement.time is not None
    return (known_value(statement.time) or 0) > 0
