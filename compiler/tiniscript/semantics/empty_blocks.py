"""A warning for a block with nothing inside, beside what was probably meant to be in it.

`LOOP(4)`, `END_LOOP`, and the moves below. Knows the IR and the text. Says nothing of an endless
LOOP or a WHILE, which wait, nor of a block with a note inside or
behind its end.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import takewhile

from tiniscript.base.source import Source, Span
from tiniscript.base.words import BLOCK_ENDS
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.semantics import ir

_NOTE_BEHIND = re.compile(r"[ \t;]{0,99}//")
MANY = 12  # instructions that an example has


def empty_blocks(program: ir.Program, source: Source) -> list[Diagnostic]:
    """Return the warnings for a program that has no mistakes."""
    rest = list(reversed(ir.routines(program)))
    found: list[Diagnostic] = []
    while rest:
        body = rest.pop()
        found += _empty_in(body, source)
        rest += [inner for statement in body for inner in ir.bodies(statement)]
    return found


def _empty_in(body: ir.Body, source: Source) -> Iterator[Diagnostic]:
    for k, statement in enumerate(body):
        if not _is_empty(statement):
            continue
        text = source[statement.span]
        if "//" in text or _NOTE_BEHIND.match(source.text, statement.span.end):
            continue
        word = "IF" if isinstance(statement, ir.If) else "LOOP"
        span = Span(statement.span.start, statement.span.start + _end_of_head(text))
        behind = _said(body[k + 1 :], source)
        before = [] if behind else _said(body[k - 1 :: -1] if k else (), source)[::-1]
        if not behind and not before:
            continue
        shown, end = " ".join(source[span].split()), BLOCK_ENDS[word]
        values = {"head": shown, "end": end}
        for name, rows in (("example", behind), ("before", before)):
            if 0 < len(rows) <= MANY:
                values[name] = "; ".join((shown, *rows, end))
        yield Diagnostic(codes.EMPTY_BLOCK, span, values)


def _end_of_head(text: str) -> int:
    """Return the place behind the brackets of a header at the beginning of a right text."""
    depth = 0
    for k, sign in enumerate(text):
        depth += (sign == "(") - (sign == ")")
        if sign == ")" and not depth:
            return k + 1
    return len(text)


def _is_empty(statement: ir.Statement) -> bool:
    if isinstance(statement, ir.Loop):
        return statement.times is not None and not statement.body
    if isinstance(statement, ir.If):
        return len(statement.arms) == 1 and not statement.arms[0].body and not statement.has_else
    return False


def _said(statements: Sequence[ir.Statement], source: Source) -> list[str]:
    """Return the instructions at the beginning of a row that are no blocks, as written."""
    plain = takewhile(
        lambda each: not isinstance(each, (ir.If, ir.Loop, ir.While, ir.Break)), statements
    )
    return [source[each.span] for each in plain if not isinstance(each, ir.Read)]
