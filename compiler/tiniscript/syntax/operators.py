"""Operators, how tightly they bind, and an expression while it is read.

Knows the order of a stack machine: what an operator is applied to stands before it. Reads no
tokens itself.
"""

from __future__ import annotations

from typing import Final

from tiniscript.base.words import COMPARATORS
from tiniscript.syntax.ast import Part
from tiniscript.syntax.lexer import Token

# From lowest to highest precedence. An open bracket holds back all that waits before it.
OPEN, OR, AND, NOT, COMPARISON, SUM, PRODUCT, MINUS = range(8)

BINARY: Final = {
    "OR": (OR, "OR"), "AND": (AND, "AND"),
    **{sign: (COMPARISON, name) for name, sign in COMPARATORS},
    "+": (SUM, "ADD"), "-": (SUM, "SUB"),
    "*": (PRODUCT, "MUL"), "/": (PRODUCT, "DIV"), "%": (PRODUCT, "MOD"),
}  # fmt: skip
COMPARISONS = frozenset(sign for _, sign in COMPARATORS)
SIGNS = frozenset(sign for sign in BINARY if not sign.isalpha())
ARITHMETIC_SIGNS = SIGNS - COMPARISONS  # + - * / %
SIGN_OF: Final = {name: sign for sign, (_, name) in BINARY.items()}
# The comparison that is TRUE when another is not.
OPPOSITES: Final = {
    SIGN_OF[one]: SIGN_OF[other]
    for pair in (("LT", "GE"), ("GT", "LE"), ("EQ", "NE"))
    for one, other in (pair, pair[::-1])
}


class Operator:
    """An operator, an open bracket or an open function call that waits for what follows."""

    __slots__ = ("ended_arguments", "index", "name", "precedence", "token")

    def __init__(self, precedence: int, name: str, token: Token, index: int) -> None:
        self.precedence = precedence
        self.name = name
        self.token = token
        self.index = index  # index of its token; for a call, of its bracket
        self.ended_arguments = 0  # completed arguments of the call


class Postfix:
    """`parts` in postfix order, the operators that wait, and how many brackets are open."""

    __slots__ = ("open_bracket_count", "parts", "pending_operators")

    def __init__(self, bracket_count: int) -> None:
        self.parts: list[Part] = []
        self.pending_operators: list[Operator] = []
        self.open_bracket_count = bracket_count

    def wait(self, precedence: int, name: str, token: Token, index: int) -> None:
        self.pending_operators.append(Operator(precedence, name, token, index))

    def apply(self) -> None:
        """The operator that has waited last has all that it is applied to."""
        operator = self.pending_operators.pop()
        token = operator.token
        self.parts.append(Part(operator.name, 0, token.start, token.end))

    def reduce(self) -> Operator | None:
        """Apply what waits since the innermost open bracket, and return that bracket."""
        operators = self.pending_operators
        while operators and operators[-1].precedence != OPEN:
            self.apply()
        return operators[-1] if operators else None
