"""Finds the kinds of the values of a DEF: that of its first call in the text.

The body of a DEF comes before its calls, and needs the kinds. Only programs that have a DEF with
values load this.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from tiniscript.semantics.symbols import NUMBER, YES_NO, YES_NO_OPS
from tiniscript.syntax import ast


class _ScopedExpression(NamedTuple):
    """An expression, and the DEF around it, if there is one."""

    expression: ast.Expression
    enclosing_def: ast.Def | None


class ParameterKinds:
    """The kinds of the values of all DEFs of a program."""

    def __init__(self, parsed_program: ast.Program, yes_no_sensors: frozenset[str]) -> None:
        self._sensors = yes_no_sensors
        self._first_calls: dict[
            str, tuple[ast.Command, ast.Def | None]
        ] = {}  # the first of each name
        self._first_values: dict[str, _ScopedExpression] = {}  # first value of each variable
        defs = (node for node in parsed_program.body if isinstance(node, ast.Def))
        names = {node.name: [parameter.name for parameter in node.parameters] for node in defs}
        for node, enclosing_def in _instructions(parsed_program.body, None):
            if isinstance(node, ast.Command):
                if not names_a_value(node, names.get(node.word, ())):  # reported elsewhere
                    self._first_calls.setdefault(node.word, (node, enclosing_def))
            elif node.value is not None and _parameter(node.name, enclosing_def) is None:
                self._first_values.setdefault(
                    node.name, _ScopedExpression(node.value.expression, enclosing_def)
                )

    def kinds_of(self, node: ast.Def) -> list[str]:
        """Return NUMBER or YES_NO for each value of a DEF."""
        return [self._kind_of(self._first_argument(node, k)) for k in range(len(node.parameters))]

    def _kind_of(self, scoped_expression: _ScopedExpression | None) -> str:
        """Follow a name to what it gets its kind from; in a circle it is a number."""
        names_followed: set[tuple[str, str]] = set()
        while scoped_expression is not None:
            last_part, enclosing_def = (
                scoped_expression.expression[-1],
                scoped_expression.enclosing_def,
            )
            if last_part.op != "NAME":
                return YES_NO if last_part.op in YES_NO_OPS else NUMBER
            name = str(last_part.value)
            k = _parameter(name, enclosing_def)
            key = (name, "" if enclosing_def is None or k is None else enclosing_def.name)
            if key in names_followed:
                break
            names_followed.add(key)
            if enclosing_def is not None and k is not None:
                scoped_expression = self._first_argument(enclosing_def, k)
            elif name in self._sensors:
                return YES_NO
            else:
                scoped_expression = self._first_values.get(name)
        return NUMBER

    def _first_argument(self, node: ast.Def, k: int) -> _ScopedExpression | None:
        """Return the argument of the first call for a parameter of a DEF."""
        call, calling_def = self._first_calls.get(node.name, (None, None))
        arguments = () if call is None else call.arguments or ()
        return (
            _ScopedExpression(arguments[k].expression, calling_def) if k < len(arguments) else None
        )


def names_a_value(call: ast.Command, names: Sequence[str]) -> bool:
    """Return whether a call names a parameter of its DEF: `SIDE(size=20)`."""
    expressions = (argument.expression for argument in call.arguments or ())
    return any(
        expression[0].op == "NAME" and expression[0].value in names and expression[-1].op == "EQ"
        for expression in expressions
    )


def _parameter(name: str, enclosing_def: ast.Def | None) -> int | None:
    names = (
        [] if enclosing_def is None else [parameter.name for parameter in enclosing_def.parameters]
    )
    return names.index(name) if name in names else None


def _instructions(
    body: Sequence[ast.Instruction], enclosing_def: ast.Def | None
) -> Iterator[tuple[ast.Command | ast.Assign, ast.Def | None]]:
    """Yield the commands and assignments of a body in the order of the text."""
    for node in body:
        if isinstance(node, (ast.Command, ast.Assign)):
            yield node, enclosing_def
        elif isinstance(node, ast.If):
            for arm in node.arms:
                yield from _instructions(arm.body, enclosing_def)
            yield from _instructions(node.else_body, enclosing_def)
        elif isinstance(node, ast.Def):
            yield from _instructions(node.body, node)
        elif not isinstance(node, ast.Break):
            yield from _instructions(node.body, enclosing_def)
