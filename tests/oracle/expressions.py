"""It reads the expressions of a program, and the parentheses after its words."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NoReturn

from tests.oracle.ast import Expression, Statement, Task, stack_need
from tests.oracle.kinds import Text
from tests.oracle.lexer import Token, thousandths, tokens_of
from tests.oracle.words import (
    COMPARATORS,
    FUNCTIONS,
    HIGHEST_VALUE,
    LOWEST_VALUE,
    MAX_STACK,
    Kit,
    Mistake,
)


class ExpressionParser:
    """Reads expressions, and checks everything that can be wrong with them."""

    def __init__(self, text: str, kit: Kit) -> None:
        self.tokens = tokens_of(text)
        self.at = 0
        self.sensors = {device.name: device for device in reversed(kit.readings)}
        self.actuators = {device.name: device for device in kit.actuators}
        self.variables: dict[str, bool] = {}
        self.defs: dict[str, list[Statement]] = {}
        self.text = Text(
            self.tokens, {reading.name for reading in kit.readings if reading.is_yes_no}
        )
        device_names = {device.name for device in (*kit.sensors, *kit.actuators)}
        for device in kit.readings:
            if device.name not in device_names and self.text.gives_way(device.name):
                del self.sensors[device.name]
                self.text.sensors.discard(device.name)
        self.open_def = ""  # the DEF that is being read
        self.own: dict[str, bool] = {}  # its values, and whether each is a yes-no value
        self.in_task = False  # a TASK or WHEN is being read
        self.tasks: list[Task] = []
        self.loops = 0  # loops open here, in this DEF or in the program
        self.blocks = 0
        self.has_unit = False  # the arguments that were read last
        self.speeds = {"CM": kit.speed, "DEG": kit.turn}

    # Tokens

    @property
    def token(self) -> Token:
        return self.tokens[self.at]

    def fail(self, message: str) -> NoReturn:
        raise Mistake(f"line {self.token.line}: {message}")

    def next_is(self, *texts: str) -> bool:
        """Return whether the next token is one of these words or signs."""
        return self.token.kind in ("word", "symbol") and self.token.text in texts

    def accept(self, *texts: str) -> str:
        """Consume and return the next token if it is one of these, otherwise return an empty
        string."""
        if not self.next_is(*texts):
            return ""
        self.at += 1
        return self.tokens[self.at - 1].text

    def expect(self, text: str) -> None:
        """Takes the next token, which must be this one."""
        if not self.accept(text):
            self.fail(f"{text} expected, not {self.token.text!r}")

    def accept_separator(self) -> bool:
        """Takes a ; or an end of line if one is next."""
        if self.token.kind != "newline" and not self.next_is(";"):
            return False
        self.at += 1
        return True

    def arguments(
        self, count: int, may_be_forever: bool = False, unit: str = ""
    ) -> tuple[Expression | None, ...]:
        """Exactly this many in parentheses; the first may be FOREVER (None) or have a unit."""
        has_unit = False
        self.expect("(")
        expressions: list[Expression | None] = []
        for number in range(count):
            if number > 0:
                self.expect(",")
            if number == 0 and may_be_forever and self.accept("FOREVER"):
                expressions.append(None)
            else:
                expressions.append(self.expression())
                if number == 0 and unit and self.accept(unit):
                    has_unit = True
        self.expect(")")
        self.has_unit = has_unit
        return tuple(expressions)

    def condition(self) -> Expression:
        """A yes/no value in parentheses."""
        (condition,) = self.arguments(1)
        assert condition is not None
        self.require_yes_no(condition)
        self.require_stack((condition,))
        return condition

    def require_number(self, expression: Expression | None) -> None:
        if expression is not None and expression.is_yes_no:
            self.fail("a number is needed, not a yes/no value")

    def require_yes_no(self, expression: Expression | None) -> None:
        if expression is not None and not expression.is_yes_no:
            self.fail("a yes/no value is needed, not a number")

    def require_range(self, expression: Expression | None, low: int, high: int) -> None:
        """Refuses a lone number out of range; any other expression is limited when it runs."""
        if expression is not None and expression.is_literal and not low <= expression.value <= high:
            self.fail("the number is out of range")

    def require_stack(self, arguments: tuple[Expression | None, ...]) -> None:
        """Refuse an expression that needs more stack than there is."""
        for index, argument in enumerate(arguments):
            if index + (1 if argument is None else stack_need(argument)) > MAX_STACK:
                self.fail("the expression is too long")

    # Expressions, from loosest to tightest

    def expression(self) -> Expression:
        return self.logic("OR", lambda: self.logic("AND", self.negation))

    def logic(self, operator: str, tighter: Callable[[], Expression]) -> Expression:
        """A chain of ANDs or of ORs."""
        left = tighter()
        while self.accept(operator):
            self.require_yes_no(left)
            right = tighter()
            self.require_yes_no(right)
            left = Expression(operator, True, (left, right))
        return left

    def negation(self) -> Expression:
        """NOT is looser than the comparators: NOT X = 5 is NOT (X = 5)."""
        if self.accept("NOT"):
            value = self.negation()
            self.require_yes_no(value)
            return Expression("NOT", True, (value,))
        return self.comparison()

    def comparison(self) -> Expression:
        """Two numbers, or two yes/no values for = and <>; comparators do not chain."""
        left = self.sum()
        operator = self.accept(*COMPARATORS)
        if not operator:
            return left
        right = self.sum()
        if left.is_yes_no != right.is_yes_no:
            self.fail("a number is compared with a yes/no value")
        if left.is_yes_no and operator not in ("=", "<>"):
            self.fail("yes/no values have no order")
        if self.next_is(*COMPARATORS):
            self.fail("comparators do not chain")
        return Expression(operator, True, (left, right))

    def sum(self) -> Expression:
        return self.arithmetic(("+", "-"), self.product)

    def product(self) -> Expression:
        return self.arithmetic(("*", "/", "%"), self.factor)

    def arithmetic(
        self, operators: tuple[str, ...], tighter: Callable[[], Expression]
    ) -> Expression:
        """A chain of operators of the same strength, from left to right."""
        left = tighter()
        while operator := self.accept(*operators):
            self.require_number(left)
            right = tighter()
            self.require_number(right)
            left = Expression(operator, False, (left, right))
        return left

    def factor(self) -> Expression:
        """A leaf, perhaps after minuses; a minus right before a number belongs to the number."""
        if self.accept("-"):
            if self.token.kind == "number":
                return self.number(-1)
            value = self.factor()
            self.require_number(value)
            return Expression("MINUS", False, (value,))
        if self.token.kind == "number":
            return self.number(1)
        return self.leaf()

    def number(self, sign: int) -> Expression:
        value = sign * thousandths(self.token.text)
        if not LOWEST_VALUE <= value <= HIGHEST_VALUE:
            self.fail("the number is out of range")
        self.at += 1
        return Expression("NUMBER", False, value=value, is_literal=True)

    def leaf(self) -> Expression:
        """Parentheses, a function, TRUE, FALSE, TIME, a sensor or a variable."""
        if self.accept("("):
            inner = self.expression()
            self.expect(")")
            return replace(inner, is_literal=False)
        if self.token.kind != "word":
            self.fail(f"a value is expected, not {self.token.text!r}")
        word = self.token.text
        self.at += 1
        if word in FUNCTIONS:
            arguments = self.arguments(FUNCTIONS[word])
            for argument in arguments:
                self.require_number(argument)
            return Expression(word, False, tuple(a for a in arguments if a is not None))
        if word in ("TRUE", "FALSE"):
            return Expression("TRUTH", True, value=word == "TRUE")
        if word == "TIME":
            return Expression("TIME", False)
        if word in self.sensors:
            return Expression("SENSOR", self.sensors[word].is_yes_no, name=word)
        if word in self.own:
            return Expression("OWN", self.own[word], name=f"{self.open_def}.{word}")
        if word in self.variables:
            return Expression("VARIABLE", self.variables[word], name=word)
        self.fail(f"{word} has no value here")
