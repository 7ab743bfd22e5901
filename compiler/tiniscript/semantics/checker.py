"""The checker: the AST becomes IR.

Knows every rule that a person can break once the shape is right: names, argument counts,
ranges, types, limits; and the rule which reading a sensor's name means. Does not know bytes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

from tiniscript.base.kit import Kit
from tiniscript.base.limits import (
    BLOCKS,
    CALLS,
    DEFS,
    PARAMETERS,
    STACK_VALUES,
    VARIABLES,
)
from tiniscript.base.source import Source, Span
from tiniscript.base.words import EXTENTS, UNIT_OF, VALUE, WORDS, Argument, Word
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.semantics import ir
from tiniscript.semantics.ir import Statement
from tiniscript.semantics.symbols import ANY, Name, Scope
from tiniscript.semantics.types import Types, Value
from tiniscript.syntax import ast
from tiniscript.syntax.parser import parse

if TYPE_CHECKING:
    from tiniscript.semantics.parameters import ParameterKinds
    from tiniscript.semantics.wrong_calls import WrongCalls


class CheckedProgram(NamedTuple):
    """`program` is a whole program only if no diagnostic is a mistake."""

    program: ir.Program
    diagnostics: list[Diagnostic]


def check(source: Source, parsed_program: ast.Program, kit: Kit) -> CheckedProgram:
    """Return the IR of a program for a robot with this kit, and all its diagnostics."""
    checker = _Checker(source, kit, parsed_program)
    body = checker.body(parsed_program.body)
    variables, procedures = tuple(checker.variables), tuple(checker.procedures)
    checked_program = ir.Program(
        parsed_program.start, variables, procedures, body, tuple(checker.tasks)
    )
    if (
        checked_program.tasks
        and any(procedure.values for procedure in procedures)
        and not checker.diagnostics
    ):
        checker.check_copies_fit(checked_program)
    return CheckedProgram(checked_program, checker.diagnostics)


class _Procedure(NamedTuple):
    """The effects of calling a DEF."""

    definitely_read_mask: int
    block_depth: int
    call_depth: int


class _OuterScope(NamedTuple):
    """The known facts about the program around a DEF or a task."""

    definitely_read_mask: int
    block_depth: int
    call_depth: int
    blocks_in_other_tasks: int
    calls_in_other_tasks: int


class _Checker(Scope):
    def __init__(self, source: Source, kit: Kit, parsed_program: ast.Program) -> None:
        super().__init__(source, kit, parsed_program)
        self.types = Types(self)
        self.variables: list[str] = []
        self.procedures: list[ir.Procedure] = []
        self.def_facts: list[_Procedure] = []
        self.tasks: list[ir.Task] = []
        self.has_tasks = any(isinstance(node, ast.Task) for node in parsed_program.body)
        self.blocks_in_other_tasks = 0  # open at once in the other tasks, all of them together,
        self.calls_in_other_tasks = 0  # calls in other tasks
        self.current_def: str | None = None  # the DEF whose body is being checked
        self.definitely_read_mask = 0  # a bit for each sensor
        self.loop_depth = 0
        self.block_depth = 0
        self.deepest_block = 0  # blocks open at once in the routine that is being checked
        self.call_depth = 0  # calls open at once in it

    @cached_property
    def kinds(self) -> ParameterKinds:
        from tiniscript.semantics.parameters import ParameterKinds

        return ParameterKinds(self.parsed_program, self.yes_no_sensors)

    @cached_property
    def taken_names(self) -> frozenset[str]:
        """The names that a program gives to anything but the values of its DEFs."""
        return frozenset((*self.assigned_names, *self.def_names))

    @cached_property
    def wrong_calls(self) -> WrongCalls:
        """Return the checker of wrong instructions. A correct program never loads it."""
        from tiniscript.semantics.wrong_calls import WrongCalls

        return WrongCalls(self)

    def body(self, instructions: Sequence[ast.Instruction]) -> ir.Body:
        statements: list[Statement] = []
        for instruction in instructions:
            _NODE_CHECKS[type(instruction)](self, instruction, statements)
        return tuple(statements)

    # -- readings -----------------------------------------------------------------------------

    def add_readings(self, values: Sequence[Value], span: Span, output: list[Statement]) -> int:
        """Add the readings that come before an instruction; return them as bits."""
        read_mask = 0
        for sensor in self.unread_sensors(values, self.definitely_read_mask):
            output.append(ir.Read(sensor, span))
            read_mask |= 1 << sensor
        return read_mask

    @staticmethod
    def unread_sensors(values: Sequence[Value], read_mask: int) -> tuple[int, ...]:
        """Return the sensors in `values`, each once, in order, that are not in `read_mask`."""
        sensor_numbers: list[int] = []
        for value in values:
            for sensor in value.sensors:
                if not read_mask >> sensor & 1 and sensor not in sensor_numbers:
                    sensor_numbers.append(sensor)
        return tuple(sensor_numbers)

    # -- instructions -------------------------------------------------------------------------

    def assign(self, node: ast.Assign, output: list[Statement]) -> None:
        name = self.names.get(node.name)
        if name is not None and name.kind in ("sensor", "actuator"):
            self.wrong_calls.report_device_set(node, name)
            return
        if node.name in self.def_names:
            self.wrong_calls.report_def_set(node, self.procedures)
            return
        if node.value is None:
            if name is None:
                self.make_variable(node, self.types.no_value)
            return
        value = self.types.value(node.value, node.name if name is None else None)
        self.check_stack_fits([value], node.span)
        number = self.make_variable(node, value) if name is None else name.number
        known_type = self.types.variable_types[number]
        if ANY not in (known_type, value.type) and known_type != value.type:
            unused_name = self.wrong_calls.free_name(node.name, self.procedures)
            other_assignment = f"{unused_name} = {self.source[node.value.span]}"
            self.report(codes.TYPE_CHANGES, node.value.span, name=node.name, other=other_assignment,
                        old="@" + known_type, new="@" + value.type)  # fmt: skip
        self.add_readings([value], node.span, output)
        output.append(ir.Assign(number, value.terms, node.span))

    def make_variable(self, node: ast.Assign, value: Value) -> int:
        """Make a new variable; its type is that of its first assignment."""
        number = self.new_variable(node.name, node.name_span, value.type)
        self.names[node.name] = Name("variable", number)
        return number

    def new_variable(self, name: str, span: Span, kind: str) -> int:
        number = len(self.variables)
        if number == VARIABLES:
            self.report(codes.TOO_MANY_VARIABLES, span, limit=str(VARIABLES))
        self.variables.append(name)
        self.types.variable_types.append(kind)
        return number

    def command(self, node: ast.Command, output: list[Statement]) -> None:
        word = WORDS.get(node.word)
        if node.until is not None and (word is None or not word.role.has_duration):
            self.wrong_calls.report_until_not_here(node, node.until, word)
            node = node._replace(until=None)
        if word is None:
            self.kit_or_def(node, output)
            return
        arguments = node.arguments or ()
        span = node.span
        if len(arguments) != len(word.arguments):
            self.wrong_calls.report_count(word, arguments, span)
            return
        is_endless = word.role.has_duration and arguments[0].expression[0].op == "FOREVER"
        if is_endless and node.until is None and not self.has_tasks:
            self.wrong_calls.report_forever(arguments[0].span, word, node)
        argument_specs, unit_part = word.arguments, arguments[0].unit if word.role.is_move else None
        if unit_part is not None:
            self.check_unit(node, unit_part)
            arguments = (arguments[0]._replace(unit=None), *arguments[1:])
            argument_specs = (EXTENTS[UNIT_OF[word.text]], *argument_specs[1:])
        diagnostic_count = len(self.diagnostics)
        values = [
            self.types.value(argument)
            if spec is VALUE
            else self.number_value(argument, spec, word.text, (node, word))
            for argument, spec in zip(
                arguments[is_endless:], argument_specs[is_endless:], strict=True
            )
        ]
        if len(self.diagnostics) > diagnostic_count:
            self.wrong_calls.report_values(node, word, diagnostic_count)
        if word.expansion:
            if len(self.diagnostics) == diagnostic_count:
                self.add_expansion(word, arguments, span, output)
            return
        self.check_stack_fits(values, span)
        self.add_readings(values, span, output)
        terms = [value.terms for value in values]
        if word.role.has_duration:
            until = None if node.until is None else self.until(node.until)
            time, power = None if is_endless else terms[0], terms[-1] if word.role.is_move else None
            unit = "" if unit_part is None else unit_part.op
            output.append(ir.Move(node.word, time, power, until, span, unit))
        elif word.role.is_instruction:  # START does nothing
            make = _STATEMENT_MAKERS.get(word.role.name)
            output.append(make(values, span) if make else ir.Act(word, tuple(terms), span))

    def add_expansion(
        self, word: Word, arguments: Sequence[ast.Argument], span: Span, output: list[Statement]
    ) -> None:
        """Make what the instructions make that a word stands for, with these values."""
        names = [argument.name.upper() for argument in word.arguments]
        argument_of = dict(zip(names, arguments, strict=True))
        for instruction in parse(Source(word.expansion)).program.body:
            _NODE_CHECKS[type(instruction)](self, _relocate(instruction, span, argument_of), output)

    def check_unit(self, node: ast.Command, unit: ast.Part) -> None:
        """Check the unit of a move, and whether the robot's speed is known."""
        if unit.op != UNIT_OF[node.word]:
            self.wrong_calls.report_unit_pair(node, unit)
        elif not (self.kit.speed if unit.op == "CM" else self.kit.turn):
            line = "speed = 45" if unit.op == "CM" else "turn = 360"
            self.report(codes.NO_SPEED, Span(unit.start, unit.end), unit=unit.op, line=line)

    def number_value(
        self,
        argument: ast.Argument,
        spec: Argument,
        word: str,
        command_and_word: tuple[ast.Command, Word] | None = None,
    ) -> Value:
        """Check a number argument, `command_and_word` a command; a plain one must be in range."""
        if argument.is_plain:
            part = argument.expression[0]
            assert isinstance(part.value, int)
            if not spec.low <= part.value <= spec.high:
                self.wrong_calls.report_out_of_range(
                    argument.span, part.value, spec, word, command_and_word
                )
        value = self.types.value(argument)
        if value.type == "yes_no":
            self.wrong_calls.report_not_number(argument.span, word)
        return value

    def until(self, argument: ast.Argument, word: str = "UNTIL") -> ir.Until:
        """Return the check of an UNTIL or a WHEN."""
        value = self.condition(argument, word)
        return ir.Until(self.unread_sensors([value], 0), value.terms)

    def condition(self, argument: ast.Argument, word: str) -> Value:
        value = self.types.value(argument)
        if value.type == "number":
            self.report_not_condition(argument, word)
        self.check_stack_fits([value], argument.span)
        return value

    def report_not_condition(self, argument: ast.Argument, asker: str) -> None:
        argument_text = self.source[argument.span]
        values = self.types.wrong_values.condition(argument.span)
        self.report(
            codes.WANTS_CONDITION, argument.span, None, by=asker, found=argument_text, **values
        )

    def check_stack_fits(self, values: Sequence[Value], span: Span) -> None:
        if any(value.depth + i > STACK_VALUES for i, value in enumerate(values)):
            self.report(codes.VALUES_TOO_DEEP, span, limit=str(STACK_VALUES))

    # -- names as instructions ----------------------------------------------------------------

    def kit_or_def(self, node: ast.Command, output: list[Statement]) -> None:
        name = self.names.get(node.word)
        if name is None:
            self.wrong_calls.report_unknown(node, self.current_def)
        elif node.arguments is not None and name.kind not in _KINDS_WITH_VALUES:
            self.wrong_calls.report_not_callable(node)
        else:
            _BY_NAME_KIND[name.kind](self, node, name.number, output)

    def add_reading(self, node: ast.Command, number: int, output: list[Statement]) -> None:
        output.append(ir.Read(number, node.span))
        self.definitely_read_mask |= 1 << number

    def report_variable_alone(
        self, node: ast.Command, number: int, output: list[Statement]
    ) -> None:
        self.report(codes.VARIABLE_ALONE, node.span, name=node.word)

    def actuator(self, node: ast.Command, number: int, output: list[Statement]) -> None:
        device = self.kit.actuators[number]
        word = device.word
        if node.arguments is None:
            self.report(codes.MISSING_OPEN, node.span, word=device.name, usage=word.usage,
                        fix=word.example)  # fmt: skip
            return
        if len(node.arguments) != 1:
            self.wrong_calls.report_count(word, node.arguments, node.span)
            return
        argument = node.arguments[0]
        if device.is_yes_no:
            value = self.types.value(argument)
            if value.type == "number":
                self.report_not_condition(argument, device.name)
        else:
            value = self.number_value(argument, word.arguments[0], device.name)
        self.check_stack_fits([value], node.span)
        self.add_readings([value], node.span, output)
        output.append(ir.Set(number, value.terms, node.span))

    def call(self, node: ast.Command, number: int, output: list[Statement]) -> None:
        facts = self.def_facts[number]
        if facts.call_depth + 1 + self.calls_in_other_tasks > CALLS:
            self.report(codes.CALLS_TOO_DEEP, node.span, name=node.word, limit=str(CALLS))
        self.call_depth = max(self.call_depth, facts.call_depth + 1)
        deepest_depth = self.block_depth + facts.block_depth
        if deepest_depth + self.blocks_in_other_tasks > BLOCKS:
            self.report(codes.BLOCKS_TOO_DEEP, node.span, limit=str(BLOCKS))
        self.deepest_block = max(self.deepest_block, deepest_depth)
        self.set_values(node, self.procedures[number], output)
        self.definitely_read_mask |= facts.definitely_read_mask
        output.append(ir.Call(number, node.span))

    def set_values(
        self, node: ast.Command, procedure: ir.Procedure, output: list[Statement]
    ) -> None:
        """Add what sets the values of a DEF before it is called."""
        arguments = node.arguments or ()
        if len(arguments) != len(procedure.values):
            self.wrong_calls.report_value_count(
                node, procedure, [self.variables[k] for k in procedure.values]
            )
            return
        if arguments:
            from tiniscript.semantics.parameters import names_a_value  # loaded for its DEF

            names = [self.variables[k] for k in procedure.values]
            if names_a_value(node, names) and self.wrong_calls.report_named_values(node, names):
                return
        values = [self.types.value(argument) for argument in arguments]
        for argument, value, number in zip(arguments, values, procedure.values, strict=True):
            expected_type = self.types.variable_types[number]
            if ANY not in (expected_type, value.type) and expected_type != value.type:
                self.report(codes.CALL_KIND, argument.span, name=self.variables[number],
                            word=node.word, old="@" + expected_type,
                            new="@" + value.type)  # fmt: skip
        self.check_stack_fits(values, node.span)
        self.add_readings(values, node.span, output)
        for value, number in zip(values, procedure.values, strict=True):
            output.append(ir.Assign(number, value.terms, node.span))

    # -- blocks -------------------------------------------------------------------------------

    def nested_body(
        self, instructions: Sequence[ast.Instruction], is_loop: bool, span: Span
    ) -> ir.Body:
        self.block_depth += 1
        self.loop_depth += is_loop
        self.deepest_block = max(self.deepest_block, self.block_depth)
        if (
            self.block_depth + self.blocks_in_other_tasks == BLOCKS + 1
        ):  # code that is too deep by itself is not counted here
            self.report(codes.BLOCKS_TOO_DEEP, span, limit=str(BLOCKS))
        body = self.body(instructions)
        self.block_depth -= 1
        self.loop_depth -= is_loop
        return body

    def loop_body(self, node: ast.Loop | ast.While) -> ir.Body:
        """Check a body in which no turn surely finds what was read before it."""
        mask_before, self.definitely_read_mask = self.definitely_read_mask, 0
        body = self.nested_body(node.body, True, node.span)
        self.definitely_read_mask = mask_before
        return body

    def if_(self, node: ast.If, output: list[Statement]) -> None:
        mask_before, chain_mask = self.definitely_read_mask, 0
        mask_after = -1  # sensors that all arms certainly read
        arms: list[ir.Arm] = []
        for arm in node.arms:
            value = self.types.no_value
            if arm.condition is not None:
                value = self.condition(arm.condition, "ELSEIF" if arms else "IF")
            reads: tuple[int, ...] = ()
            if arms:
                reads = self.unread_sensors([value], mask_before | chain_mask)
                for sensor in reads:
                    chain_mask |= 1 << sensor
            else:
                chain_mask = self.add_readings([value], arm.span, output)
            body = self.nested_body(arm.body, False, arm.span)
            mask_after &= self.definitely_read_mask
            self.definitely_read_mask = mask_before
            arms.append(ir.Arm(reads, value.terms, body, arm.span))
        else_body = self.nested_body(node.else_body, False, node.span)
        self.definitely_read_mask &= mask_after
        output.append(ir.If(tuple(arms), else_body, node.span, node.has_else))

    def loop(self, node: ast.Loop, output: list[Statement]) -> None:
        times = None
        if node.times is not None:
            value = self.number_value(node.times, Argument("n", ""), "LOOP")
            self.check_stack_fits([value], node.times.span)
            self.add_readings([value], node.span, output)
            times = value.terms
        body = self.loop_body(node)
        output.append(ir.Loop(times, body, node.span))

    def while_(self, node: ast.While, output: list[Statement]) -> None:
        value = self.types.no_value
        if node.condition is not None:
            value = self.condition(node.condition, "WHILE")
        body = self.loop_body(node)
        reads = self.unread_sensors([value], 0)
        output.append(ir.While(reads, value.terms, body, node.span))

    def break_(self, node: ast.Break, output: list[Statement]) -> None:
        if not self.loop_depth:
            self.wrong_calls.report_break_outside(node)
        output.append(ir.Break(node.span))

    def def_(self, node: ast.Def, output: list[Statement]) -> None:
        known_name = self.names.get(node.name)
        if known_name is not None:
            code = codes.DEF_TWICE if known_name.kind == "def" else codes.NAME_TAKEN
            free_name = self.wrong_calls.free_name(node.name, self.procedures)
            self.report(code, node.name_span, name=node.name, other=free_name)
        if len(self.procedures) == DEFS:
            self.report(codes.TOO_MANY_DEFS, node.name_span, limit=str(DEFS))
        outer_scope = self.enter_scope()
        self.blocks_in_other_tasks = self.calls_in_other_tasks = 0
        self.current_def = node.name
        values = self.parameters(node) if node.parameters else []
        body = self.body(node.body)
        for number in values:
            if self.names.get(self.variables[number]) == Name("variable", number):
                del self.names[self.variables[number]]
        self.current_def = None
        self.def_facts.append(
            _Procedure(self.definitely_read_mask, self.deepest_block, self.call_depth)
        )
        self.restore_scope(outer_scope)
        if known_name is None:
            self.names[node.name] = Name("def", len(self.procedures))
        procedure = ir.Procedure(node.name, body, node.span, values=tuple(values))
        self.procedures.append(procedure)

    def parameters(self, node: ast.Def) -> list[int]:
        """Return the variables of a DEF's values. Their names are known from here on."""
        if len(node.parameters) > PARAMETERS:
            self.report(codes.TOO_MANY_PARAMETERS, node.parameters[PARAMETERS].span,
                        name=node.name, limit=str(PARAMETERS))  # fmt: skip
        variable_numbers: list[int] = []
        for parameter, kind in zip(node.parameters, self.kinds.kinds_of(node), strict=True):
            known_name = self.names.get(parameter.name)
            is_new_name = known_name is None and parameter.name not in self.taken_names
            variable_numbers.append(
                self.new_variable(parameter.name, parameter.span, kind if is_new_name else ANY)
            )
            if known_name is None:  # each name is reported once, even if another message covers it
                self.names[parameter.name] = Name("variable", variable_numbers[-1])
            if is_new_name:
                continue
            if (
                known_name is not None
                and known_name.kind == "variable"
                and known_name.number in variable_numbers
            ):
                self.report(codes.PARAMETER_TWICE, parameter.span, name=parameter.name)
            else:
                free_name = self.wrong_calls.free_name(parameter.name, self.procedures)
                self.report(
                    codes.PARAMETER_TAKEN, parameter.span, name=parameter.name, other=free_name
                )
        return variable_numbers

    def task(self, node: ast.Task, output: list[Statement]) -> None:
        outer_scope = self.enter_scope()
        self.blocks_in_other_tasks += outer_scope.block_depth
        self.calls_in_other_tasks += outer_scope.call_depth
        until = None
        if node.is_when:
            no_until = ir.Until((), self.types.no_value.terms)
            until = no_until if node.condition is None else self.until(node.condition, "WHEN")
        body = self.body(node.body)
        blocks, calls = self.deepest_block, self.call_depth
        self.restore_scope(outer_scope)
        self.blocks_in_other_tasks += blocks
        self.calls_in_other_tasks += calls
        self.tasks.append(ir.Task(until, body, node.span))

    def check_copies_fit(self, program: ir.Program) -> None:
        """Check that a machine has room for what each task has of its own."""
        from tiniscript.semantics.task_copies import find_excess

        excess = find_excess(program)
        if excess is not None:
            self.wrong_calls.report_too_many_copies(program, excess)

    def enter_scope(self) -> _OuterScope:
        """Begin a DEF or a task, in which nothing is surely read or open; return what was."""
        outer_scope = _OuterScope(
            self.definitely_read_mask,
            self.deepest_block,
            self.call_depth,
            self.blocks_in_other_tasks,
            self.calls_in_other_tasks,
        )
        self.definitely_read_mask = self.deepest_block = self.call_depth = 0
        return outer_scope

    def restore_scope(self, outer_scope: _OuterScope) -> None:
        (
            self.definitely_read_mask,
            self.deepest_block,
            self.call_depth,
            self.blocks_in_other_tasks,
            self.calls_in_other_tasks,
        ) = outer_scope


