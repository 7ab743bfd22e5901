"""The diagnostics of one parse. Knows how the parser abandons an instruction: it raises Failed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NoReturn

from tiniscript.base.source import Span
from tiniscript.diagnostics.codes import Code, Diagnostic


class Failed(Exception):
    """An instruction cannot be read to its end. This is reported; its line is skipped."""


class Reporter:
    """`diagnostics` begins with those of the lexer."""

    def __init__(self, lexer_diagnostics: Sequence[Diagnostic]) -> None:
        self.diagnostics = [*lexer_diagnostics]

    def report(self, code: Code, span: Span, **values: str) -> None:
        self.diagnostics.append(Diagnostic(code, span, values))

    def fail(self, code: Code, span: Span, **values: str) -> NoReturn:
        self.report(code, span, **values)
        raise Failed
