"""Lowering: IR becomes instructions, and instructions become code bytes.

Knows which instruction says a thing in the fewest bytes, and lays out jumps: each starts short, and
becomes far where its target is. It does not know the format of images.

Plain code is what one pass over the text can emit, as in a robot that reads text
(`docs/develop/text.md`): it has no fused instructions, keeps every ELSE of the text, and leaves
DEFs where they are.
"""

# No `from __future__ import annotations`: typing would compile each field's again, one by one.
from collections.abc import Callable
from typing import NamedTuple

from tiniscript.base.fixed_point import clamp, round_to_whole
from tiniscript.base.limits import CODE_BYTES
from tiniscript.base.source import Span
from tiniscript.bytecode.opcodes import BY_NAME, time8
from tiniscript.codegen.lower_expression import (
    Emitter,
    Item,
    add_value,
    emit_unless,
    emit_until,
    number_of,
    pushes_in_one_byte,
)
from tiniscript.semantics import ir
from tiniscript.semantics.optimizer import constant


class SourceLocation(NamedTuple):
    """The instruction at `offset` comes from the text at `span`."""

    offset: int
    span: Span


class LoweredCode(NamedTuple):
    """`code` may be longer than CODE_BYTES, the most that a machine takes."""

    code: bytes
    locations: tuple[SourceLocation, ...]


def lower(program: ir.Program, is_plain: bool = False) -> LoweredCode:
    """Return the code bytes of a program, and where in the text they come from.

    `is_plain` code is made from a program as written, not from an optimised one.
    """
    lowering = _Lowering(is_plain, len(program.procedures))
    called_numbers = (k for k, procedure in enumerate(program.procedures) if procedure.is_called)
    pending_routines: list[tuple[ir.Procedure | ir.Task, int | None]] = [
        *((program.procedures[k], k) for k in called_numbers),
        *((task, None) for task in program.tasks),
    ]
    if is_plain:
        pending_routines.sort(key=lambda routine: routine[0].span)
    pending_routines.reverse()
    for statement in program.body:
        while pending_routines and (not is_plain or pending_routines[-1][0].span < statement.span):
            lowering.routine(*pending_routines.pop())
        lowering.statement(statement)
    while pending_routines:
        lowering.routine(*pending_routines.pop())
    return _assemble(lowering.emitter)


class _LoopEnd(NamedTuple):
    label: int
    is_counted: bool


