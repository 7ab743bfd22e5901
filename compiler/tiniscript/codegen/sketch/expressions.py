"""Expressions in C++: the terms of the checked program with C++'s own operators and brackets.

`exact` sketches calculate with the struct Number; in the others every number is a literal or a
reading, and C++'s own numbers do. C++ may calculate the right side of an operator first: where
both sides have a RANDOM, the left one is kept in a variable before.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from typing import NamedTuple

from tiniscript.base.fixed_point import ONE, as_text
from tiniscript.semantics.ir import Expression
from tiniscript.syntax.operators import SIGN_OF

_PRECEDENCE = {
    "MUL": 9, "DIV": 9, "MOD": 9, "ADD": 8, "SUB": 8,
    "LT": 7, "LE": 7, "GT": 7, "GE": 7, "EQ": 6, "NE": 6, "AND": 5, "OR": 4,
}  # fmt: skip
SIGNS = {**SIGN_OF, "EQ": "==", "NE": "!=", "AND": "&&", "OR": "||"}  # operators of C++
ARITHMETIC_OPS = frozenset(("MUL", "DIV", "MOD", "ADD", "SUB"))
COMPARISON_OPS = frozenset(("LT", "LE", "GT", "GE", "EQ", "NE"))
FUNCTIONS = {"MIN": "smaller", "MAX": "larger", "ROUND": "rounded", "RANDOM": "random"}
_UNARY, _PRIMARY = 10, 11


class _Operand(NamedTuple):
    text: str
    precedence: int  # precedence in C++
    is_literal: bool = False  # a number that C++ itself would calculate with
    is_random: bool = False


class Expressions:
    """Writes expressions. `use` receives each helper that they need and returns its name."""

    def __init__(
        self,
        use_function: Callable[[str], str],
        is_exact: bool,
        variables: Sequence[str],
        sensors: Sequence[str],
    ) -> None:
        self.use = use_function
        self.is_exact = is_exact
        self.variables = variables
        self.sensors = sensors
        self.kept_count = 0  # left sides that need a variable

    def code_of(self, expression: Expression, reading: tuple[int, str] | None = None) -> str:
        """Return an expression; `reading` is a sensor, and the text that replaces its name."""
        stack: list[_Operand] = []
        for op, value in expression:
            if op == "NUMBER":
                stack.append(self._number(value))
            elif op == "YES_NO":
                stack.append(_Operand("true" if value else "false", _PRIMARY))
            elif op == "VARIABLE":
                stack.append(_Operand(self.variables[value], _PRIMARY))
            elif op == "SENSOR":
                is_own_reading = reading is not None and reading[0] == value
                name = reading[1] if reading is not None and is_own_reading else self.sensors[value]
                stack.append(_Operand(name, _PRIMARY))
            elif op == "TIME":
                stack.append(_Operand(f"{self.use('time')}()", _PRIMARY))
            elif op in ("NEG", "ABS", "NOT"):
                stack.append(self._unary(op, stack.pop()))
            elif not op.endswith("_LEFT"):
                right, left = stack.pop(), stack.pop()
                stack.append(self._binary(op, left, right))
        return stack[-1].text

    def new_variable(self) -> str:
        """Return a variable for a left side."""
        self.kept_count += 1
        return f"first{self.kept_count}"

    def _number(self, value: int) -> _Operand:
        if not is_float(value):
            return _Operand(f"{self.use('exactly')}({_long(value)})", _PRIMARY)
        return _Operand(as_text(value), _PRIMARY if value >= 0 else _UNARY, is_literal=True)

    def _unary(self, op: str, operand: _Operand) -> _Operand:
        if op == "NOT":
            return operand._replace(text="!" + _bracket(operand, _UNARY), precedence=_UNARY)
        number = self._as_number(operand)
        if op == "ABS":
            return number._replace(
                text=f"{self.use('absolute')}({number.text})", precedence=_PRIMARY
            )
        self.use("NEG")
        gap = " " if number.text.startswith("-") else ""
        return number._replace(text=f"-{gap}{_bracket(number, _UNARY)}", precedence=_UNARY)

    def _binary(self, op: str, left: _Operand, right: _Operand) -> _Operand:
        is_random = left.is_random or right.is_random or op == "RANDOM"
        kept_name = assignment = ""
        if left.is_random and right.is_random and op not in ("AND", "OR"):
            kept_name = self.new_variable()
            assignment, left = f"{kept_name} = {left.text}, ", _Operand(kept_name, _PRIMARY)
        if op in FUNCTIONS:
            operand = _Operand(f"{self.use(FUNCTIONS[op])}({left.text}, {right.text})", _PRIMARY)
            if kept_name:
                operand = _Operand(f"({assignment}{operand.text})", _PRIMARY)
            return operand._replace(is_random=is_random)
        sign, precedence = SIGNS[op], _PRECEDENCE[op]
        if op in ARITHMETIC_OPS or op in COMPARISON_OPS:
            if left.is_literal and (
                right.is_literal or (op in ARITHMETIC_OPS and not self.is_exact)
            ):
                left = self._as_number(left)
            if op in ARITHMETIC_OPS or self.is_exact:
                self.use(op)
        # Brackets that C++ does not need, but without which it warns.
        left_precedence, right_precedence = (
            (8, 8) if op in COMPARISON_OPS else (precedence, precedence + 1)
        )
        if op == "OR":
            left_precedence, right_precedence = (
                (6 if left.precedence == _PRECEDENCE["AND"] else precedence),
                6,
            )
        text = f"{_bracket(left, left_precedence)} {sign} {_bracket(right, right_precedence)}"
        if kept_name:
            return _Operand(f"({assignment}{text})", _PRIMARY, is_random=True)
        return _Operand(text, precedence, is_random=is_random)

    def _as_number(self, operand: _Operand) -> _Operand:
        """Return an operand that C++ does not calculate with its own whole numbers."""
        if not operand.is_literal or not self.is_exact:
            return operand
        return _Operand(f"{self.use('Number')}({operand.text})", _PRIMARY)


def _bracket(operand: _Operand, precedence: int) -> str:
    """Return an operand, in brackets if it binds less tightly than the operator next to it."""
    return operand.text if operand.precedence >= precedence else f"({operand.text})"


def is_float(value: int) -> bool:
    """Return whether a literal is exactly this number of thousandths in a 24-bit float of C++."""
    if value % ONE == 0:
        return True
    nearest_float: float = struct.unpack("f", struct.pack("f", abs(value) / ONE))[0]
    product: float = struct.unpack("f", struct.pack("f", nearest_float * ONE))[0]
    return int(struct.unpack("f", struct.pack("f", product + 0.5))[0]) == abs(value)


def _long(value: int) -> str:
    return f"{value}L" if value > -(2**31) else f"{value + 1}L - 1"


def is_literal(expression: Expression) -> bool:
    """Return whether an expression is a single number or yes-no literal."""
    return len(expression) == 1 and expression[0].op in ("NUMBER", "YES_NO")


def has_random(expression: Expression) -> bool:
    return any(term.op == "RANDOM" for term in expression)


def reads_once(expression: Expression, sensor: int) -> bool:
    """Return whether an expression uses a sensor exactly once, outside of parts that AND or OR may
    skip.
    """
    if any(term.op in ("AND_LEFT", "OR_LEFT") for term in expression):
        return False
    return sum(term == ("SENSOR", sensor) for term in expression) == 1
