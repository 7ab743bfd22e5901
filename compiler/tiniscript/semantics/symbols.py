"""The symbols of a program: what each name stands for; and where diagnostics go.

Knows the names of the kit, and which names the text gives to variables and DEFs anywhere. The
checker fills in what it has come past; `types` asks.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from tiniscript.diagnostics.codes import Code, Problem
from tiniscript.kit import Kit
from tiniscript.source import Source, Span
from tiniscript.syntax import ast
from tiniscript.words import nearest

ENOUGH = 100  # mistakes after which a suggestion helps nobody


class Name(NamedTuple):
    """What a name stands for: a sensor, an actuator, a variable or a DEF, by its number."""

    what: str
    number: int


class Scope:
    def __init__(self, source: Source, kit: Kit, parsed: ast.Program) -> None:
        self.source = source
        self.kit = kit
        self.problems: list[Problem] = []
        self.names = {device.name: Name("sensor", i) for i, device in enumerate(kit.sensors)}
        for i, device in enumerate(kit.actuators):
            self.names[device.name] = Name("actuator", i)
        self.set_somewhere = set(_assigned(parsed.body))
        self.def_names = {each.name for each in parsed.body if isinstance(each, ast.Def)}

    def report(self, code: Code, span: Span, **values: str) -> None:
        self.problems.append(Problem(code, span, values))

    def near(self, word: str, known: Iterable[str]) -> str:
        """Return the nearest known word for a message, as long as messages help.

        Then `known` is not looked at, so that many mistakes in a long program take no longer.
        """
        return (nearest(word, known) or "") if len(self.problems) < ENOUGH else ""


def _assigned(body: Sequence[ast.Instruction]) -> list[str]:
    """Return the names that a program sets anywhere."""
    found: list[str] = []
    for node in body:
        if isinstance(node, ast.Assign):
            found.append(node.name)
        elif isinstance(node, ast.If):
            for arm in node.arms:
                found += _assigned(arm.body)
            found += _assigned(node.otherwise)
        elif isinstance(node, (ast.Loop, ast.While, ast.Def)):
            found += _assigned(node.body)
    return found
