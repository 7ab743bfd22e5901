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
_MAX_INSTRUCTIONS = 6  # instructions that a suggestion shows
_INSTANT_STATEMENTS = (ir.Read, ir.Assign, ir.Show, ir.Set, ir.Stop, ir.Call, ir.Act)


def report_kept_motors(context: LintContext) -> None:
    """Warn of each task that waits for a higher TASK, or never drives again."""
    program = context.program
    motor_use = _MotorUse(program)
    statements_of = partial(ir.walk_with_calls, procedures=program.procedures)
    higher_bodies = [task.body for task in program.tasks if task.until is not None]
    tasks = [task for task in program.tasks if task.until is None]
    lower_bodies = [*(task.body for task in tasks), program.body]
    for task in tasks:
        del lower_bodies[0]
        is_stopped = any(
            isinstance(statement, ir.Stop)
            for body in higher_bodies
            for statement in statements_of(body)
        )
        if not is_stopped and motor_use.keeps_motors(task.body):
            line = str(context.source.position(task.span.start)[0])
            for body in lower_bodies:
                waiting_move = next(filter(_is_move, statements_of(_endless_part(body))), None)
                if waiting_move is not None:
                    context.report(codes.NO_MOTORS, waiting_move.span, line=line)
            return
        higher_bodies.append(task.body)
    _report_taken_turns([task.body for task in tasks], context)


def _report_taken_turns(tasks: list[ir.Body], context: LintContext) -> None:
    """`TASK;F(4, 60);END_TASK;TASK;R(4, 60);END_TASK`: they take turns, and make no curve."""
    first_moves = [body[0] for body in (*tasks, context.program.body) if body and _is_move(body[0])]
    if len(first_moves) < 2 or not tasks[0] or first_moves[0] is not tasks[0][0]:
        return
    first_text = context.source[first_moves[0].span]
    values = {"first": first_text, "both": "M(60, 30);W(4)"}
    spans = sorted(statement.span for body in (*tasks, context.program.body) for statement in body)
    instructions = [context.source[span] for span in spans]
    if len(instructions) <= _MAX_INSTRUCTIONS and not any(
        "\n" in instruction for instruction in instructions
    ):
        values["after"] = ";".join(instructions)
    for move in first_moves[1:]:
        context.report(codes.NO_MOTORS, move.span, **values)


class _MotorUse:
    def __init__(self, program: ir.Program) -> None:
        self._procedures = program.procedures

    def keeps_motors(self, body: ir.Body) -> bool:
        """Return whether a task certainly drives forever at its end without releasing the
        motors.
        """
        endless_part = _endless_part(body)
        if not any(
            isinstance(statement, ir.Motors) or (_is_move(statement) and _takes_time(statement))
            for statement in endless_part
        ):
            return False
        return (
            self._wants_motors_in_loop(endless_part, False) is not None
            or self._wants_motors_in_loop(endless_part, True) is True
        )

    def _wants_motors_after(self, body: ir.Body, is_wanted: bool) -> bool | None:
        """Return whether the motors are wanted after a body, None if it may let them go."""
        is_wanted_now: bool | None = is_wanted
        for statement in body:
            if is_wanted_now is None or isinstance(statement, ir.Break):
                return None
            if isinstance(statement, ir.Motors):
                is_wanted_now = True
            elif isinstance(statement, ir.Stop) or _is_move(statement):
                is_wanted_now = False
            elif ir.takes_time(statement):
                is_wanted_now = is_wanted_now or None
            elif isinstance(statement, ir.Call):
                is_wanted_now = self._wants_motors_after(
                    self._procedures[statement.procedure].body, is_wanted_now
                )
            elif isinstance(statement, ir.If):
                arm_results = [
                    self._wants_motors_after(arm_body, is_wanted_now)
                    for arm_body in ir.bodies(statement)
                ]
                is_wanted_now = None if None in arm_results else all(arm_results)
            elif isinstance(statement, (ir.Loop, ir.While)):
                is_wanted_now = self._wants_motors_in_loop(statement.body, is_wanted_now)
        return is_wanted_now

    def _wants_motors_in_loop(self, body: ir.Body, is_wanted: bool) -> bool | None:
        is_wanted_after = self._wants_motors_after(body, is_wanted)
        if is_wanted_after is None or self._wants_motors_after(body, is_wanted_after) is None:
            return None
        takes_time = is_wanted_after or any(
            map(_takes_time, body)
        )  # otherwise a turn of the loop waits for 1 ms
        return is_wanted and is_wanted_after if takes_time else None


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
            is_brief = all(
                isinstance(statement, _INSTANT_STATEMENTS) and not ir.takes_time(statement)
                for statement in statements
            )
            if is_brief and any(isinstance(statement, ir.Stop) for statement in statements):
                _report_resumed_move(task, driving_statements[0], context)


