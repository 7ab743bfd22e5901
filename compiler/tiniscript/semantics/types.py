"""The types of expressions: the half of the checker that looks into them.

Knows which types operators take and give, how deep the stack gets, and what names in
expressions mean. Gives terms, and the sensors whose readings they use.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

from tiniscript.base.source import Span
from tiniscript.diagnostics import codes
from tiniscript.semantics.ir import Expression, Term
from tiniscript.semantics.symbols import ANY, NUMBER, YES_NO, Operand, Scope
from tiniscript.syntax.ast import Argument, Part

if TYPE_CHECKING:
    from tiniscript.semantics.wrong_values import WrongValues


class Value(NamedTuple):
    """A checked expression. `depth` counts values on the stack."""

    terms: Expression
    type: str
    depth: int
    sensors: tuple[int, ...]  # in order of appearance; a sensor may appear several times


_ARITHMETIC_OPS = frozenset(("ADD", "SUB", "MUL", "DIV", "MOD", "MIN", "MAX", "RANDOM", "ROUND"))
_ORDER_COMPARATORS = frozenset(("LT", "LE", "GT", "GE"))
_UNARY = frozenset(("NEG", "ABS"))
_LEAF_TERMS = {"TRUE": Term("YES_NO", 1), "FALSE": Term("YES_NO", 0), "TIME": Term("TIME")}


class Types:
    def __init__(self, scope: Scope) -> None:
        self.scope = scope
        self.readings = scope.kit.readings
        self.variable_types: list[str] = []
        self.no_value = Value((Term("YES_NO", 0),), ANY, 1, ())

    @cached_property
    def wrong_values(self) -> WrongValues:
        """Return the checker of wrong values. A correct program never loads it."""
        from tiniscript.semantics.wrong_values import WrongValues

        return WrongValues(self.scope)

    def value(self, argument: Argument, target: str | None = None) -> Value:
        """Return the checked value of an expression. `target` is the new variable it is assigned
        to.
        """
        terms: list[Term] = []
        stack: list[Operand] = []
        sensors: list[int] = []
        for part in argument.expression:
            op = part.op
            if op == "NUMBER":
                assert isinstance(part.value, int)
                terms.append(Term(op, part.value))
                stack.append(Operand(NUMBER, 1, part.start, part.end))
            elif op == "NAME":
                terms.append(self._name(part, target, stack, sensors))
            elif op in _LEAF_TERMS:
                terms.append(_LEAF_TERMS[op])
                leaf_type = NUMBER if op == "TIME" else YES_NO
                stack.append(Operand(leaf_type, 1, part.start, part.end))
            elif op == "FOREVER":
                self.scope.report(codes.FOREVER_NOT_HERE, Span(part.start, part.end))
                return self.no_value
            else:
                terms.append(Term(op))
                if not op.endswith("_LEFT"):
                    self._apply(part, stack)
        operand = stack[-1]
        return Value(tuple(terms), operand.type, operand.depth, tuple(sensors))

    def _name(
        self, part: Part, target: str | None, stack: list[Operand], sensors: list[int]
    ) -> Term:
        scope = self.scope
        assert isinstance(part.value, str)
        value_type, term = ANY, Term("NUMBER", 0)
        name = scope.names.get(part.value)
        if name is None:
            self.wrong_values.report_unknown(part, part.value, target)
        elif name.kind == "variable":
            value_type, term = self.variable_types[name.number], Term("VARIABLE", name.number)
        elif name.kind == "sensor":
            sensors.append(name.number)
            value_type = YES_NO if self.readings[name.number].is_yes_no else NUMBER
            term = Term("SENSOR", name.number)
        else:
            values = {"device": part.value} if name.kind == "actuator" else {}
            span = Span(part.start, part.end)
            scope.report(codes.NO_VALUE, span, None, word=part.value, **values)
        stack.append(Operand(value_type, 1, part.start, part.end))
        return term

    def _apply(self, part: Part, stack: list[Operand]) -> None:
        """Take the operands of an operator from `stack` and put its result there."""
        op = part.op
        right = stack.pop()
        if op == "NOT":
            self._require_yes_no("NOT", right)
            stack.append(Operand(YES_NO, right.depth, part.start, right.end))
            return
        if op in _UNARY:
            self._require_number(op, right)
            end = max(right.end, part.end)
            stack.append(Operand(NUMBER, right.depth, part.start, end))
            return
        left = stack.pop()
        depth = max(left.depth, right.depth + 1)
        start, end = min(left.start, part.start), max(right.end, part.end)
        result_type = YES_NO
        if op in _ARITHMETIC_OPS:
            self._require_number(op, left)
            self._require_number(op, right)
            result_type = NUMBER
        elif op in ("AND", "OR"):
            self._require_yes_no(op, left, right)
            self._require_yes_no(op, right, left)
        elif left.type != right.type:
            if ANY not in (left.type, right.type):
                self.wrong_values.report_mixed(op, left, right, Span(start, end))
        elif left.type == YES_NO and op in _ORDER_COMPARATORS:
            self.wrong_values.report_yes_no_order(op, Span(start, end))
        stack.append(Operand(result_type, depth, start, end))

    def _require_number(self, op: str, operand: Operand) -> None:
        if operand.type == YES_NO:
            self.wrong_values.report_not_number(op, operand)

    def _require_yes_no(self, asker: str, operand: Operand, other: Operand | None = None) -> None:
        """`other` is the other side of an AND or OR."""
        if operand.type == NUMBER:
            self.wrong_values.report_not_yes_no(asker, operand, other)
