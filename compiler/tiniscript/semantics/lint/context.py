"""The state of the warnings for one program, and the context of a statement."""

from __future__ import annotations

import re
from functools import cached_property
from typing import NamedTuple

from tiniscript.base.kit import Kit
from tiniscript.base.source import Source, Span
from tiniscript.diagnostics.codes import Code, Diagnostic
from tiniscript.semantics import ir
from tiniscript.syntax.lexer import Scan

# Statements that leave the robot where it is.
STANDING_STATEMENTS = (ir.Read, ir.Assign, ir.Show, ir.Act)
MAX_CHARACTERS = 120  # characters of a condition that a message can hold


class BodyContext(NamedTuple):
    """The context of a body: `loop` repeats it, `is_last` if the program ends with it."""

    loop: ir.Loop | ir.While | None = None
    is_repeated: bool = False  # whether a loop or a DEF repeats it
    is_last: bool = False
    asked_sensors: frozenset[int] = frozenset()  # sensors of the conditions around it
    outermost: ir.Loop | ir.While | None = None  # the outermost loop around it


class LintContext:
    """A program before it is optimised, its text and tokens; `diagnostics` are its warnings so
    far."""

    def __init__(self, program: ir.Program, kit: Kit, source: Source, scan: Scan) -> None:
        self.program = program
        self.kit = kit
        self.source = source
        self.scan = scan
        self.diagnostics: list[Diagnostic] = []

    def report(self, code: Code, span: Span, **values: str) -> None:
        self.diagnostics.append(Diagnostic(code, span, values))

    @cached_property
    def statements(self) -> list[ir.Statement | ir.Task]:
        return [*ir.all_statements(self.program), *self.program.tasks]

    @cached_property
    def uses_motors(self) -> bool:
        """Return whether M is used; without it the motors stop between instructions."""
        return any(isinstance(statement, ir.Motors) for statement in self.statements)

    @cached_property
    def variables(self) -> Variables:
        return Variables(self.program, self.kit)

    def header_span(self, span: Span) -> Span:
        """Return the header that a block begins with, up to the end of its brackets."""
        text, depth = self.source[span], 0
        for k, sign in enumerate(text):
            depth += (sign == "(") - (sign == ")")
            if sign == ")" and not depth:
                return Span(span.start, span.start + k + 1)
        return span

    def condition_text(self, span: Span, word: str) -> str:
        """Return the text in the brackets after the last `word` in `span`.

        Return nothing if it is long or spans several lines.
        """
        text = self.source[span]
        offsets = [match.end() for match in re.finditer(rf"\b{word}\s*\(", text, re.IGNORECASE)]
        if not offsets:
            return ""
        start = offsets[-1] if word == "UNTIL" else offsets[0]
        depth = 1
        for k in range(start, min(len(text), start + MAX_CHARACTERS)):
            depth += (text[k] == "(") - (text[k] == ")")
            if not depth:
                condition = text[start:k].strip()
                return "" if re.search(r"[\r\n]|//", condition) else condition
        return ""


class Variables:
    """The values that the variables of a program get, and where."""

    def __init__(self, program: ir.Program, kit: Kit) -> None:
        self._program = program
        self._kit = kit
        self.values_by_variable: dict[int, list[ir.Expression]] = {}
        for statement in ir.all_statements(program):
            if isinstance(statement, ir.Assign):
                self.values_by_variable.setdefault(statement.variable, []).append(statement.value)
        # Variables assigned in each loop, by its start; None if the loop takes no time.
        self._assigned_in_loop: dict[int, set[int] | None] = {}
        self._terms_of_loop: dict[int, set[ir.Term]] = {}  # keyed by the start of the loop
        self._assigned_by_def: list[set[int]] = []  # variables assigned in each DEF
        for procedure in program.procedures:
            self._assigned_by_def.append(self.assigned_in(procedure.body))

    def assigned_in(self, body: ir.Body) -> set[int]:
        """Return the variables that a body, or a DEF that it calls, gives a value."""
        assigned_variables = set()
        for statement in ir.walk(body):
            if isinstance(statement, ir.Assign):
                assigned_variables.add(statement.variable)
            elif isinstance(statement, ir.Call) and statement.procedure < len(
                self._assigned_by_def
            ):
                assigned_variables |= self._assigned_by_def[statement.procedure]
        return assigned_variables

    def sensors_of(self, variables: list[int]) -> dict[str, str]:
        """Return the sensor that each of these variables holds; nothing if one holds another."""
        sensor_of_variable = {}
        for variable in variables:
            values = set(self.values_by_variable.get(variable, ()))
            value = next(iter(values)) if len(values) == 1 else ()
            if len(value) != 1 or value[0].op != "SENSOR":
                return {}
            name = self._program.variables[variable]
            sensor_of_variable[name] = self._kit.readings[value[0].value].name
        return sensor_of_variable

    def sensors_held_in(self, loop: ir.Loop | ir.While, variables: list[int]) -> dict[str, str]:
        """Return `sensors_of` where a loop drives and gives none of the variables a value."""
        loop_start = loop.span.start
        if loop_start not in self._assigned_in_loop:
            drives = any(
                isinstance(statement, (ir.Move, ir.Motors)) for statement in ir.walk(loop.body)
            )
            self._assigned_in_loop[loop_start] = self.assigned_in(loop.body) if drives else None
        assigned_variables = self._assigned_in_loop[loop_start]
        is_held = assigned_variables is not None and not assigned_variables & set(variables)
        return self.sensors_of(variables) if is_held else {}

    def terms_used_in(self, loop: ir.Loop | ir.While) -> set[ir.Term]:
        """Return the terms of a loop: all sensors, and what statements other than SHOW use."""
        loop_start = loop.span.start
        if loop_start not in self._terms_of_loop:
            self._terms_of_loop[loop_start] = {
                term
                for statement in ir.walk((loop,))
                for expression in ir.expressions(statement)
                for term in expression
                if term.op == "SENSOR" or not isinstance(statement, ir.Show)
            }
        return self._terms_of_loop[loop_start]
