"""Warns of code with a constant effect where another one was meant.

A clock that is past a number, MIN and MAX the wrong way round, an ELSE that is never reached, and a
RANDOM that is thrown again.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from tiniscript.base.fixed_point import HIGHEST, as_text
from tiniscript.base.source import Span
from tiniscript.diagnostics import codes
from tiniscript.semantics import ir
from tiniscript.semantics.comparisons import TIME, Comparison, comparison_of, is_one_of_many
from tiniscript.semantics.lint.context import BodyContext, LintContext
from tiniscript.semantics.optimizer import known_value

_LESS_OPS = ("LT", "LE")
_NARROWING_OPS = ("MIN", "MAX")
_SIDE_OPS = {"LT", "GT"}  # comparisons of one number, the only one that remains for ELSE
_THROW_OPS = ("NUMBER", "NUMBER", "RANDOM")


# -- the clock ------------------------------------------------------------------------------------


def report_past_clock(context: LintContext) -> None:
    """`WHILE(TIME < 10) … END_WHILE`, then `WHILE(TIME < 5)`: the clock does not begin again.

    Says nothing of a program with tasks: nobody knows what is first.
    """
    past_ms = 0
    for statement in () if context.program.tasks else context.program.body:
        if isinstance(statement, ir.While):
            clock_comparison = comparison_of(statement.condition, context.kit)
            if (
                clock_comparison is None
                or clock_comparison.device is not TIME
                or clock_comparison.op not in _LESS_OPS
            ):
                continue
            if past_ms and _is_over(clock_comparison, past_ms):
                _report_over(statement, clock_comparison, past_ms, context)
            elif not ir.breaks_out(statement.body):
                past_ms = max(past_ms, clock_comparison.number)
        else:
            past_ms += _least_duration(statement)


def _least_duration(statement: ir.Statement) -> int:
    """Return the shortest duration of a statement, in thousandths of a second."""
    if isinstance(statement, ir.Move) and statement.until is not None:
        return 0
    return max(0, known_value(ir.time_of(statement)) or 0)


def _report_over(
    loop: ir.While, clock_comparison: Comparison, past_ms: int, context: LintContext
) -> None:
    later_comparison = clock_comparison._replace(number=past_ms + clock_comparison.number)
    values = {"already": as_text(past_ms), "answer": "answer_no"}
    if later_comparison.number <= HIGHEST:
        values |= {"more": as_text(clock_comparison.number), "later": f"WHILE({later_comparison})"}
    context.report(codes.KNOWN_ANSWER, context.header_span(loop.span), **values)


def _is_over(clock_comparison: Comparison, past_ms: int) -> bool:
    return (
        past_ms >= clock_comparison.number
        if clock_comparison.op == "LT"
        else past_ms > clock_comparison.number
    )


# -- MIN and MAX ----------------------------------------------------------------------------------


def report_narrowed(
    statement: ir.Statement | ir.Task, body_context: BodyContext, context: LintContext
) -> None:
    """`MAX(80, MIN(20, DISTANCE))` is 80 at each distance."""
    nestings = (nesting for value in ir.expressions(statement) for nesting in _find_nested(value))
    for outer, inner, numbers in nestings:
        limit, inner_limit = numbers
        if outer != inner and (inner_limit < limit if outer == "MAX" else inner_limit > limit):
            nesting = f"{outer}({as_text(limit)}, {inner}({as_text(inner_limit)}, …))"
            narrowed_text = f"{outer}({as_text(inner_limit)}, {inner}({as_text(limit)}, …))"
            values = {"found": nesting, "number": as_text(limit), "narrow": narrowed_text}
            context.report(codes.KNOWN_ANSWER, statement.span, **values)


def _find_nested(value: ir.Expression) -> Iterator[tuple[str, str, tuple[int, int]]]:
    """Yield each MIN or MAX of a number with a nested one: both words, both numbers."""
    stack: list[tuple[str, int | None]] = []  # the operation after each value, and its number
    for op, number in value:
        if op == "NUMBER":
            stack.append((op, number))
        elif op in _NARROWING_OPS and len(stack) > 1:
            right, left = stack.pop(), stack.pop()
            numbers = [operand[1] for operand in (left, right) if operand[0] == "NUMBER"]
            inner = next(
                (operand for operand in (left, right) if operand[0] in _NARROWING_OPS), None
            )
            if len(numbers) == 1 and numbers[0] is not None and inner and inner[1] is not None:
                yield op, inner[0], (numbers[0], inner[1])
            stack.append((op, numbers[0] if len(numbers) == 1 else None))
        else:
            if op not in ("SENSOR", "VARIABLE", "TIME", "YES_NO"):
                return  # other calculations are none of these
            stack.append((op, None))


# -- ELSE -----------------------------------------------------------------------------------------


def report_no_room(statement: ir.If, body_context: BodyContext, context: LintContext) -> None:
    """`IF(D > 50) … ELSEIF(D < 50) … ELSE`: D is hardly ever 50."""
    for arm, next_arm in pairwise(statement.arms) if statement.has_else else ():
        first_condition, second_condition = arm.condition, next_arm.condition
        is_same_value = (
            first_condition[:-1] == second_condition[:-1]
            and {first_condition[-1].op, second_condition[-1].op} == _SIDE_OPS
        )
        if (
            is_same_value
            and first_condition[-2].op == "NUMBER"
            and _has_many_values(first_condition[:-2], first_condition[-2].value, context)
        ):
            text = context.condition_text(next_arm.span, "ELSEIF")
            name = text.partition("<")[0].partition(">")[0].strip()
            if name:
                values = {"value": name, "number": as_text(first_condition[-2].value)}
                context.report(codes.EXACT, next_arm.span, **values)


def _has_many_values(value: ir.Expression, number: int, context: LintContext) -> bool:
    """Return whether a value comes from a sensor with very many values."""
    for op, index in value:
        if op == "SENSOR" and is_one_of_many(context.kit.readings[index], max(number, 1)):
            return True
        if op == "VARIABLE":
            values_set = context.variables.values_by_variable.get(index, ())
            if any(term.op == "SENSOR" and is_one_of_many(context.kit.readings[term.value], 1)
                   for expression in values_set for term in expression):  # fmt: skip
                return True
    return False


# -- RANDOM ---------------------------------------------------------------------------------------


def report_thrown_arms(statement: ir.If, body_context: BodyContext, context: LintContext) -> None:
    """`IF(RANDOM(1, 3) = 1) … ELSEIF(RANDOM(1, 3) = 2)`: it may be that none is TRUE."""
    for arm, next_arm in pairwise(statement.arms):
        throw = _throw_of(arm.condition)
        if throw and throw == _throw_of(next_arm.condition) and next_arm.condition[-1].op == "EQ":
            _report_throw(throw, next_arm.span, context)
            return


def report_thrown_again(body: ir.Body, body_context: BodyContext, context: LintContext) -> None:
    """`SHOW(RANDOM(1, 6))`, then `LOOP(RANDOM(1, 6))`: no number is shown that counts."""
    for statement, next_statement in pairwise(body):
        throw = (
            statement.value
            if isinstance(statement, ir.Show) and len(statement.value) == len(_THROW_OPS)
            else ()
        )
        if (
            throw
            and _throw_of(throw)
            and isinstance(next_statement, ir.Loop)
            and next_statement.times == throw
        ):
            _report_throw(throw, context.header_span(next_statement.span), context)


def _report_throw(throw: ir.Expression, span: Span, context: LintContext) -> None:
    low, high = (as_text(term.value) for term in throw[:2])
    context.report(codes.NEW_THROW, span, random=f"RANDOM({low}, {high})")


def _throw_of(value: ir.Expression) -> ir.Expression:
    """Return the throw that a value begins with."""
    is_throw = tuple(term.op for term in value[: len(_THROW_OPS)]) == _THROW_OPS
    return value[: len(_THROW_OPS)] if is_throw else ()
