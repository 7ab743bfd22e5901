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

HEADERS = frozenset(BLOCK_ENDS) - {"DEF", "TASK"}  # words with brackets: IF, LOOP, WHILE, WHEN
WORD_OF_END = {end: word for word, end in BLOCK_ENDS.items()}  # ENDIF: IF …
WORD_OF_END |= {alias: WORD_OF_END[end] for alias, end in ALIASES.items()}


class Block:
    """A block whose end has not come yet."""

    __slots__ = ("argument", "arms", "body", "else_body", "name", "parameters", "span", "word")

    def __init__(
        self,
        word: str,
        span: Span,
        argument: Argument | None,
        name: Token | None,
        parameters: Sequence[Parameter],
    ) -> None:
        self.word = word  # IF, LOOP, WHILE, DEF, TASK or WHEN
        self.span = span  # span of the header, where an endless block is reported
        self.argument = argument  # the condition or the count of the arm that is being read
        self.name = name  # name of the DEF
        self.parameters = parameters  # name of the DEF
        self.body: list[Instruction] = []
        self.arms: list[Arm] = []
        self.else_body: list[Instruction] | None = None  # the body after ELSE, once it has begun

    @property
    def header(self) -> Span:
        """The header of its first arm."""
        return self.arms[0].span if self.arms else self.span

    @property
    def current_body(self) -> list[Instruction]:
        """Return the body for the next instruction."""
        return self.body if self.else_body is None else self.else_body

    def next_arm(self, argument: Argument | None, span: Span) -> None:
        self.arms.append(Arm(self.argument, tuple(self.body), self.span))
        self.body, self.argument, self.span = [], argument, span


class Blocks:
    """A stack of its own instead of Python's: `open[-1]` is the innermost block."""

    def __init__(self, reporter: Reporter) -> None:
        self._reporter = reporter
        self.program: list[Instruction] = []
        self.open_blocks: list[Block] = []
        self.task_count = 0  # TASKs and WHENs that have begun at the top level
        self._depth = 0  # open blocks, not counting those allowed only at the top level

    @property
    def innermost_block(self) -> Block | None:
        return self.open_blocks[-1] if self.open_blocks else None

    @property
    def current_body(self) -> list[Instruction]:
        """Return the body for the next instruction."""
        return self.open_blocks[-1].current_body if self.open_blocks else self.program

    def begin(
        self,
        word: str,
        span: Span,
        argument: Argument | None = None,
        name: Token | None = None,
        parameters: Sequence[Parameter] = (),
    ) -> None:
        if word in TASK_WORDS and self.open_blocks:
            enclosing_word = self.open_blocks[-1].word
            self._reporter.report(codes.TASK_NOT_TOP, span, word=word, around=enclosing_word)
        elif word in TASK_WORDS:
            self.task_count += 1
            if self.task_count == TASKS + 1:
                self._reporter.report(codes.TOO_MANY_TASKS, span, limit=str(TASKS))
        elif word == "DEF":
            if self.open_blocks:
                self._reporter.report(codes.DEF_NOT_TOP, span)
        else:
            self._depth += 1
            if self._depth == BLOCKS + 1:
                self._reporter.report(codes.BLOCKS_TOO_DEEP, span, limit=str(BLOCKS))
        self.open_blocks.append(Block(word, span, argument, name, parameters))

    def end(self, end_span: Span) -> None:
        """Close the innermost block. It becomes an instruction of the one around it.

        A DEF or a task inside a block and blocks nested too deep are left out, because they are
        reported.
        """
        block = self.open_blocks.pop()
        span, body = Span(block.span.start, end_span.end), tuple(block.body)
        if block.word == "DEF":
            if block.name is not None and not self.open_blocks:
                parameters = tuple(block.parameters)
                self.program.append(Def(block.name.text, block.name.span, parameters, body, span))
        elif block.word in TASK_WORDS:
            if not self.open_blocks:
                self.program.append(Task(block.word == "WHEN", block.argument, body, span))
        else:
            if self._depth <= BLOCKS:
                self.current_body.append(_node(block, span))
            self._depth -= 1


def _node(block: Block, span: Span) -> Instruction:
    if block.word == "IF":
        has_else = block.else_body is not None
        if not has_else:
            block.next_arm(None, block.span)
        return If(tuple(block.arms), tuple(block.else_body or ()), has_else, span)
    if block.word == "LOOP":
        times = block.argument
        if times is not None and times.expression[0].op == "FOREVER":
            times = None
        return Loop(times, tuple(block.body), span)
    return While(block.argument, tuple(block.body), span)
