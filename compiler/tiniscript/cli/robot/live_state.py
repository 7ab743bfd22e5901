"""What lives on from one live line to the next: DEFs as text, variables with their values.

The robot forgets a line when it is done. So a line is sent with the DEFs and the variables that it
uses before it, and behind it come instructions that show the values it has given: a mark that no
program shows by chance, then a SHOW for each variable. Knows no port.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from tiniscript import Compiled, compile_text
from tiniscript.cli.robot.live_mark import MARK
from tiniscript.codegen.lower import Place
from tiniscript.diagnostics import codes
from tiniscript.fixed_point import as_text
from tiniscript.kit import Kit
from tiniscript.semantics.ir import Assign, walk
from tiniscript.source import Source, Span
from tiniscript.syntax import ast
from tiniscript.syntax.lexer import WORD, scan
from tiniscript.syntax.parser import parse

_HEADER = re.compile(r"[ \t]*(SI|SB|PING)[ \t]*\|", re.IGNORECASE | re.ASCII)
_UNUSED = (codes.UNUSED_VARIABLE, codes.UNUSED_DEF)


class Value(NamedTuple):
    value: int
    is_yes_no: bool

    @property
    def text(self) -> str:
        if self.is_yes_no:
            return "TRUE" if self.value else "FALSE"
        return as_text(self.value)


class Line(NamedTuple):
    """A line that is compiled: `shown` are the variables whose values it shows behind the mark.

    `defs` are the DEFs in it, which are known once it is done; `does_nothing`: it has nothing
    else; `forgets`: it sets variables, and has no room to show them.
    """

    compiled: Compiled
    shown: tuple[str, ...]
    defs: dict[str, str]
    does_nothing: bool = False
    forgets: bool = False


def header(text: str) -> str:
    """Return SI, SB or PING: what a line starts with, SI where it says nothing."""
    found = _HEADER.match(text)
    return found[1].upper() if found else "SI"


class Known:
    """The DEFs and the variables of a live session."""

    def __init__(self, kit: Kit) -> None:
        self.kit = kit
        self.defs: dict[str, str] = {}
        self.values: dict[str, Value] = {}

    def names(self) -> list[str]:
        return [*self.defs, *self.values]

    def line(self, text: str, room: int) -> Line:
        """Compile a line, with what is known before it; its code has room for so many bytes."""
        found = _HEADER.match(text)
        body = " " * found.end() + text[found.end() :] if found else text
        parsed = parse(Source(body), self.kit).program.body
        own = {node.name: body[node.span.start : node.span.end] for node in parsed
               if isinstance(node, ast.Def)}  # fmt: skip
        values, defs = self._before(body, own)
        before = values + defs
        plain = compile_text(f"{before}{body}", self.kit)
        if not plain.is_right:
            return Line(_behind(plain, len(before)), (), own)
        shown = _assigned(plain, len(values))
        if all(isinstance(node, ast.Def) for node in parsed):
            return Line(_behind(plain, len(before)), (), own, does_nothing=True)
        if shown:
            behind = "".join(f"\nSHOW({name})" for name in (as_text(MARK), *shown))
            full = compile_text(f"{before}{body}{behind}", self.kit)
            if full.is_right and len(full.code) <= room:
                return Line(_behind(full, len(before), len(before + body)), shown, own)
        return Line(_behind(plain, len(before)), (), own, forgets=bool(shown))

    def _before(self, text: str, own: dict[str, str]) -> tuple[str, str]:
        """Return the variables and the DEFs that a line needs, as text."""
        used: set[str] = set()
        texts = [text]
        while texts:
            words = {token.text for token in scan(texts.pop()).tokens if token.kind is WORD}
            texts += [self.defs[name] for name in words - used if name in self.defs]
            used |= words
        values = "".join(f"{name} = {value.text}\n" for name, value in self.values.items()
                         if name in used)  # fmt: skip
        defs = "".join(f"{each}\n" for name, each in self.defs.items()
                       if name in used and name not in own)  # fmt: skip
        return values, defs


def _assigned(compiled: Compiled, start: int) -> tuple[str, ...]:
    """Return the variables that are set from `start` on."""
    program = compiled.program
    assert program is not None
    numbers = {
        each.variable
        for body in (program.body, *(procedure.body for procedure in program.procedures))
        for each in walk(body)
        if isinstance(each, Assign) and each.span.start >= start
    }
    return tuple(program.variables[number] for number in sorted(numbers))


def _behind(compiled: Compiled, start: int, end: int | None = None) -> Compiled:
    """Return what there is to say of the text from `start` to `end`, as if it stood alone.

    A mistake before it stays where it is: then all of the text is the source. That a DEF is not
    called, or a variable not used, is no mistake here: the next line may do it.
    """
    text = compiled.source.text
    end = len(text) if end is None else end
    if any(problem.is_mistake and problem.span.start < start for problem in compiled.problems):
        return compiled
    problems = [
        problem._replace(span=Span(problem.span.start - start, min(problem.span.end, end) - start))
        for problem in compiled.problems
        if start <= problem.span.start <= end
        and (problem.is_mistake or problem.code not in _UNUSED)
        and (problem.span.start < end or end == len(text))
    ]
    places = tuple(
        Place(place.offset, Span(max(0, place.span.start - start), max(0, place.span.end - start)))
        for place in compiled.places
    )
    source = Source(text[start:end], "live")
    return compiled._replace(source=source, problems=problems, places=places)
