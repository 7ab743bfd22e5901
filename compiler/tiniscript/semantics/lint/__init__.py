"""The linter: warnings about programs that compile, but may not do what was meant.

`TABLE` has all of them: the codes, where each is looked for, and what finds it there. Warnings that
cannot be found in a checked program are in `FOUND_ELSEWHERE`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, get_args

from tiniscript.base.kit import Kit
from tiniscript.base.source import Source
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Code, Diagnostic
from tiniscript.semantics import ir
from tiniscript.semantics.lint import conditions, known, moves, numbers, tasks, useless
from tiniscript.semantics.lint.context import BodyContext, LintContext
from tiniscript.syntax.lexer import Scan

# Where to look for a warning, if not at statements of a type.
PROGRAM, TASKS, BODY, STATEMENT = "program", "tasks", "body", "statement"


class Row(NamedTuple):
    """A rule for these codes. Called once for the PROGRAM, or for its TASKS: with the
    `LintContext`; for each BODY and each STATEMENT, or those of a type: with its context.
    """

    codes: tuple[Code, ...]
    target: str | type
    report: Callable[..., None]


TABLE = (
    # Unlikely numbers.
    Row((codes.WILL_FAULT,), STATEMENT, numbers.report_will_fault),
    Row(
        (codes.ZERO_TIME_MOVE, codes.WILL_FAULT, codes.SWAPPED, codes.LONG_TIME,
         codes.LITTLE_POWER, codes.ZERO_BEFORE, codes.CUT_VALUE),
        ir.Move, numbers.check_move,
    ),
    Row((codes.SWAPPED,), ir.Move, numbers.report_swapped_names),
    Row((codes.SWAPPED,), PROGRAM, numbers.report_swapped_rounds),
    Row((codes.ZERO_TIME_MOVE, codes.LONG_TIME, codes.CUT_VALUE), ir.Act, numbers.check_act),
    Row((codes.LONG_TIME,), STATEMENT, numbers.check_clock),
    Row((codes.NEVER_REPEATS, codes.ROUNDED_TIMES), ir.Loop, numbers.check_times),
    # Conditions that never become true.
    Row((codes.FROZEN_UNTIL, codes.TURNED_ROUND, codes.EXACT, codes.KNOWN_ANSWER),
        ir.Move, conditions.check_until),
    Row((codes.FROZEN_WHILE, codes.TURNED_ROUND, codes.KNOWN_ANSWER),
        ir.While, conditions.check_while),
    Row((codes.FROZEN_WHILE, codes.LATE_ARM, codes.EXACT, codes.KNOWN_ANSWER),
        ir.If, conditions.check_if),
    Row((codes.FROZEN_WHILE,), ir.Show, conditions.check_show),
    Row((codes.ASKED_ONCE,), PROGRAM, conditions.report_asked_once),
    # Rules that hold whatever the robot meets.
    Row((codes.KNOWN_ANSWER,), PROGRAM, known.report_past_clock),
    Row((codes.KNOWN_ANSWER,), STATEMENT, known.report_narrowed),
    Row((codes.EXACT,), ir.If, known.report_no_room),
    Row((codes.NEW_THROW,), ir.If, known.report_thrown_arms),
    Row((codes.NEW_THROW,), BODY, known.report_thrown_again),
    # Rules about the effects of a move.
    Row((codes.LATE_CHECK, codes.IDLE_STOP), BODY, moves.report_late_conditions),
    Row((codes.UNSEEN_MOTORS,), BODY, moves.report_unseen_motors),
    # Rules about code without effect.
    Row((codes.NEVER_REACHED,), BODY, useless.report_never_reached),
    Row((codes.EMPTY_BLOCK,), BODY, useless.report_empty_blocks),
    Row((codes.BUSY_LOOP,), ir.Loop, useless.report_busy_loop),
    Row((codes.BUSY_LOOP,), ir.While, useless.report_busy_loop),
    Row((codes.UNUSED_VARIABLE,), PROGRAM, useless.report_unused_variables),
    Row((codes.UNUSED_READING,), PROGRAM, useless.report_unused_readings),
    Row((codes.UNUSED_DEF,), PROGRAM, useless.report_unused_defs),
    Row((codes.IN_A_NOTE,), PROGRAM, useless.report_instructions_in_notes),
    # tasks
    Row((codes.NO_MOTORS,), TASKS, tasks.report_kept_motors),
    Row((codes.TASK_DONE_ONCE, codes.WHEN_GOES_ON), TASKS, tasks.report_brief_tasks),
    Row((codes.LONE_TASK,), TASKS, tasks.report_lone_task),
)  # fmt: skip

# Findings without a program, or with the board: the module of each.
FOUND_ELSEWHERE: dict[Code, str] = {
    codes.ROUNDED: "syntax.expressions",
    codes.BOARD_MAY_BE_TOO_SMALL: "library.compiling",
    codes.GIVES_WAY: "syntax.later_words",
}


_STATEMENTS = (*get_args(ir.Statement), ir.Task)
_ROWS: dict[str | type, list[Row]] = {
    target: [
        row
        for row in TABLE
        if row.target == target or (row.target == STATEMENT and target in _STATEMENTS)
    ]
    for target in (PROGRAM, TASKS, BODY, *_STATEMENTS)
}


def lint(program: ir.Program, kit: Kit, source: Source, scan: Scan) -> list[Diagnostic]:
    """Return the warnings for a program that has no mistakes, of this text and these tokens."""
    context = LintContext(program, kit, source, scan)
    for procedure in program.procedures:
        _check_body(procedure.body, BodyContext(is_repeated=True), context)
    for task in program.tasks:
        for row in _ROWS[ir.Task]:
            row.report(task, BodyContext(), context)
        _check_body(task.body, BodyContext(is_repeated=task.until is not None), context)
    _check_body(program.body, BodyContext(is_last=True), context)
    for row in (*_ROWS[PROGRAM], *(_ROWS[TASKS] if program.tasks else ())):
        row.report(context)
    return context.diagnostics


def _check_body(body: ir.Body, body_context: BodyContext, context: LintContext) -> None:
    for row in _ROWS[BODY]:
        row.report(body, body_context, context)
    for statement in body:
        for row in _ROWS[type(statement)]:
            row.report(statement, body_context, context)
        inner_bodies = ir.bodies(statement)
        if inner_bodies:
            inner_context = _inner_context(statement, body_context, is_last=statement is body[-1])
            for inner_body in inner_bodies:
                _check_body(inner_body, inner_context, context)


def _inner_context(statement: ir.Statement, outer: BodyContext, is_last: bool) -> BodyContext:
    """Return the context of a statement's bodies; `is_last`: nothing follows it."""
    is_question = isinstance(statement, (ir.If, ir.While))
    inner = outer._replace(
        loop=None,
        is_last=outer.is_last and isinstance(statement, ir.If) and is_last,
        asked_sensors=outer.asked_sensors
        | ir.referenced_numbers("SENSOR", [statement] if is_question else []),
    )
    if not isinstance(statement, (ir.Loop, ir.While)):
        return inner
    outermost = outer.outermost or statement
    return inner._replace(loop=statement, is_repeated=True, outermost=outermost)
