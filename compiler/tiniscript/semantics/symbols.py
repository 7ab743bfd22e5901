"""The symbols of a program: what each name stands for. Also collects the diagnostics.

Knows the names of the kit, and which names the text gives to variables and DEFs anywhere. The
checker adds names as it reaches them; `types` looks them up.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from tiniscript.diagnostics.codes import Code, Diagnostic
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
        self.diagnostics: list[Diagnostic] = []
        self.names = {device.name: Name("sensor", i) for i, device in enumerate(kit.sensors)}
        for i, device in enumerate(kit.actuators):
            self.names[device.name] = Name("actuator", i)
        self.set_somewhere = set(_assigned(parsed.body))
        self.parsed = parsed
        self.def_names = {each.name for each in parsed.body if isinstance(each, ast.Def)}

    def report(self, code: Code, span: Span, place: Span | None = None, **values: str) -> None:
        self.diagnostics.append(Diagnostic(code, span, values, place))

    def line_to_move_up(self, name: str, used: Span) -> dict[str, str]:
        """Return the number and the text of the later line that only gives `name` a number."""
        here = self.source.position(used.start)[0]
        for node in self.parsed.body:
            if isinstance(node, ast.Assign) and node.name == name and node.value is not None:
                line = self.source.position(node.span.start)[0]
                text = self.source.line_text(line).strip()
                is_alone = text == self.source[node.span].strip()
                if line > here and is_alone and node.value.is_plain:
                    return {"line": str(line), "first": text}
                break
        return {"line": "", "first": ""}

    def near(self, word: str, known: Iterable[str]) -> str:
        """Return the nearest known word for a message, for the first ENOUGH mistakes.

        After that `known` is not searched, so that a long program with many mistakes stays fast.
        """
        return (nearest(word, known) or "") if len(self.diagnostics) < ENOUGH else ""


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
