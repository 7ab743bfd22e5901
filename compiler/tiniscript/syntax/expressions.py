"""The grammar of expressions and arguments: operator-precedence parsing over the cursor.

Knows which operand belongs to which operator. Gives parts in postfix order, and has a stack of its
own (`operators`), so that no depth of brackets exhausts Python's. Knows no instructions.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from tiniscript.diagnostics import codes
from tiniscript.fixed_point import HIGHEST, LOWEST, read_literal
from tiniscript.kit import Kit
from tiniscript.source import Span
from tiniscript.syntax.ast import Argument, Part
from tiniscript.syntax.cursor import AFTER_VALUE, Cursor
from tiniscript.syntax.lexer import NEWLINE, NUMBER, ODD, WORD, Token
from tiniscript.syntax.operators import AND, BINARY, COMPARISON, MINUS, NOT, OPEN, Operator, Postfix
from tiniscript.syntax.reporter import Reporter
from tiniscript.words import WORDS, Word

if TYPE_CHECKING:
    from tiniscript.syntax.expression_recovery import ExpressionRecovery

_BESIDE = frozenset((WORD, NUMBER, ODD))
_OPERANDS = frozenset(("-", "("))  # what begins one


class ExpressionParser:
    def __init__(self, cursor: Cursor, reporter: Reporter, kit: Kit | None) -> None:
        self.cursor = cursor
        self.reporter = reporter
        self._kit = kit

    @cached_property
    def recovery(self) -> ExpressionRecovery:
        """The recovery of wrong expressions. A correct program never loads it."""
        from tiniscript.syntax.expression_recovery import ExpressionRecovery

        return ExpressionRecovery(self.cursor, self.reporter, self._kit)

    # -- arguments --------------------------------------------------------------------------

    def arguments(self) -> tuple[Argument, ...]:
        cursor = self.cursor
        bracket = cursor.i
        cursor.i += 1
        if cursor.take_inner(")"):
            return ()
        arguments = [self.argument()]
        while cursor.take_inner(","):
            arguments.append(self.argument())
        if not cursor.take_inner(")"):
            self.recovery.no_close(bracket)
        return tuple(arguments)

    def argument(self) -> Argument:
        cursor = self.cursor
        cursor.to_inner()
        token = cursor.tokens[cursor.i]
        if token.kind is WORD and token.text == "FOREVER":
            cursor.i += 1
            part = Part("FOREVER", 0, token.start, token.end)
            return Argument((part,), token.span, False)
        return self.expression(in_brackets=True)

    # -- expressions, by precedence ---------------------------------------------------------

    def expression(self, in_brackets: bool) -> Argument:
        cursor = self.cursor
        first = cursor.i
        read = Postfix(brackets=1 if in_brackets else 0)
        while not self.operand(read) or self.operator(read):
            pass
        parts = tuple(read.parts)
        span = cursor.span_from(cursor.tokens[first])
        is_plain = len(parts) == 1 and parts[0] == ("NUMBER", parts[0].value, *span)
        return Argument(parts, span, is_plain)

    def operand(self, read: Postfix) -> bool:
        """Read an operand or what stands before one; return whether the operand is complete."""
        cursor = self.cursor
        token = cursor.tokens[cursor.i]
        if token.kind is NEWLINE and read.brackets:
            cursor.to_inner()
            token = cursor.token
        kind = token.kind
        if kind is NUMBER:
            read.parts.append(self.number(token, read))
            return True
        if kind is WORD:
            return self.word(token, read)
        if kind == "-":
            read.wait(MINUS, "NEG", token, cursor.i)
        elif kind == "(":
            read.wait(OPEN, "(", token, cursor.i)
            read.brackets += 1
        else:
            self.recovery.no_value(token)
        cursor.i += 1
        return False

    def number(self, token: Token, read: Postfix) -> Part:
        """A minus right before a number belongs to it."""
        cursor, waiting = self.cursor, read.waiting
        first = token
        if waiting and waiting[-1].precedence == MINUS:
            if waiting[-1].index == cursor.before(cursor.i):
                first = waiting.pop().token
        cursor.i += 1
        value, is_exact = read_literal(token.text)
        value = value if first is token else -value
        if not (is_exact and LOWEST <= value <= HIGHEST):
            value = self.recovery.literal(token, Span(first.start, token.end), value)
        return Part("NUMBER", value, first.start, token.end)

    def word(self, token: Token, read: Postfix) -> bool:
        cursor = self.cursor
        known = WORDS.get(token.text)
        if (
            known is None
            and self._may_be_more()
            and (
                self.recovery.constructs.is_said_with_more(token)
                or self.recovery.questions.is_sign_alone(token)
                or self.recovery.questions.is_in_words(token)
            )
        ):
            return False
        if known is None or known.role == "value":
            cursor.i += 1
            if cursor.tokens[cursor.i].kind == "(":
                self.recovery.called(token)
            if known is None:
                read.parts.append(Part("NAME", token.text, token.start, token.end))
            else:
                read.parts.append(Part(token.text, 0, token.start, token.end))
            return True
        if token.text == "NOT":
            if read.waiting and read.waiting[-1].precedence > NOT:
                self.reporter.fail(codes.NOT_NEEDS_BRACKETS, token.span)
            read.wait(NOT, "NOT", token, cursor.i)
            cursor.i += 1
        elif known.role == "function":
            self.begin_call(token, known, read)
        else:
            self.recovery.no_value(token)
        return False

    def _may_be_more(self) -> bool:
        """Whether what stands beside a name lets it mean more than itself: `DISTANCE cm`."""
        cursor = self.cursor
        after = cursor.following
        if after.kind in _BESIDE:
            return after.kind is ODD or after.text not in BINARY
        return after.kind in _OPERANDS and cursor.last.text in ("AND", "OR")

    def begin_call(self, name: Token, function: Word, read: Postfix) -> None:
        cursor = self.cursor
        cursor.i += 1
        if read.brackets:
            cursor.to_inner()
        if cursor.token.kind != "(":
            self.recovery.no_bracket(name, function)
        read.wait(OPEN, name.text, name, cursor.i)
        read.brackets += 1
        cursor.i += 1
        if cursor.take_inner(")"):
            self.recovery.wrong_count(function, [], cursor.span_from(name))

    def operator(self, read: Postfix) -> bool:
        """Read what may follow an operand; return whether another operand is wanted then."""
        cursor = self.cursor
        tokens = cursor.tokens
        while True:
            token = cursor.inner() if read.brackets else tokens[cursor.i]
            if token.kind not in AFTER_VALUE:
                binary = BINARY.get(token.text) if token.kind is not ODD else None
                if binary is not None:
                    if read.brackets:
                        cursor.to_inner()
                    self.binary(token, *binary, read)
                    cursor.i += 1
                    return True
                if self.recovery.is_repaired(token, read):
                    if cursor.token.text == "NOT":  # the operand was none
                        return True
                    continue
            bracket = read.reduce() if read.waiting else None
            if bracket is None:
                return False
            if token.kind == ")":
                cursor.take_inner(")")
                read.brackets -= 1
                read.waiting.pop()
                if bracket.name != "(":
                    self.end_call(bracket, read)
                continue
            if token.kind == "," and bracket.name != "(":
                bracket.end_argument(cursor.source, tokens[bracket.index], cursor.last)
                cursor.take_inner(",")
                return True
            self.recovery.no_close(bracket.index)

    def binary(self, token: Token, precedence: int, name: str, read: Postfix) -> None:
        waiting = read.waiting
        while waiting and waiting[-1].precedence >= precedence:
            if precedence == COMPARISON == waiting[-1].precedence:
                self.recovery.chained(waiting[-1], token)
            read.apply()
        if precedence <= AND:  # AND and OR: the left side may decide
            read.parts.append(Part(name + "_LEFT", 0, token.start, token.end))
        read.wait(precedence, name, token, self.cursor.i)

    def end_call(self, call: Operator, read: Postfix) -> None:
        cursor = self.cursor
        tokens = cursor.tokens
        call.end_argument(cursor.source, tokens[call.index], tokens[cursor.i - 2])
        span = cursor.span_from(call.token)
        if len(call.arguments) != len(WORDS[call.name].arguments):
            self.recovery.wrong_count(WORDS[call.name], call.arguments, span)
        read.parts.append(Part(call.name, 0, *span))
