"""The lint: warnings about a program that has no mistakes.

Knows the IR, before it is optimised. Gives warnings, never mistakes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from tiniscript.base.fixed_point import as_text, whole
from tiniscript.base.kit import Kit
from tiniscript.base.source import Source, Span
from tiniscript.base.words import said_of
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Code, Diagnostic
from tiniscript.semantics import ir
from tiniscript.semantics.invariant_conditions import InvariantConditions
from tiniscript.semantics.kept_motors import kept_motors
from tiniscript.semantics.late_conditions import LateConditions
from tiniscript.semantics.named_values import use_of
from tiniscript.semantics.optimizer import fold, known_value, sure_fault
from tiniscript.semantics.suspicious_values import (
    of_beep,
    of_move,
    of_way,
    swapped_names,
    swapped_rounds,
)
from tiniscript.semantics.unseen_motors import unseen

_LASTING = (ir.Move, ir.Beep, ir.Motors)


class _Around(NamedTuple):
    """What a body is in: `loop` repeats it itself, `is_last` where the program ends with it."""

    loop: ir.Loop | ir.While | None = None
    is_repeated: bool = False  # by a loop, or in a DEF
    is_last: bool = False
    asked: frozenset[int] = frozenset()  # sensors of the conditions around it
    outermost: ir.Loop | ir.While | None = None  # of the loops around it


class _Look:
    """What is known of one program while it is looked at; `found` are its warnings."""

    def __init__(self, program: ir.Program, kit: Kit, source: Source) -> None:
        self.program = program
        self.kit = kit
        self.source = source
        self.late = LateConditions(program, kit, source)
        self.frozen = InvariantConditions(program, kit, source)
        self.found: list[Diagnostic] = []


def lint(program: ir.Program, kit: Kit, source: Source) -> list[Diagnostic]:
    """Return the warnings for a program that has no mistakes."""
    look = _Look(program, kit, source)
    for procedure in program.procedures:
        _look_at(procedure.body, look, _Around(is_repeated=True))
    for task in program.tasks:
        _expressions(task, look.found)
        _look_at(task.body, look, _Around(is_repeated=task.look is not None))
    _look_at(program.body, look, _Around(is_last=True))
    found = [*look.found, *look.late.found, *look.frozen.found, *swapped_names(program)]
    found += swapped_rounds(source)
    if program.tasks:
        from tiniscript.semantics.brief_tasks import brief_tasks  # few programs have any

        found += kept_motors(program, source)
        found += brief_tasks(program, source)
    found += _unused(program, kit, [*ir.every(program), *program.tasks])
    return found


def _report(found: list[Diagnostic], code: Code, span: Span, **values: str) -> None:
    found.append(Diagnostic(code, span, values))


def _look_at(body: ir.Body, look: _Look, around: _Around) -> None:
    found, program = look.found, look.program
    look.late.look_at(body, around.loop)
    found += unseen(body, around.is_last, look.source)
    for k, statement in enumerate(body):
        if k + 1 < len(body) and not ir.goes_on((statement,)):
            _never_reached(statement, body[k + 1], look)
            break
    for statement in body:
        _expressions(statement, found)
        if not program.tasks:  # what one asks another may change
            look.frozen.look_at(statement, around.is_repeated, around.asked, around.outermost)
        if isinstance(statement, ir.Move):
            if statement.unit:
                found += of_way(statement, look.kit)
            else:
                found += of_move(statement, look.kit, look.source)
        if isinstance(statement, ir.Beep):
            found += of_beep(statement)
        asks = isinstance(statement, (ir.If, ir.While))
        inside = around._replace(
            loop=None,
            is_last=around.is_last and isinstance(statement, ir.If) and statement is body[-1],
            asked=around.asked | ir.named("SENSOR", [statement] if asks else []),
        )
        if isinstance(statement, (ir.Loop, ir.While)):
            outermost = around.outermost or statement
            inside = inside._replace(loop=statement, is_repeated=True, outermost=outermost)
            _odd_times(statement, found)
            done = ir.with_calls(statement.body, program.procedures)
            if _is_forever(statement) and not (
                program.tasks  # there each turn of a loop takes time
                or ir.loops_end(statement.body)
                or any(isinstance(each, _LASTING) for each in done)
            ):
                word = "LOOP(FOREVER)" if isinstance(statement, ir.Loop) else "WHILE"
                head = Span(statement.span.start, statement.span.start + len(word))
                _report(found, codes.BUSY_LOOP, head, word=word)
        for inner in ir.bodies(statement):
            _look_at(inner, look, inside)


def _never_reached(before: ir.Statement, after: ir.Statement, look: _Look) -> None:
    """What stands behind a loop without an end, or behind BREAK."""
    values = {"found": look.source[after.span].split("\n")[0]}
    if isinstance(before, ir.Loop):
        values["line"] = str(look.source.position(before.span.start)[0])
    elif isinstance(before, ir.Break):
        values["ends"] = "BREAK"
    look.found.append(Diagnostic(codes.NEVER_REACHED, after.span, values))


def _expressions(statement: ir.Statement | ir.Task, found: list[Diagnostic]) -> None:
    for expression in ir.expressions(statement):
        fault = sure_fault(fold(expression))
        if fault:
            _report(found, codes.WILL_FAULT, statement.span, fault=fault)
            return


def _odd_times(loop: ir.Loop | ir.While, found: list[Diagnostic]) -> None:
    """`LOOP(0)`, `LOOP(-1)`, which other languages take for one without an end; `LOOP(4.5)`."""
    times = known_value(loop.times) if isinstance(loop, ir.Loop) else None
    if times is not None and times < 500:  # it is rounded
        head = Span(loop.span.start, loop.span.start + len("LOOP"))
        _report(found, codes.NEVER_REPEATS, head, times=as_text(times))
    elif times is not None and times % 1000:
        head = Span(loop.span.start, loop.span.start + len("LOOP"))
        _report(found, codes.ROUNDED_TIMES, head, times=as_text(times), right=str(whole(times)))


def _is_forever(statement: ir.Loop | ir.While) -> bool:
    if isinstance(statement, ir.Loop):
        return statement.times is None
    return known_value(statement.condition) == 1


def _unused(
    program: ir.Program, kit: Kit, statements: Sequence[ir.Statement | ir.Task]
) -> Iterator[Diagnostic]:
    used = ir.named("VARIABLE", statements)
    owners = {k: procedure for procedure in program.procedures for k in procedure.values}
    for statement in statements:
        if isinstance(statement, ir.Assign) and statement.variable not in used:
            used.add(statement.variable)  # said once
            name = program.variables[statement.variable]
            device = name if said_of(name, "device") else ""
            values = {"name": name, "device": device, "example": use_of(name)}
            if statement.variable in owners:
                values["own"] = owners[statement.variable].name
            yield Diagnostic(codes.UNUSED_VARIABLE, statement.span, values)
    yield from _unused_readings(kit, statements)
    called = {each.procedure for each in statements if isinstance(each, ir.Call)}
    for number, procedure in enumerate(program.procedures):
        if number not in called:
            span = Span(procedure.span.start, procedure.span.start + len("DEF"))
            values = {"name": procedure.name}
            if procedure.values:
                names = ", ".join(program.variables[k] for k in procedure.values)
                values["usage"] = f"{procedure.name}({names})"
            yield Diagnostic(codes.UNUSED_DEF, span, values)


def _unused_readings(
    kit: Kit, statements: Sequence[ir.Statement | ir.Task]
) -> Iterator[Diagnostic]:
    """`SI|DISTANCE`, where nothing asks for the distance: it is measured, and nobody sees it."""
    asked = ir.named("SENSOR", statements)
    for statement in statements:
        if isinstance(statement, ir.Read) and statement.sensor not in asked:
            asked.add(statement.sensor)  # said once
            name = kit.sensors[statement.sensor].name
            values = {"name": name, "fix": f"SHOW({name})"}
            yield Diagnostic(codes.UNUSED_READING, statement.span, values)
