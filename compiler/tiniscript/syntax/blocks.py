"""The stack of open blocks while a program is parsed, and the AST that they become.

Knows which instructions belong to which block. Knows no tokens but the names of DEFs.
"""

from __future__ import annotations

from collections.abc import Sequence

from tiniscript.base.limits import BLOCKS, TASKS
from tiniscript.base.source import Span
from tiniscript.base.words import ALIASES, BLOCK_ENDS
from tiniscript.base.words import TASKS as TASK_WORDS
from tiniscript.diagnostics import codes
from tiniscript.syntax.ast import (
    Argument,
    Arm,
    Def,
    If,
    Instruction,
    Loop,
    Parameter,
    Task,
    While,
)
from tiniscript.syntax.lexer import Token
from tiniscript.syntax.reporter import Reporter

HEADERS = frozenset(BLOCK_ENDS) - {"DEF", "TASK"}  # with brackets: IF, LOOP, WHILE, WHEN
ENDS = {end: word for word, end in BLOCK_ENDS.items()}  # ENDIF: IF …
ENDS |= {alias: ENDS[end] for alias, end in ALIASES.items()}


class Block:
    """A block whose end has not come yet."""

    __slots__ = ("arms", "body", "head", "name", "otherwise", "parameters", "span", "word")

    def __init__(
        self,
        word: str,
        span: Span,
        head: Argument | None,
        name: Token | None,
        parameters: Sequence[Parameter],
    ) -> None:
        self.word = word  # IF, LOOP, WHILE, DEF, TASK or WHEN
        self.span = span  # of the header: where a block that never ends is reported
        self.head = head  # the condition or the count of the arm that is being read
        self.name = name  # of a DEF
        self.parameters = parameters  # of a DEF
        self.body: list[Instruction] = []
        self.arms: list[Arm] = []
        self.otherwise: list[Instruction] | None = None  # what follows ELSE, once it has come

    @property
    def header(self) -> Span:
        """The header of its first arm."""
        return self.arms[0].span if self.arms else self.span

    @property
    def current_body(self) -> list[Instruction]:
        """Where the next instruction belongs."""
        return self.body if self.otherwise is None else self.otherwise

    def next_arm(self, head: Argument | None, span: Span) -> None:
        self.arms.append(Arm(self.head, tuple(self.body), self.span))
        self.body, self.head, self.span = [], head, span


class Blocks:
    """A stack of its own instead of Python's: `open[-1]` is the innermost block."""

    def __init__(self, reporter: Reporter) -> None:
        self._reporter = reporter
        self.program: list[Instruction] = []
        self.open: list[Block] = []
        self.tasks = 0  # TASKs and WHENs that have begun at the top level
        self._depth = 0  # open blocks, those that stand at the top level alone not counted

    @property
    def innermost(self) -> Block | None:
        return self.open[-1] if self.open else None

    @property
    def current_body(self) -> list[Instruction]:
        """Where the next instruction belongs."""
        return self.open[-1].current_body if self.open else self.program

    def begin(
        self,
        word: str,
        span: Span,
        head: Argument | None = None,
        name: Token | None = None,
        parameters: Sequence[Parameter] = (),
    ) -> None:
        if word in TASK_WORDS and self.open:
            enclosing = self.open[-1].word
            self._reporter.report(codes.TASK_NOT_TOP, span, word=word, around=enclosing)
        elif word in TASK_WORDS:
            self.tasks += 1
            if self.tasks == TASKS + 1:
                self._reporter.report(codes.TOO_MANY_TASKS, span, limit=str(TASKS))
        elif word == "DEF":
            if self.open:
                self._reporter.report(codes.DEF_NOT_TOP, span)
        else:
            self._depth += 1
            if self._depth == BLOCKS + 1:
                self._reporter.report(codes.BLOCKS_TOO_DEEP, span, limit=str(BLOCKS))
        self.open.append(Block(word, span, head, name, parameters))

    def end(self, end: Span) -> None:
        """Close the innermost block. It becomes an instruction of the one around it.

        A DEF or a task inside a block and blocks nested too deep are left out, because they are
        reported.
        """
        block = self.open.pop()
        span, body = Span(block.span.start, end.end), tuple(block.body)
        if block.word == "DEF":
            if block.name is not None and not self.open:
                parameters = tuple(block.parameters)
                self.program.append(Def(block.name.text, block.name.span, parameters, body, span))
        elif block.word in TASK_WORDS:
            if not self.open:
                self.program.append(Task(block.word == "WHEN", block.head, body, span))
        else:
            if self._depth <= BLOCKS:
                self.current_body.append(_node(block, span))
            self._depth -= 1


def _node(block: Block, span: Span) -> Instruction:
    if block.word == "IF":
        has_else = block.otherwise is not None
        if not has_else:
            block.next_arm(None, block.span)
        return If(tuple(block.arms), tuple(block.otherwise or ()), has_else, span)
    if block.word == "LOOP":
        count = block.head
        if count is not None and count.expression[0].op == "FOREVER":
            count = None
        return Loop(count, tuple(block.body), span)
    return While(block.head, tuple(block.body), span)