def _is_pause(statement: ir.Statement) -> bool:
    is_move = isinstance(statement, ir.Move) and statement.power is None
    return is_move and statement.until is None  # type: ignore[union-attr]


def _repeats(statement: ir.Statement) -> bool:
    return isinstance(statement, (ir.Loop, ir.While))


def _single_run_diagnostic(task: ir.Task, source: Source) -> Diagnostic:
    """Return the diagnostic that suggests a loop around a TASK, on own lines if the TASK has
    them.
    """
    text = source[task.span]
    end_match = re.search(r"\w+\Z", text)
    assert end_match is not None
    header_end, end_start = task.word.end, task.span.start + end_match.start()
    separator = "\n" if "\n" in text else ";"
    edits = (Edit(Span(header_end, header_end), f"{separator}LOOP(FOREVER)"),
             Edit(Span(end_start, end_start), f"END_LOOP{separator}"))  # fmt: skip
    return Diagnostic(codes.TASK_DONE_ONCE, task.word, {}, None, Repair(edits, False))


def report_lone_task(context: LintContext) -> None:
    """`TASK;F(5, 50);BEEP(5, 440);END_TASK` alone: in it one comes after the other."""
    program = context.program
    is_idle = all(isinstance(statement, (ir.Read, ir.Assign)) for statement in program.body)
    (task, *other_tasks) = program.tasks
    if other_tasks or task.until is not None or not task.body or not is_idle:
        return
    text = context.source[task.span]
    statements = [statement for statement in task.body if not isinstance(statement, ir.Read)]
    moves_last = sorted(statements, key=_is_move)
    is_sound_with_move = [*map(_is_move, moves_last)] == [False, True] and (
        isinstance(moves_last[0], ir.Act) and ir.takes_time(moves_last[0])
    )
    if not is_sound_with_move:
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
    task: ir.Task, driving_statement: ir.Statement, context: LintContext
) -> None:
    header_match = re.match(_WHEN_HEADER, context.source[task.span])
    values = {"line": str(context.source.position(driving_statement.span.start)[0])}
    if header_match is not None:
        ended_move = (
            f"IF{header_match[1]};BREAK;ENDIF"
            if isinstance(driving_statement, ir.Loop)
            else f"UNTIL{header_match[1]}"
        )
        values["ended"] = ended_move
    # a DEF that is called may have it
    stops = [statement for statement in task.body if isinstance(statement, (ir.Stop, ir.Call))]
    stop = min(stops, key=lambda statement: isinstance(statement, ir.Call))
    context.report(codes.WHEN_GOES_ON, stop.span, **values)


def _endless_part(body: ir.Body) -> ir.Body:
    """Return the part of a body that repeats forever at its end: a move, or a loop's body."""
    last_statement = body[-1] if body else None
    if isinstance(last_statement, ir.Loop) and last_statement.times is None:
        return last_statement.body
    is_move = (
        isinstance(last_statement, ir.Move)
        and last_statement.time is None
        and last_statement.until is None
    )
    return body[-1:] if is_move else ()


def _is_move(statement: ir.Statement) -> bool:
    return isinstance(statement, ir.Motors) or (
        isinstance(statement, ir.Move) and statement.power is not None
    )


def _takes_time(statement: ir.Statement) -> bool:
    """Return whether a statement certainly takes time."""
    if isinstance(statement, ir.Move) and (statement.time is None or statement.until is not None):
        return statement.until is None
    if not isinstance(statement, (ir.Move, ir.Act)) or not ir.takes_time(statement):
        return False
    return (known_value(statement.time) or 0) > 0