def _relocate(node: Any, span: Span, argument_of: Mapping[str, ast.Argument]) -> Any:
    """Return a part of a tree at another place, with what was given for the names in it."""
    if isinstance(node, Span):
        return span
    if isinstance(node, ast.Part):
        return node._replace(start=span.start, end=span.end)
    if isinstance(node, ast.Argument) and node.expression[0].value in argument_of:
        return argument_of[str(node.expression[0].value)]
    if isinstance(node, tuple):
        parts = [_relocate(part, span, argument_of) for part in node]
        return type(node)(*parts) if hasattr(node, "_fields") else tuple(parts)
    return node


# Statements of instructions other than `ir.Act`, by the role of their words.
_STATEMENT_MAKERS: dict[str, Callable[[Sequence[Value], Span], Statement]] = {
    "motors": lambda values, span: ir.Motors(values[0].terms, values[1].terms, span),
    "show": lambda values, span: ir.Show(values[0].terms, values[0].type == "yes_no", span),
    "stop": lambda values, span: ir.Stop(span),
}
# The effect of names as instructions, by their meaning; these have values in brackets.
_KINDS_WITH_VALUES = frozenset(("actuator", "def"))
_BY_NAME_KIND: dict[str, Callable[[_Checker, ast.Command, int, list[Statement]], None]] = {
    "actuator": _Checker.actuator,
    "def": _Checker.call,
    "sensor": _Checker.add_reading,
    "variable": _Checker.report_variable_alone,
}
_NODE_CHECKS: dict[type, Callable[..., None]] = {
    ast.Command: _Checker.command,
    ast.Assign: _Checker.assign,
    ast.If: _Checker.if_,
    ast.Loop: _Checker.loop,
    ast.While: _Checker.while_,
    ast.Break: _Checker.break_,
    ast.Def: _Checker.def_,
    ast.Task: _Checker.task,
}
