"""Warns of a key or a stick that is read only once: `SI|IF(KEY_UP);F(1, 60);ENDIF`.

Nobody presses it at exactly that moment. Code that repeats reads it again: a loop, a WHEN, UNTIL,
or a DEF called in one. After a loop or a move that waits for the remote control somebody may hold
it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from collections.abc import Set as AbstractSet

from tiniscript.base.source import Edit, Span
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic, Repair
from tiniscript.semantics import ir
from tiniscript.semantics.lint.context import LintContext

_LONG_STATEMENTS = (ir.Loop, ir.While, ir.Call)
_SEEN_STATEMENTS = (ir.Move, ir.Act, ir.Motors)  # statements with a visible or audible effect


def report_asked_once(context: LintContext, remote: AbstractSet[int]) -> None:
    """Report the first of these readings: a loop around it contains the others, too."""
    program = context.program
    for body in (program.body, *(task.body for task in program.tasks if task.until is None)):
        is_before_loop = True
        for statement in _statements_done_once(body):
            reading = next(
                (
                    reading_and_span
                    for reading_and_span in _readings_of(statement)
                    if reading_and_span[0] in remote
                ),
                None,
            )
            if reading is not None:
                context.diagnostics.append(
                    _diagnostic(*reading, statement, body, is_before_loop, context)
                )
                return
            statements = ir.walk_with_calls((statement,), program.procedures)
            if not isinstance(statement, ir.If) and remote & ir.referenced_numbers(
                "SENSOR", statements
            ):
                break  # the program has waited for it
            is_long = ir.takes_time(statement) or isinstance(statement, _LONG_STATEMENTS)
            is_before_loop = is_before_loop and not is_long


def _statements_done_once(body: ir.Body) -> Iterator[ir.Statement]:
    """Yield the statements that no loop repeats, in their order."""
    for statement in body:
        yield statement
        if isinstance(statement, ir.If):
            for inner in ir.bodies(statement):
                yield from _statements_done_once(inner)


def _readings_of(statement: ir.Statement) -> Iterator[tuple[int, Span]]:
    """Yield the readings that a statement takes once, each with the place to point at."""
    if isinstance(statement, ir.While):
        return
    values = [(value, statement.span) for value in ir.values_of(statement).values()]
    if isinstance(statement, ir.If):
        values += [(arm.condition, arm.span) for arm in statement.arms]
    for value, span in values:
        yield from ((term.value, span) for term in value if term.op == "SENSOR")


def _diagnostic(
    sensor: int,
    span: Span,
    statement: ir.Statement,
    body: ir.Body,
    is_before_loop: bool,
    context: LintContext,
) -> Diagnostic:
    name = context.kit.readings[sensor].name
    values = {"early" if is_before_loop else "name": name}
    if isinstance(statement, ir.If) and (question := context.condition_text(span, "IF")):
        values["question"] = question
    text = context.source[span]
    name_match = re.search(rf"(?i)\b{name}\b", text)
    name_span = (
        Span(span.start + name_match.start(), span.start + name_match.end()) if name_match else span
    )
    return Diagnostic(codes.ASKED_ONCE, name_span, values, None, _loop_repair(span, body, context))


def _loop_repair(span: Span, body: ir.Body, context: LintContext) -> Repair | None:
    """Put a loop around a single reading and everything after it, if the rest takes time."""
    later_statements = [statement for statement in body if statement.span.end > span.start]
    if not any(
        isinstance(statement, _SEEN_STATEMENTS)
        for statement in ir.walk_with_calls((*later_statements,), context.program.procedures)
    ):
        return None
    first_statement, end = later_statements[0], later_statements[-1].span.end
    start = (
        first_statement.arms[0].span.start
        if isinstance(first_statement, ir.If)
        else first_statement.span.start
    )
    separator = "\n" if "\n" in context.source.text[start:end] else ";"
    edits = (Edit(Span(start, start), f"LOOP(FOREVER){separator}"),
             Edit(Span(end, end), f"{separator}END_LOOP"))  # fmt: skip
    return Repair(edits, False)
