"""Warns of a key or a stick that is read only once: `SI|IF(KEY_UP);F(1, 60);ENDIF`.

Nobody holds it at just that moment. What repeats reads it again: a loop, a WHEN, UNTIL; a DEF may
be called in one. After a loop or a move that waits for the remote control somebody may hold it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from collections.abc import Set as AbstractSet

from tiniscript.base.source import Edit, Span
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic, Repair
from tiniscript.semantics import ir
from tiniscript.semantics.lint.look import LintContext

_LASTING_STATEMENTS = (ir.Move, ir.Beep, ir.Loop, ir.While, ir.Call)
_VISIBLE_STATEMENTS = (ir.Move, ir.Beep, ir.Motors)


def report_asked_once(look: LintContext, remote: AbstractSet[int]) -> None:
    """Report the first of these readings: what is repeated around it has the others in it, too."""
    program = look.program
    for body in (program.body, *(task.body for task in program.tasks if task.look is None)):
        is_early = True
        for statement in _statements_done_once(body):
            read = next((item for item in _read(statement) if item[0] in remote), None)
            if read is not None:
                look.diagnostics.append(_diagnostic(*read, statement, body, is_early, look))
                return
            done = ir.walk_with_calls((statement,), program.procedures)
            if not isinstance(statement, ir.If) and remote & ir.referenced_numbers("SENSOR", done):
                break  # it has been waited for
            is_early = is_early and not isinstance(statement, _LASTING_STATEMENTS)


def _statements_done_once(body: ir.Body) -> Iterator[ir.Statement]:
    """Yield the statements that no loop repeats, in their order."""
    for statement in body:
        yield statement
        if isinstance(statement, ir.If):
            for inner in ir.bodies(statement):
                yield from _statements_done_once(inner)


def _read(statement: ir.Statement) -> Iterator[tuple[int, Span]]:
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
    is_early: bool,
    look: LintContext,
) -> Diagnostic:
    name = look.kit.readings[sensor].name
    values = {"early" if is_early else "name": name}
    if isinstance(statement, ir.If) and (question := look.condition(span, "IF")):
        values["question"] = question
    text = look.source[span]
    place = re.search(rf"(?i)\b{name}\b", text)
    named = Span(span.start + place.start(), span.start + place.end()) if place else span
    return Diagnostic(codes.ASKED_ONCE, named, values, None, _loop_repair(span, body, look))


def _loop_repair(span: Span, body: ir.Body, look: LintContext) -> Repair | None:
    """Put a loop around what is read once and all that follows, where the rest takes time."""
    rest = [each for each in body if each.span.end > span.start]
    if not any(
        isinstance(item, _VISIBLE_STATEMENTS)
        for item in ir.walk_with_calls((*rest,), look.program.procedures)
    ):
        return None
    first, end = rest[0], rest[-1].span.end
    start = first.arms[0].span.start if isinstance(first, ir.If) else first.span.start
    between = "\n" if "\n" in look.source.text[start:end] else ";"
    edits = (Edit(Span(start, start), f"LOOP(FOREVER){between}"),
             Edit(Span(end, end), f"{between}END_LOOP"))  # fmt: skip
    return Repair(edits, False)
