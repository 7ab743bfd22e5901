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
from tiniscript.semantics.optimizer import constant, fold, sure_fault
from tiniscript.semantics.suspicious_values import (
    of_beep,
    of_ended_move,
    of_move,
    of_way,
    swapped_names,
)
from tiniscript.semantics.unseen_motors import unseen


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

    @property
    def all_found(self) -> list[Diagnostic]:
        return [*self.found, *self.late.found, *self.frozen.found]


def lint(program: ir.Program, kit: Kit, source: Source) -> list[Diagnostic]:
    """Return the warnings for a program that has no mistakes."""
    look = _Look(program, kit, source)
    for procedure in program.procedures:
        look.found += swapped_names(procedure.body, program)
        _look_at(procedure.body, look, _Around(is_repeated=True))
    for task in program.tasks:
        _expressions(task, look.found)
        look.found += swapped_names(task.body, program)
        _look_at(task.body, look, _Around(is_repeated=task.look is not None))
    look.found += swapped_names(program.body, program)
    _look_at(program.body, look, _Around(is_last=True))
    found = [*look.all_found, *kept_motors(program, source)]
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
            elif statement.until is None:
                found += of_move(statement, look.kit, look.source)
            else:
                found += of_ended_move(statement, look.kit, look.source)
        if isinstance(statement, ir.Beep):
            found += of_beep(statement)
        inside = around._replace(
            loop=None,
            is_last=around.is_last and isinstance(statement, ir.If) and statement is body[-1],
            asked=around.asked | _asked(statement),
        )
        if isinstance(statement, (ir.Loop, ir.While)):
            outermost = around.outermost or statement
            inside = inside._replace(loop=statement, is_repeated=True, outermost=outermost)
            _odd_times(statement, found)
            if _is_forever(statement) and not (
                program.tasks  # there each turn of a loop takes time
                or ir.loops_end(statement.body)
                or _takes_time(statement.body, program)
            ):
                word = "LOOP(FOREVER)" if isinstance(statement, ir.Loop) else "WHILE"
                head = Span(statement.span.start, statement.span.start + len(word))
                _report(found, codes.BUSY_LOOP, head, word=word)
        for inner in ir.bodies(statement):
            _look_at(inner, look, inside)


def _asked(statement: ir.Statement) -> frozenset[int]:
    """Return the sensors that IF or WHILE asks before its body."""
    if not isinstance(statement, (ir.If, ir.While)):
        return frozenset()
    return _named("SENSOR", [statement])


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
    times = None if isinstance(loop, ir.While) or loop.times is None else constant(fold(loop.times))
    if times is not None and times < 500:  # it is rounded
        head = Span(loop.span.start, loop.span.start + len("LOOP"))
        _report(found, codes.NEVER_REPEATS, head, times=as_text(times))
    elif times is not None and times % 1000:
        head = Span(loop.span.start, loop.span.start + len("LOOP"))
        _report(found, codes.ROUNDED_TIMES, head, times=as_text(times), right=str(whole(times)))


def _is_forever(statement: ir.Loop | ir.While) -> bool:
    if isinstance(statement, ir.Loop):
        return statement.times is None
    return constant(fold(statement.condition)) == 1


def _takes_time(body: ir.Body, program: ir.Program) -> bool:
    """Whether a body moves, waits or beeps, or calls something that does."""
    for statement in ir.walk(body):
        if isinstance(statement, (ir.Move, ir.Beep, ir.Motors)):
            return True
        if isinstance(statement, ir.Call):
            if _takes_time(program.procedures[statement.procedure].body, program):
                return True
    return False


def _named(op: str, statements: Sequence[ir.Statement | ir.Task]) -> frozenset[int]:
    """Return the numbers of the variables or sensors that an expression of these has."""
    return frozenset(
        term.value
        for statement in statements
        for expression in ir.expressions(statement)
        for term in expression
        if term.op == op
    )


def _unused(
    program: ir.Program, kit: Kit, statements: Sequence[ir.Statement | ir.Task]
) -> Iterator[Diagnostic]:
    used = set(_named("VARIABLE", statements))
    for statement in statements:
        if isinstance(statement, ir.Assign) and statement.variable not in used:
            used.add(statement.variable)  # said once
            name = program.variables[statement.variable]
            device = name if said_of(name, "device") else ""
            values = {"name": name, "device": device, "example": use_of(name)}
            yield Diagnostic(codes.UNUSED_VARIABLE, statement.span, values)
    yield from _unused_readings(kit, statements)
    called = {each.procedure for each in statements if isinstance(each, ir.Call)}
    for number, procedure in enumerate(program.procedures):
        if number not in called:
            span = Span(procedure.span.start, procedure.span.start + len("DEF"))
            yield Diagnostic(codes.UNUSED_DEF, span, {"name": procedure.name})


def _unused_readings(
    kit: Kit, statements: Sequence[ir.Statement | ir.Task]
) -> Iterator[Diagnostic]:
    """`SI|DISTANCE`, where nothing asks for the distance: it is measured, and nobody sees it."""
    asked = set(_named("SENSOR", statements))
    for statement in statements:
        if isinstance(statement, ir.Read) and statement.sensor not in asked:
            asked.add(statement.sensor)  # said once
            name = kit.sensors[statement.sensor].name
            values = {"name": name, "fix": f"SHOW({name})"}
            yield Diagnostic(codes.UNUSED_READING, statement.span, values)
