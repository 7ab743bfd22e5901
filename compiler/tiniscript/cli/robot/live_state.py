"""The state between two live lines: DEFs as text, variables with their values.

The robot forgets a line when it is done. So tsc puts the DEFs and variables that a line uses before
it. After it come instructions that show the new values: a mark that no program shows by chance,
then a SHOW for each variable. Knows no port.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from tiniscript.base.fixed_point import as_text, value_text
from tiniscript.base.kit import Kit
from tiniscript.base.source import Source, Span
from tiniscript.base.words import ALIASES, BLOCK_ENDS
from tiniscript.cli.robot.bookkeeping import BOOKKEEPING_MARK
from tiniscript.diagnostics import codes
from tiniscript.library import source_map
from tiniscript.library.compiling import Compilation, compile_text
from tiniscript.library.source_map import SourceMap
from tiniscript.semantics.ir import Assign, walk
from tiniscript.syntax import ast
from tiniscript.syntax.lexer import WORD, scan
from tiniscript.syntax.parser import parse

_HEADER = re.compile(r"[ \t]*(SI|SB|PING)[ \t]*\|", re.IGNORECASE | re.ASCII)
_UNUSED_CODES = (codes.UNUSED_VARIABLE, codes.UNUSED_DEF)


class LiveValue(NamedTuple):
    value: int
    is_yes_no: bool


class LiveLine(NamedTuple):
    """A compiled line: `shown_variables` are the variables whose values it shows after the mark.

    `text_by_def` has the DEFs in it, which are known once it has run; `has_only_defs`: it consists
    of DEFs; `loses_values`: it sets variables, but has no room to show them. `whole_map` is the map
    of the line with the DEFs and variables before it, which have `lines_before` lines.
    """

    compilation: Compilation
    shown_variables: tuple[str, ...]
    text_by_def: dict[str, str]
    has_only_defs: bool = False
    loses_values: bool = False
    whole_map: SourceMap | None = None
    lines_before: int = 0


def header(text: str) -> str:
    """Return the start of a line: SI, SB or PING; the default is SI."""
    match = _HEADER.match(text)
    return match[1].upper() if match else "SI"


def missing_ends(text: str) -> str:
    """Return the ends that are missing of the blocks of a text, `END_LOOP; END_DEF`; the text may
    continue there. The result is empty if no block is open, or an end has no block."""
    ends: list[str] = []
    for token in scan(text).tokens:
        word = ALIASES.get(token.text, token.text) if token.kind is WORD else ""
        if word in BLOCK_ENDS:
            ends.append(BLOCK_ENDS[word])
        elif word in BLOCK_ENDS.values() and (not ends or ends.pop() != word):
            return ""
    return "; ".join(reversed(ends))


class LiveState:
    """The DEFs and the variables of a live session."""

    def __init__(self, kit: Kit) -> None:
        self.kit = kit
        self.text_by_def: dict[str, str] = {}
        self.value_by_name: dict[str, LiveValue] = {}

    def names(self) -> list[str]:
        return [*self.text_by_def, *self.value_by_name]

    def compile_line(self, text: str, room: int) -> LiveLine:
        """Compile a line after the known DEFs and variables into at most `room` bytes of code."""
        match = _HEADER.match(text)
        body = " " * match.end() + text[match.end() :] if match else text
        instructions = parse(Source(body)).program.body
        def_texts = {node.name: body[node.span.start : node.span.end] for node in instructions
                     if isinstance(node, ast.Def)}  # fmt: skip
        values, defs = self._definitions_for(body, def_texts)
        prefix = values + defs
        plain_compilation = compile_text(f"{prefix}{body}", self.kit)
        if not plain_compilation.is_right:
            return LiveLine(_compiled_part(plain_compilation, len(prefix)), (), def_texts)
        assigned_variables = _assigned_variables(plain_compilation, len(values))
        if all(isinstance(node, ast.Def) for node in instructions):
            return LiveLine(
                _compiled_part(plain_compilation, len(prefix)), (), def_texts, has_only_defs=True
            )
        if assigned_variables:
            suffix = "".join(
                f"\nSHOW({name})" for name in (as_text(BOOKKEEPING_MARK), *assigned_variables)
            )
            full_compilation = compile_text(f"{prefix}{body}{suffix}", self.kit)
            if full_compilation.is_right and len(full_compilation.code) <= room:
                own_part = _compiled_part(full_compilation, len(prefix), len(prefix + body))
                whole_map = _map_of(full_compilation, len(prefix + body))
                return LiveLine(
                    own_part,
                    assigned_variables,
                    def_texts,
                    whole_map=whole_map,
                    lines_before=prefix.count("\n"),
                )
        own_part = _compiled_part(plain_compilation, len(prefix))
        whole_map = _map_of(plain_compilation, len(prefix + body))
        return LiveLine(
            own_part, (), def_texts, False, bool(assigned_variables), whole_map, prefix.count("\n")
        )

    def _definitions_for(self, text: str, def_texts: dict[str, str]) -> tuple[str, str]:
        """Return the variables and the DEFs that a line needs, as text; a DEF comes after those
        that it calls."""
        used_names: set[str] = set()
        defs: list[str] = []

        def collect(needing_text: str) -> None:
            for token in scan(needing_text).tokens:
                name = token.text
                if token.kind is not WORD or name in used_names:
                    continue
                used_names.add(name)
                if name in self.text_by_def and name not in def_texts:
                    collect(self.text_by_def[name])
                    defs.append(f"{self.text_by_def[name]}\n")

        collect(text)
        values = "".join(
            f"{name} = {value_text(*value)}\n"
            for name, value in self.value_by_name.items()
            if name in used_names
        )
        return values, "".join(defs)


def _assigned_variables(compilation: Compilation, start: int) -> tuple[str, ...]:
    """Return the variables that are set from `start` on."""
    program = compilation.program
    assert program is not None
    variable_numbers = {
        statement.variable
        for body in (program.body, *(procedure.body for procedure in program.procedures))
        for statement in walk(body)
        if isinstance(statement, Assign) and statement.span.start >= start
    }
    return tuple(program.variables[number] for number in sorted(variable_numbers))


def _map_of(compilation: Compilation, end: int) -> SourceMap:
    """Return the map of the text up to `end`; later code has no place."""
    empty_span = Span(end, end)
    locations = tuple(
        location if location.span.end <= end else location._replace(span=empty_span)
        for location in compilation.locations
    )
    return source_map.map_of_compiled(compilation._replace(locations=locations))


def _compiled_part(compilation: Compilation, start: int, end: int | None = None) -> Compilation:
    """Return the diagnostics of the text from `start` to `end`, as if it stood alone.

    For a mistake before `start` the source is the whole text. An unused DEF or variable gives no
    diagnostic: the next line may use it.
    """
    text = compilation.source.text
    end = len(text) if end is None else end
    if any(
        diagnostic.is_mistake and diagnostic.span.start < start
        for diagnostic in compilation.diagnostics
    ):
        return compilation
    diagnostics = [
        diagnostic._replace(
            span=Span(diagnostic.span.start - start, min(diagnostic.span.end, end) - start)
        )
        for diagnostic in compilation.diagnostics
        if start <= diagnostic.span.start <= end
        and (diagnostic.is_mistake or diagnostic.code not in _UNUSED_CODES)
        and (diagnostic.span.start < end or end == len(text))
    ]
    locations = tuple(
        location._replace(
            span=Span(max(0, location.span.start - start), max(0, location.span.end - start))
        )
        for location in compilation.locations
    )
    source = Source(text[start:end], "live")
    return compilation._replace(source=source, diagnostics=diagnostics, locations=locations)
