"""The state between two live lines: DEFs as text, variables with their values.

The robot forgets a line when it is done. So tsc puts the DEFs and variables that a line uses
before it, and instructions after it that show the new values: a mark that no program shows by
chance, then a SHOW for each variable. Knows no port.
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
from tiniscript.library.compiling import Compiled, compile_text
from tiniscript.library.source_map import Map
from tiniscript.semantics.ir import Assign, walk
from tiniscript.syntax import ast
from tiniscript.syntax.lexer import WORD, scan
from tiniscript.syntax.parser import parse

_HEADER = re.compile(r"[ \t]*(SI|SB|PING)[ \t]*\|", re.IGNORECASE | re.ASCII)
_UNUSED = (codes.UNUSED_VARIABLE, codes.UNUSED_DEF)


class Value(NamedTuple):
    value: int
    is_yes_no: bool


class Line(NamedTuple):
    """A compiled line: `shown` are the variables whose values it shows after the mark.

    `defs` are the DEFs in it, which are known once it is done; `does_nothing`: it has nothing
    but DEFs; `forgets`: it sets variables, but has no room to show them. `whole` is the map of the
    line with the DEFs and variables before it, which have `before` lines.
    """

    compiled: Compiled
    shown: tuple[str, ...]
    defs: dict[str, str]
    does_nothing: bool = False
    forgets: bool = False
    whole: Map | None = None
    before: int = 0


def header(text: str) -> str:
    """Return the start of a line: SI, SB or PING; the default is SI."""
    match = _HEADER.match(text)
    return match[1].upper() if match else "SI"


def open_ends(text: str) -> str:
    """Return the ends that are missing of the blocks of a text, `END_LOOP; END_DEF`; the text may
    go on there. Nothing where none is open, or an end is one of no block."""
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
        self.defs: dict[str, str] = {}
        self.values: dict[str, Value] = {}

    def names(self) -> list[str]:
        return [*self.defs, *self.values]

    def line(self, text: str, room: int) -> Line:
        """Compile a line after the known DEFs and variables into at most `room` bytes of code."""
        match = _HEADER.match(text)
        body = " " * match.end() + text[match.end() :] if match else text
        instructions = parse(Source(body)).program.body
        own_texts = {node.name: body[node.span.start : node.span.end] for node in instructions
                     if isinstance(node, ast.Def)}  # fmt: skip
        values, defs = self._definitions_for(body, own_texts)
        before = values + defs
        plain = compile_text(f"{before}{body}", self.kit)
        if not plain.is_right:
            return Line(_compiled_part(plain, len(before)), (), own_texts)
        shown = _assigned_variables(plain, len(values))
        if all(isinstance(node, ast.Def) for node in instructions):
            return Line(_compiled_part(plain, len(before)), (), own_texts, does_nothing=True)
        if shown:
            after = "".join(f"\nSHOW({name})" for name in (as_text(BOOKKEEPING_MARK), *shown))
            full = compile_text(f"{before}{body}{after}", self.kit)
            if full.is_right and len(full.code) <= room:
                line = _compiled_part(full, len(before), len(before + body))
                whole = _map_of(full, len(before + body))
                return Line(line, shown, own_texts, whole=whole, before=before.count("\n"))
        line = _compiled_part(plain, len(before))
        whole = _map_of(plain, len(before + body))
        return Line(line, (), own_texts, False, bool(shown), whole, before.count("\n"))

    def _definitions_for(self, text: str, own_texts: dict[str, str]) -> tuple[str, str]:
        """Return the variables and the DEFs that a line needs, as text."""
        names_used: set[str] = set()
        texts = [text]
        while texts:
            words = {token.text for token in scan(texts.pop()).tokens if token.kind is WORD}
            texts += [self.defs[name] for name in words - names_used if name in self.defs]
            names_used |= words
        values = "".join(f"{name} = {value_text(*value)}\n" for name, value in self.values.items()
                         if name in names_used)  # fmt: skip
        defs = "".join(f"{value}\n" for name, value in self.defs.items()
                       if name in names_used and name not in own_texts)  # fmt: skip
        return values, defs


def _assigned_variables(compilation: Compiled, start: int) -> tuple[str, ...]:
    """Return the variables that are set from `start` on."""
    program = compilation.program
    assert program is not None
    numbers = {
        item.variable
        for body in (program.body, *(procedure.body for procedure in program.procedures))
        for item in walk(body)
        if isinstance(item, Assign) and item.span.start >= start
    }
    return tuple(program.variables[number] for number in sorted(numbers))


def _map_of(compilation: Compiled, end: int) -> Map:
    """Return the map of the text up to `end`; what is after it comes from nowhere."""
    nowhere = Span(end, end)
    places = tuple(
        place if place.span.end <= end else place._replace(span=nowhere)
        for place in compilation.places
    )
    return source_map.map_of_compiled(compilation._replace(places=places))


def _compiled_part(compilation: Compiled, start: int, end: int | None = None) -> Compiled:
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
        and (diagnostic.is_mistake or diagnostic.code not in _UNUSED)
        and (diagnostic.span.start < end or end == len(text))
    ]
    places = tuple(
        place._replace(span=Span(max(0, place.span.start - start), max(0, place.span.end - start)))
        for place in compilation.places
    )
    source = Source(text[start:end], "live")
    return compilation._replace(source=source, diagnostics=diagnostics, places=places)