class _Lowering:
    def __init__(self, is_plain: bool, procedure_count: int) -> None:
        self.plain = is_plain
        self.emitter = Emitter(is_plain)
        # the label of each DEF's first instruction
        self.def_labels = [self.emitter.new_label() for _ in range(procedure_count)]
        self.open_loops: list[_LoopEnd] = []

    def routine(self, routine: ir.Procedure | ir.Task, number: int | None) -> None:
        """Add a task, or the DEF of this number."""
        emitter = self.emitter
        emitter.span = routine.span
        end = emitter.new_label()
        if isinstance(routine, ir.Procedure):
            assert number is not None
            emitter.add("DEF", label=end)
            emitter.mark(self.def_labels[number])
            end_op = "RETURN"
        elif routine.until is None:
            emitter.add("TASK", label=end)
            end_op = "END_TASK"
        else:
            emitter.add("WHEN", label=end)
            self.add_readings(routine.until.reads)
            add_value(emitter, routine.until.condition)
            emitter.add("LOOK")
            end_op = "END_WHEN"
        self.body(routine.body)
        emitter.add(end_op)
        emitter.mark(end)

    def add_readings(self, sensors: tuple[int, ...]) -> None:
        for sensor in sensors:
            self.emitter.add("READ", sensor)

    def body(self, body: ir.Body) -> None:
        for statement in body:
            self.statement(statement)

    def statement(self, statement: ir.Statement) -> None:
        self.emitter.span = statement.span
        _STATEMENTS[type(statement)](self, statement)

    def read(self, read: ir.Read) -> None:
        self.emitter.add("READ", read.sensor)

    def show(self, show: ir.Show) -> None:
        add_value(self.emitter, show.value)
        self.emitter.add("SHOW_YES_NO" if show.is_yes_no else "SHOW")

    def set(self, statement: ir.Set) -> None:
        add_value(self.emitter, statement.value)
        self.emitter.add("SET", statement.actuator)

    # -- moves --------------------------------------------------------------------------------

    def move(self, move: ir.Move) -> None:
        emitter = self.emitter
        time = None if move.time is None else self.clamp_time(move.time)
        power = None if move.power is None else self.percentage(move.power, 0)
        name = "WAIT" if power is None else move.direction
        until = move.until
        if until is None and time is None:  # an endless move in a program with other tasks
            until = ir.Until((), (ir.Term("YES_NO", 0),))
        if until is None and time is not None and not move.unit:
            time_ms = self.constant_of(time)
            time_byte = None if time_ms is None else time8(time_ms)
            power_value = None if power is None else self.constant_of(power)
            if time_byte is not None and (power is None or power_value is not None):
                short_name = "WAIT8" if power_value is None else f"MOVE8_{name}"
                emitter.add(
                    short_name, time_byte, *(() if power_value is None else (power_value // 1000,))
                )
                return
        if time is not None:
            add_value(emitter, time)
        if power is not None:
            add_value(emitter, power)
        if until is None:
            emitter.add("WAIT" if power is None else f"{'GO' if move.unit else 'MOVE'}_{name}")
            return
        kind = "_FOREVER" if time is None else "_GO" if move.unit else ""
        emitter.add(f"WATCH{kind}_{name}")
        self.add_readings(until.reads)
        emit_until(emitter, until.condition)

    def act(self, act: ir.Act) -> None:
        """Add BEEP, or BEEP8 where all values are operands: by the name of the word's role."""
        name = act.word.role.name.upper()
        short_op = BY_NAME.get(f"{name}8")
        operands = (
            []
            if short_op is None
            else [
                self.operand_of(value, argument.whole_limits, operand.kind.name)
                for operand, (argument, value) in zip(short_op.operands, act.arguments, strict=True)
            ]
        )
        whole_operands = [operand for operand in operands if operand is not None]
        if short_op is not None and len(whole_operands) == len(operands):
            self.emitter.add(short_op.name, *whole_operands)
            return
        for value in act.values:
            add_value(self.emitter, value)
        self.emitter.add(name)

    def operand_of(
        self, expression: ir.Expression, limits: tuple[int, int] | None, kind: str
    ) -> int | None:
        """Return the operand that says a value, if the text says it and an operand can hold it."""
        value = self.constant_of(expression)
        if value is None:
            return None
        if kind == "time8":
            return time8(max(0, value))
        return round_to_whole(value) if limits is None else clamp(round_to_whole(value), *limits)

    def motors(self, motors: ir.Motors) -> None:
        left, right = self.percentage(motors.left, -100), self.percentage(motors.right, -100)
        left_value, right_value = self.constant_of(left), self.constant_of(right)
        if left_value is not None and right_value is not None:
            self.emitter.add("MOTORS8", left_value // 1000, right_value // 1000)
        else:
            add_value(self.emitter, left)
            add_value(self.emitter, right)
            self.emitter.add("MOTORS")

    def stop(self, _: ir.Stop) -> None:
        self.emitter.add("STOP")

    # -- variables ----------------------------------------------------------------------------

    def assign(self, assign: ir.Assign) -> None:
        """`X = 5`, `X = X + 5`, `X = X + Y` have instructions of their own."""
        emitter, variable, value = self.emitter, assign.variable, assign.value
        if not self.plain and self.add_short_assignment(variable, value):
            return
        add_value(emitter, value)
        emitter.add("SET_VAR", variable)

    def add_short_assignment(self, variable: int, value: ir.Expression) -> bool:
        """Add the one instruction that does it; return whether there is one."""
        emitter = self.emitter
        if len(value) == 1 and value[0].op == "NUMBER":
            number = number_of(value[0], -128, 127)
            if number is not None and not pushes_in_one_byte(value[0], variable):
                emitter.add("SET_VAR8", variable, number)
                return True
        if len(value) == 3 and value[2].op in ("ADD", "SUB"):
            left, right, operator = value
            if operator.op == "ADD" and left != ("VARIABLE", variable):
                left, right = right, left
            if left == ("VARIABLE", variable):
                if right.op == "NUMBER":
                    sign = 1 if operator.op == "ADD" else -1
                    number = number_of(right._replace(value=sign * right.value), -128, 127)
                    if number in (1, -1):
                        emitter.add("INC_VAR" if number == 1 else "DEC_VAR", variable)
                        return True
                    if number is not None:
                        emitter.add("ADD_VAR8", variable, number)
                        return True
                elif right.op == "VARIABLE" and operator.op == "ADD":
                    emitter.add("ADD_VAR", variable, right.value)
                    return True
        return False

    # -- blocks -------------------------------------------------------------------------------

    def if_(self, statement: ir.If) -> None:
        emitter = self.emitter
        end = emitter.new_label()
        for k, arm in enumerate(statement.arms):
            has_else = statement.has_else if self.plain else bool(statement.else_body)
            is_last = k == len(statement.arms) - 1 and not has_else
            next_label = end if is_last else emitter.new_label()
            emitter.span = arm.span
            self.add_readings(arm.reads)
            emit_unless(emitter, arm.condition, next_label)
            self.body(arm.body)
            if not is_last:
                if self.plain or ir.falls_through(arm.body):
                    emitter.add("ELSE", label=end)
                emitter.mark(next_label)
        self.body(statement.else_body)
        emitter.mark(end)

    def loop(self, loop: ir.Loop) -> None:
        emitter = self.emitter
        end = emitter.new_label()
        if loop.times is None:
            emitter.add("FOREVER")
        else:
            value = self.constant_of(loop.times)
            count = None if value is None else round_to_whole(value)
            if count is not None and 1 <= count <= 255:
                emitter.add("LOOP8", count)
            else:
                add_value(emitter, loop.times)
                emitter.add("LOOP", label=end)
        self.add_loop(loop.body, end, loop.times is not None, loop.span)

    def while_(self, loop: ir.While) -> None:
        emitter = self.emitter
        end = emitter.new_label()
        emitter.add("WHILE", label=end)
        start = emitter.mark_here()
        self.add_readings(loop.reads)
        emit_unless(emitter, loop.condition, end)
        self.add_loop(loop.body, end, False, loop.span, start)

    def add_loop(
        self, body: ir.Body, end: int, is_counted: bool, span: Span, start: int | None = None
    ) -> None:
        """Add a loop's body, the jump back to `start` (here if None) and the label `end`."""
        emitter = self.emitter
        if start is None:
            start = emitter.mark_here()
        self.open_loops.append(_LoopEnd(end, is_counted))
        self.body(body)
        self.open_loops.pop()
        emitter.span = span
        emitter.add("NEXT" if is_counted else "AGAIN", label=start)
        emitter.mark(end)

    def break_(self, _: ir.Break) -> None:
        loop = self.open_loops[-1]
        self.emitter.add("BREAK_LOOP" if loop.is_counted else "BREAK", label=loop.label)

    def call(self, call: ir.Call) -> None:
        self.emitter.add("CALL", label=self.def_labels[call.procedure])

    # -- numbers that the text says -----------------------------------------------------------

    def constant_of(self, expression: ir.Expression) -> int | None:
        """Return the value that an operand may hold; in plain code numbers are pushed."""
        return None if self.plain else constant(expression)

    def clamp_time(self, time: ir.Expression) -> ir.Expression:
        value = self.constant_of(time)
        return (time[0]._replace(value=0),) if value is not None and value < 0 else time

    def percentage(self, power: ir.Expression, low: int) -> ir.Expression:
        value = self.constant_of(power)
        if value is None:
            return power
        return (power[0]._replace(value=clamp(round_to_whole(value), low, 100) * 1000),)


# A statement of the IR that has no row here is a KeyError, not a program that lacks it.
_STATEMENTS: dict[type, Callable[..., None]] = {
    ir.Read: _Lowering.read,
    ir.Move: _Lowering.move,
    ir.Motors: _Lowering.motors,
    ir.Stop: _Lowering.stop,
    ir.Act: _Lowering.act,
    ir.Show: _Lowering.show,
    ir.Set: _Lowering.set,
    ir.Assign: _Lowering.assign,
    ir.If: _Lowering.if_,
    ir.Loop: _Lowering.loop,
    ir.While: _Lowering.while_,
    ir.Break: _Lowering.break_,
    ir.Call: _Lowering.call,
}


# -- layout -----------------------------------------------------------------------------------


def _assemble(emitter: Emitter) -> LoweredCode:
    """Choose for each jump the form that reaches its target, and write the bytes.

    A jump only ever gets longer, so this ends. Comparing branches have no far form: one that
    does not reach becomes a comparison and an IF_FAR.
    """
    while True:
        starts, offset = [], 0
        for item in emitter.items:
            starts.append(offset)
            offset += item.op.size
        starts.append(offset)
        targets = [starts[index] for index in emitter.labels]
        too_short = {
            k
            for k, item in enumerate(emitter.items)
            if item.label is not None and not _is_in_reach(item, starts[k], targets[item.label])
        }
        # Code over the limit is refused, whatever its length.
        if not too_short or offset > 2 * CODE_BYTES:
            break
        emitter.widen(too_short)
    code = bytearray()
    locations: list[SourceLocation] = []
    for item, start in zip(emitter.items, starts, strict=False):
        if not locations or locations[-1].span != item.span:
            locations.append(SourceLocation(start, item.span))
        _write(code, item, None if item.label is None else targets[item.label])
    return LoweredCode(bytes(code), tuple(locations))


def _is_in_reach(item: Item, start: int, target: int) -> bool:
    distance = abs(target - (start + item.op.size))
    return distance <= item.op.operands[-1].kind.high


def _write(code: bytearray, item: Item, target: int | None) -> None:
    operands = item.operands
    if target is not None:
        distance = abs(target - (len(code) + item.op.size))
        operands = (*operands, min(distance, item.op.operands[-1].kind.high))
    code += item.op.opcode
    for operand, value in zip(item.op.operands, operands, strict=True):
        code += value.to_bytes(operand.kind.size, "little", signed=operand.kind.is_signed)
