"""Which kind the values of a DEF have: that of its first call in the text.

The body of a DEF stands before its calls, and needs to know. Only programs that have a DEF with
values load this.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from tiniscript.semantics.symbols import NUMBER, YES_NO, YES_NO_OPS
from tiniscript.syntax import ast


class _Place(NamedTuple):
    """An expression, and the DEF around it, where there is one."""

    expression: ast.Expression
    around: ast.Def | None


class Kinds:
    """The kinds of the values of all DEFs of a program."""

    def __init__(self, parsed: ast.Program, yes_no_sensors: frozenset[str]) -> None:
        self._sensors = yes_no_sensors
        self._calls: dict[str, tuple[ast.Command, ast.Def | None]] = {}  # the first of each name
        self._set: dict[str, _Place] = {}  # what each variable gets first
        defs = (each for each in parsed.body if isinstance(each, ast.Def))
        names = {each.name: [item.name for item in each.parameters] for each in defs}
        for node, around in _instructions(parsed.body, None):
            if isinstance(node, ast.Command):
                if not names_one(node, names.get(node.word, ())):  # which is told of
                    self._calls.setdefault(node.word, (node, around))
            elif node.value is not None and _parameter(node.name, around) is None:
                self._set.setdefault(node.name, _Place(node.value.expression, around))

    def kinds_of(self, node: ast.Def) -> list[str]:
        """Return NUMBER or YES_NO for each value of a DEF."""
        return [self._kind_of(self._parameter_place(node, k)) for k in range(len(node.parameters))]

    def _kind_of(self, place: _Place | None) -> str:
        """Follow a name to what it gets its kind from; in a circle it is a number."""
        seen: set[tuple[str, str]] = set()
        while place is not None:
            last, around = place.expression[-1], place.around
            if last.op != "NAME":
                return YES_NO if last.op in YES_NO_OPS else NUMBER
            name = str(last.value)
            k = _parameter(name, around)
            key = (name, "" if around is None or k is None else around.name)
            if key in seen:
                break
            seen.add(key)
            if around is not None and k is not None:
                place = self._parameter_place(around, k)
            elif name in self._sensors:
                return YES_NO
            else:
                place = self._set.get(name)
        return NUMBER

    def _parameter_place(self, node: ast.Def, k: int) -> _Place | None:
        """Return what the first call gives to a value of a DEF."""
        call, around = self._calls.get(node.name, (None, None))
        arguments = () if call is None else call.arguments or ()
        return _Place(arguments[k].expression, around) if k < len(arguments) else None


def names_one(call: ast.Command, names: Sequence[str]) -> bool:
    """Whether a call names a value of its DEF: `SIDE(size=20)`."""
    asked = (argument.expression for argument in call.arguments or ())
    return any(
        item[0].op == "NAME" and item[0].value in names and item[-1].op == "EQ" for item in asked
    )


def _parameter(name: str, around: ast.Def | None) -> int | None:
    names = [] if around is None else [parameter.name for parameter in around.parameters]
    return names.index(name) if name in names else None


def _instructions(
    body: Sequence[ast.Instruction], around: ast.Def | None
) -> Iterator[tuple[ast.Command | ast.Assign, ast.Def | None]]:
    """Yield the commands and assignments of a body in the order of the text."""
    for node in body:
        if isinstance(node, (ast.Command, ast.Assign)):
            yield node, around
        elif isinstance(node, ast.If):
            for arm in node.arms:
                yield from _instructions(arm.body, around)
            yield from _instructions(node.otherwise, around)
        elif isinstance(node, ast.Def):
            yield from _instructions(node.body, node)
        elif not isinstance(node, ast.Break):
            yield from _instructions(node.body, around)
