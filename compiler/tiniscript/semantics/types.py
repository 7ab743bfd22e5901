"""The types of expressions: the half of the checker that looks into them.

Knows which types operators take and give, how deep the stack gets, and what names in
expressions mean. Gives terms, and the sensors whose readings they use.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from tiniscript.diagnostics import codes
from tiniscript.semantics.comparisons import ASIDE
from tiniscript.semantics.ir import Expression, Term
from tiniscript.semantics.named_values import value_of
from tiniscript.semantics.symbols import ENOUGH, Scope
from tiniscript.semantics.unknown_words import hyphened, meant_value, whole_name
from tiniscript.source import Span
from tiniscript.syntax.ast import Argument, Part
from tiniscript.syntax.operators import SIGN_OF
from tiniscript.words import NUMBER_WORDS, SENSOR_STEMS, WORDS, meant_by

NUMBER, YES_NO, ANY = "number", "yes_no", "any"  # ANY: a mistake was already reported there


class Value(NamedTuple):
    """A checked expression. `depth` counts values on the stack."""

    terms: Expression
    kind: str
    depth: int
    sensors: tuple[int, ...]  # in order of appearance, perhaps several times


class _Operand(NamedTuple):
    kind: str
    depth: int
    start: int
    end: int


_ARITHMETIC = frozenset(("ADD", "SUB", "MUL", "DIV", "MOD", "MIN", "MAX", "RANDOM", "ROUND"))
_ORDER = frozenset(("LT", "LE", "GT", "GE"))
_EQUAL = frozenset(("EQ", "NE"))
_COMPARES = re.compile(r"\w+\s*((?:<=|>=|<>|[<>=])\s*[\w.]+)")  # `> 5` of `X > 5`
_COMPARED = re.compile(r"[^<>=]{1,40}?\s*(?:<=|>=|<>|[<>=])(?=[^<>=]*$)")  # `X =` of `X = 5`
_UNARY = {"NEG": "-", "ABS": "ABS"}
_TIME, _POWER, _TIMES, _HERTZ = "2", "50", "3", "440"  # examples of what a variable may hold
_POWER_BEFORE = re.compile(r"(?i)\b[FBLR][ \t]*\([^(),]*,[ \t]*$")
_NEAR = 20  # characters before a name in which its word is looked for
# Where a sensor does not look that looks ahead.
_TIMES_BEFORE = re.compile(r"(?i)\bLOOP[ \t]*\([ \t]*$")
_HERTZ_BEFORE = re.compile(r"(?i)\bBEEP[ \t]*\([^(),]*,[ \t]*$")
_TIME_BEFORE = re.compile(r"(?i)\b(?:[FBLRW]|BEEP)[ \t]*\([ \t]*$")  # a time comes first
_LEAVES = {"TRUE": Term("YES_NO", 1), "FALSE": Term("YES_NO", 0), "TIME": Term("TIME")}


class Kinds:
    def __init__(self, scope: Scope) -> None:
        self.scope = scope
        self.kit = scope.kit
        self.of_variables: list[str] = []
        self.nothing = Value((Term("YES_NO", 0),), ANY, 1, ())

    def value(self, argument: Argument, target: str | None = None) -> Value:
        """Return what an expression means. `target` is the new variable that it is put into."""
        terms: list[Term] = []
        stack: list[_Operand] = []
        sensors: list[int] = []
        for part in argument.expression:
            op = part.op
            if op == "NUMBER":
                assert isinstance(part.value, int)
                terms.append(Term(op, part.value))
                stack.append(_Operand(NUMBER, 1, part.start, part.end))
            elif op == "NAME":
                terms.append(self._name(part, target, stack, sensors))
            elif op in _LEAVES:
                terms.append(_LEAVES[op])
                kind = NUMBER if op == "TIME" else YES_NO
                stack.append(_Operand(kind, 1, part.start, part.end))
            elif op == "FOREVER":
                self.scope.report(codes.FOREVER_NOT_HERE, Span(part.start, part.end))
                return self.nothing
            else:
                terms.append(Term(op))
                if not op.endswith("_LEFT"):
                    self._apply(part, stack)
        result = stack[-1]
        return Value(tuple(terms), result.kind, result.depth, tuple(sensors))

    def _name(
        self, part: Part, target: str | None, stack: list[_Operand], sensors: list[int]
    ) -> Term:
        scope = self.scope
        assert isinstance(part.value, str)
        kind, term = ANY, Term("NUMBER", 0)
        name = scope.names.get(part.value)
        if name is None:
            self._unknown(part, part.value, target)
        elif name.what == "variable":
            kind, term = self.of_variables[name.number], Term("VARIABLE", name.number)
        elif name.what == "sensor":
            sensors.append(name.number)
            kind = YES_NO if self.kit.sensors[name.number].is_yes_no else NUMBER
            term = Term("SENSOR", name.number)
        else:
            code = codes.DEF_READ if name.what == "def" else codes.ACTUATOR_READ
            scope.report(code, Span(part.start, part.end), name=part.value)
        stack.append(_Operand(kind, 1, part.start, part.end))
        return term

    def _unknown(self, part: Part, name: str, target: str | None) -> None:
        scope, span = self.scope, Span(part.start, part.end)
        if name in scope.def_names:
            scope.report(codes.DEF_READ, span, name=name)
            return
        meant = meant_by(name) or ""
        before = scope.source.text[max(0, span.start - _NEAR) : span.start]
        is_variable = meant == "TIME" and _TIME_BEFORE.search(before) is not None
        if not is_variable and name not in scope.set_somewhere and name != target and (
            (meant in WORDS and WORDS[meant].role in ("value", "forever")) or meant in scope.names
        ):  # fmt: skip
            scope.report(
                codes.OTHER_LANGUAGE, span, found=name, right=meant, fix=meant, usage=meant
            )
            return
        if meant == "BUTTON" or name == "BUTTON":
            scope.report(codes.NO_BUTTON, span)
            return
        if hyphened(scope, span, name):
            return
        names = scope.names.items() if len(scope.diagnostics) < ENOUGH else ()
        known = [each for each, its in names if its.what in ("sensor", "variable")]
        near = NUMBER_WORDS.get(name) or scope.near(name, known) or meant_value(
            scope, span, name, is_assigned=target is not None
        )  # fmt: skip
        near = near or whole_name(scope, name, scope.set_somewhere)
        stem = SENSOR_STEMS.get(name, name) + "_"  # `LIGHT` of LIGHT_R and LIGHT_L
        several = [each for each in known if each.startswith(stem)]
        which = {} if len(several) != 2 else {"first": several[0], "second": several[1]}
        sensors = [each for each, its in names if its.what == "sensor"]
        if name in ("SENSOR", "SENSORES", "SENSORS") and len(sensors) > 1:
            which = {"first": ", ".join(sensors[:-1]), "second": sensors[-1]}
        if name == target or name in scope.set_somewhere:
            first = scope.line_to_move_up(name, span)
            if any(each.code is codes.USED_BEFORE_SET and each.values["name"] == name
                   for each in scope.diagnostics[-ENOUGH:]):  # fmt: skip
                return  # said once
            scope.report(codes.USED_BEFORE_SET, span, None, name=name, near=near, **first)
        else:
            near = "" if which else near
            near = "" if is_variable else near
            value = value_of(name)
            if _TIME_BEFORE.search(before):
                value = _TIME
            elif _POWER_BEFORE.search(before):
                value = _POWER
            elif _TIMES_BEFORE.search(before):
                value = _TIMES
            elif _HERTZ_BEFORE.search(before):
                value = _HERTZ
            only = next((each for each in sensors if name.startswith(each + "_")), "")
            aside = only if name.rpartition("_")[2] in ASIDE else ""
            near = "" if aside else only or near
            scope.report(codes.UNKNOWN_NAME, span, None, found=name, near=near,
                         value=value, only=only, aside=aside, **which)  # fmt: skip

    def _apply(self, part: Part, stack: list[_Operand]) -> None:
        """Take the operands of an operator from `stack` and put its result there."""
        op = part.op
        right = stack.pop()
        if op == "NOT":
            self._wants_yes_no("NOT", right)
            stack.append(_Operand(YES_NO, right.depth, part.start, right.end))
            return
        if op in _UNARY:
            self._wants_number(_UNARY[op], right)
            end = max(right.end, part.end)
            stack.append(_Operand(NUMBER, right.depth, part.start, end))
            return
        left = stack.pop()
        depth = max(left.depth, right.depth + 1)
        start, end = min(left.start, part.start), max(right.end, part.end)
        kind = YES_NO
        if op in _ARITHMETIC:
            self._wants_number(SIGN_OF.get(op, op), left)
            self._wants_number(SIGN_OF.get(op, op), right)
            kind = NUMBER
        elif op in ("AND", "OR"):
            self._wants_yes_no(op, left, right)
            self._wants_yes_no(op, right, left)
        elif left.kind != right.kind:
            if ANY not in (left.kind, right.kind):
                self.scope.report(codes.MIXED_COMPARE, Span(start, end), sign=SIGN_OF[op],
                                    left="@" + left.kind, right="@" + right.kind,
                                    fix=self._yes_no_alone(op, left, right))  # fmt: skip
        elif left.kind == YES_NO and op in _ORDER:
            self.scope.report(codes.YES_NO_ORDER, Span(start, end), sign=SIGN_OF[op])
        stack.append(_Operand(kind, depth, start, end))

    def _wants_number(self, by: str, operand: _Operand) -> None:
        if operand.kind == YES_NO:
            span = Span(operand.start, operand.end)
            found = self.scope.source[span]
            self.scope.report(codes.WANTS_NUMBER, span, by=by, found=found)

    def _wants_yes_no(self, by: str, operand: _Operand, other: _Operand | None = None) -> None:
        """`other` is the other side of an AND or OR.

        `X = 5 OR 6` means `X = 5 OR X = 6`, and `X AND Y > 5` means `X > 5 AND Y > 5`.
        """
        if operand.kind == NUMBER:
            span = Span(operand.start, operand.end)
            found = self.scope.source[span]
            values = self.question(found)
            if other is not None and other.end - other.start <= 80:
                asked = self.scope.source[Span(other.start, other.end)]
                before, behind = _COMPARED.match(asked), _COMPARES.fullmatch(asked)
                if other.start < operand.start and before:
                    values = {"fix": f"{before[0]} {found}"}
                elif behind and found.isidentifier():
                    values = {"fix": f"{found} {behind[1]}"}
            self.scope.report(codes.WANTS_CONDITION, span, None, by=by, found=found, **values)

    def question(self, found: str) -> dict[str, str]:
        """Return the yes or no that a number alone means, or an example of a question with it."""
        word = found.upper()
        name = self.scope.names.get(word)
        if name is not None:
            return {"example": f"{word} < 10" if name.what == "sensor" else f"{word} > 0"}
        meant = {"0": "FALSE", "1": "TRUE"}.get(word)
        if meant or not word.isdecimal():
            return {"fix": meant} if meant else {}
        names = {each.name for each in self.kit.sensors if not each.is_yes_no}
        sensor = "DISTANCE" if "DISTANCE" in names else "X"
        return {"times": word, "example": f"{sensor} < {word}"}

    def _yes_no_alone(self, op: str, left: _Operand, right: _Operand) -> str:
        """`BUTTON = 1` is `BUTTON`, and `BUTTON = 0` is `NOT BUTTON`."""
        number, answer = (left, right) if left.kind == NUMBER else (right, left)
        digit = self.scope.source[Span(number.start, number.end)]
        found = self.scope.source[Span(answer.start, answer.end)]
        if digit not in ("0", "1") or op not in _EQUAL or not found.isidentifier():
            return ""
        return found.upper() if (digit == "1") == (op == "EQ") else f"NOT {found.upper()}"
