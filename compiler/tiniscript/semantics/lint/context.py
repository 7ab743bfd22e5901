"""What the warnings know of one program while it is looked at, and of the place of a statement."""

from __future__ import annotations

import re
from functools import cached_property
from typing import NamedTuple

from tiniscript.base.kit import Kit
from tiniscript.base.source import Source, Span
from tiniscript.diagnostics.codes import Code, Diagnostic
from tiniscript.semantics import ir
from tiniscript.syntax.lexer import Scan

STANDING_STATEMENTS = (ir.Read, ir.Assign, ir.Show, ir.Beep)  # they leave the robot where it is
MOST_CHARACTERS = 120  # characters of a condition that a message can hold


class BodyContext(NamedTuple):
    """What a body is in: `loop` repeats it itself, `is_last` where the program ends with it."""

    loop: ir.Loop | ir.While | None = None
    is_repeated: bool = False  # by a loop, or in a DEF
    is_last: bool = False
    asked_sensors: frozenset[int] = frozenset()  # sensors of the conditions around it
    outermost: ir.Loop | ir.While | None = None  # of the loops around it


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
        """Whether M is used; without it the motors stand between two instructions."""
        return any(isinstance(statement, ir.Motors) for statement in self.statements)

    @cached_property
    def variables(self) -> Variables:
        return Variables(self.program, self.kit)

    def head(self, span: Span) -> Span:
        """Return the header that a block begins with, up to the end of its brackets."""
        text, depth = self.source[span], 0
        for k, sign in enumerate(text):
            depth += (sign == "(") - (sign == ")")
            if sign == ")" and not depth:
                return Span(span.start, span.start + k + 1)
        return span

    def condition(self, span: Span, word: str) -> str:
        """Return what is in the brackets after `word`, the last of that name in `span`.

        Nothing where it is long, or goes over several lines.
        """
        text = self.source[span]
        places = [match.end() for match in re.finditer(rf"\b{word}\s*\(", text, re.IGNORECASE)]
        if not places:
            return ""
        begin = places[-1] if word == "UNTIL" else places[0]
        depth = 1
        for k in range(begin, min(len(text), begin + MOST_CHARACTERS)):
            depth += (text[k] == "(") - (text[k] == ")")
            if not depth:
                condition = text[begin:k].strip()
                return "" if re.search(r"[\r\n]|//", condition) else condition
        return ""


class Variables:
    """Which values the variables of a program get, and where."""

    def __init__(self, program: ir.Program, kit: Kit) -> None:
        self._program = program
        self._kit = kit
        self.set_to: dict[int, list[ir.Expression]] = {}
        for statement in ir.all_statements(program):
            if isinstance(statement, ir.Assign):
                self.set_to.setdefault(statement.variable, []).append(statement.value)
        # By a loop's start, the variables that get a value in it; None where it takes no time.
        self._in_loops: dict[int, set[int] | None] = {}
        self._used: dict[int, set[ir.Term]] = {}  # by a loop's start
        self._sets: list[set[int]] = []  # for each DEF, the variables that it gives a value
        for procedure in program.procedures:
            self._sets.append(self.set_in(procedure.body))

    def set_in(self, body: ir.Body) -> set[int]:
        """Return the variables that a body, or a DEF that it calls, gives a value."""
        result = set()
        for statement in ir.walk(body):
            if isinstance(statement, ir.Assign):
                result.add(statement.variable)
            elif isinstance(statement, ir.Call) and statement.procedure < len(self._sets):
                result |= self._sets[statement.procedure]
        return result

    def sensors_of(self, variables: list[int]) -> dict[str, str]:
        """Return the sensor that each of these variables holds; nothing where one holds another."""
        result = {}
        for variable in variables:
            values = set(self.set_to.get(variable, ()))
            value = next(iter(values)) if len(values) == 1 else ()
            if len(value) != 1 or value[0].op != "SENSOR":
                return {}
            name = self._program.variables[variable]
            result[name] = self._kit.readings[value[0].value].name
        return result

    def held_in(self, loop: ir.Loop | ir.While, variables: list[int]) -> dict[str, str]:
        """Return `sensors_of` where a loop drives and gives none of the variables a value."""
        place = loop.span.start
        if place not in self._in_loops:
            drives = any(isinstance(item, (ir.Move, ir.Motors)) for item in ir.walk(loop.body))
            self._in_loops[place] = self.set_in(loop.body) if drives else None
        changed = self._in_loops[place]
        is_held = changed is not None and not changed & set(variables)
        return self.sensors_of(variables) if is_held else {}

    def used_in(self, loop: ir.Loop | ir.While) -> set[ir.Term]:
        """Return the terms of a loop: all sensors, and what statements other than SHOW use."""
        place = loop.span.start
        if place not in self._used:
            self._used[place] = {
                term
                for item in ir.walk((loop,))
                for expression in ir.expressions(item)
                for term in expression
                if term.op == "SENSOR" or not isinstance(item, ir.Show)
            }
        return self._used[place]
