"""The symbols of a program: what each name stands for, and types. Also collects the diagnostics.

Knows the names of the kit, and which names the text gives to variables and DEFs anywhere. The
checker adds names as it reaches them; `types` looks them up.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from tiniscript.base.kit import Kit
from tiniscript.base.source import Edit, Source, Span
from tiniscript.base.words import COMPARATORS
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import MAX_DIAGNOSTICS, Code, Diagnostic, Repair
from tiniscript.syntax import ast

NUMBER, YES_NO, ANY = "number", "yes_no", "any"  # ANY: a mistake was already reported there
YES_NO_OPS = frozenset(("TRUE", "FALSE", "NOT", "AND", "OR", *(name for name, _ in COMPARATORS)))


class Name(NamedTuple):
    """The meaning of a name: a sensor, an actuator, a variable or a DEF, with its number."""

    kind: str
    number: int


class Operand(NamedTuple):
    """A value of an expression, its place, and the stack depth that it needs."""

    type: str
    depth: int
    start: int
    end: int


class Scope:
    def __init__(self, source: Source, kit: Kit, parsed_program: ast.Program) -> None:
        self.source = source
        self.kit = kit
        self.diagnostics: list[Diagnostic] = []
        self.names = {
            device.name: Name("sensor", i) for i, device in enumerate(kit.readings) if device.name
        }
        self.yes_no_sensors = frozenset(
            reading.name for reading in kit.readings if reading.is_yes_no
        )
        for i, device in enumerate(kit.actuators):
            self.names[device.name] = Name("actuator", i)
        self._first_assignments = {
            assignment.name: assignment
            for assignment in reversed(_assignments(parsed_program.body))
        }
        self.assigned_names = self._first_assignments.keys()
        self.parsed_program = parsed_program
        self.def_names = {node.name for node in parsed_program.body if isinstance(node, ast.Def)}
        self.unset_names_of_def: dict[str, list[str]] = {}  # unassigned names in a DEF

    def report(self, code: Code, span: Span, place: Span | None = None, **values: str) -> None:
        self.diagnostics.append(Diagnostic(code, span, values, place))

    def report_used_before_set(self, name: str, use_span: Span, suggestion: str) -> None:
        """Say that `name` is used before it has a value, and how it gets one first."""
        hints = self._line_to_move_up(name, use_span)
        body = self.parsed_program.body
        enclosing_statement = next(
            (node for node in body if node.span.end > use_span.start), body[0]
        )
        line_number = self.source.position(enclosing_statement.span.start)[0]
        if hints["line"] and line_number < self.source.position(use_span.start)[0]:
            hints = {
                **hints,
                "row": str(line_number),
            }  # inside a block it would be done again and again
        insert_offset = (enclosing_statement if hints["line"] else body[0]).span.start
        value = hints["first"] or hints["before"] or f"{name} = {hints['zero']}"
        separator = "\n" if "\n" in self.source.text else "; "
        edits = [Edit(Span(insert_offset, insert_offset), value + separator)]
        if hints["line"]:
            edits.append(Edit(self.source.line_span(int(hints["line"])), ""))
        values = {"name": name, "near": suggestion, **hints}
        repair = Repair(tuple(edits), False)
        self.diagnostics.append(Diagnostic(codes.USED_BEFORE_SET, use_span, values, None, repair))

    def _line_to_move_up(self, name: str, use_span: Span) -> dict[str, str]:
        """Return the number and the text of the later line that only gives `name` a number."""
        use_line = self.source.position(use_span.start)[0]
        for node in self.parsed_program.body:
            if isinstance(node, ast.Assign) and node.name == name and node.value is not None:
                line = self.source.position(node.span.start)[0]
                text = self.source.line_text(line).strip()
                is_whole_line = text == self.source[node.span].strip()
                if line > use_line and is_whole_line and node.value.is_plain:
                    return {"line": str(line), "first": text}
                break
        zero = "FALSE" if self._is_yes_no(name) else "0"
        return {"line": "", "first": "", "before": self._first_number(name), "zero": zero}

    def _first_number(self, name: str) -> str:
        """Return `V = 80`, what gives `name` its first value, where that is a plain number."""
        node = self._first_assignments.get(name)
        return self.source[node.span] if node and node.value and node.value.is_plain else ""

    def _is_yes_no(self, name: str) -> bool:
        """Return whether the first value assigned to `name` looks like a yes-no value."""
        node = self._first_assignments.get(name)
        if node is None or node.value is None or not node.value.expression:
            return False
        last_part = node.value.expression[-1]
        is_sensor = last_part.op == "NAME" and last_part.value in self.yes_no_sensors
        return last_part.op in YES_NO_OPS or is_sensor

    def is_yes_no_sensor(self, name: str) -> bool:
        return name in self.yes_no_sensors

    def nearest_word(self, word: str, known_words: Iterable[str]) -> str:
        """Return the nearest known word for a message, for the first MAX_DIAGNOSTICS mistakes.

        After that `known_words` is not searched: a long program with many mistakes stays fast.
        """
        if len(self.diagnostics) >= MAX_DIAGNOSTICS:
            return ""
        from tiniscript.base.spelling import nearest

        return nearest(word, known_words) or ""


def _assignments(body: Sequence[ast.Instruction]) -> list[ast.Assign]:
    """Return all that set a variable of the whole program, in the order of the text."""
    assignments: list[ast.Assign] = []
    for node in body:
        if isinstance(node, ast.Assign):
            assignments.append(node)
        elif isinstance(node, ast.If):
            for arm in node.arms:
                assignments += _assignments(arm.body)
            assignments += _assignments(node.else_body)
        elif isinstance(node, ast.Def):
            parameter_names = {parameter.name for parameter in node.parameters}
            assignments += (
                assignment
                for assignment in _assignments(node.body)
                if assignment.name not in parameter_names
            )
        elif isinstance(node, (ast.Loop, ast.While, ast.Task)):
            assignments += _assignments(node.body)
    return assignments
