"""The optimizer: IR becomes shorter IR that does the same.

Folds constants, drops what is never reached and DEFs that nobody calls. Never changes a trace or a
fault: code that would fault still does, and readings stay where they are.
"""

from __future__ import annotations

from collections.abc import Callable

from tiniscript.base import fixed_point
from tiniscript.base.fixed_point import Fault, round_to_whole
from tiniscript.semantics import ir

_BINARY: dict[str, Callable[[int, int], int]] = {
    "ADD": fixed_point.add, "SUB": fixed_point.subtract, "MUL": fixed_point.multiply,
    "DIV": fixed_point.divide, "MOD": fixed_point.modulo, "MIN": min, "MAX": max,
    "ROUND": fixed_point.round_to,
    "EQ": int.__eq__, "NE": int.__ne__, "LT": int.__lt__, "LE": int.__le__, "GT": int.__gt__,
    "GE": int.__ge__,
}  # fmt: skip
_UNARY: dict[str, Callable[[int], int]] = {
    "NEG": fixed_point.negate, "ABS": fixed_point.absolute, "NOT": (1).__sub__,
}  # fmt: skip
_YES_NO_OPS = frozenset(("EQ", "NE", "LT", "LE", "GT", "GE", "NOT"))
# Operations that cannot fault, so that leaving them out changes nothing.
SAFE_OPS = frozenset(("NUMBER", "YES_NO", "VARIABLE", "SENSOR", "EQ", "NE", "LT", "LE", "GT", "GE",
                  "NOT", "AND", "OR", "AND_LEFT", "OR_LEFT", "MIN", "MAX"))  # fmt: skip


_Operand = tuple[list[ir.Term], bool]


def optimize_program(program: ir.Program) -> ir.Program:
    """Return a program with the same traces and faults, no longer than `program`.

    A calculated constant of 32 bits, such as 100/3, may take two bytes more than its parts: it is
    pushed in a fraction of the time that a robot takes to calculate it.
    """
    body, tasks = _body(program.body), tuple(_task(task) for task in program.tasks)
    procedures = [
        procedure._replace(body=_body(procedure.body)) for procedure in program.procedures
    ]
    statements_left = ir.walk_with_calls(sum((task.body for task in tasks), body), procedures)
    called_numbers = {call.procedure for call in statements_left if isinstance(call, ir.Call)}
    procedures_left = tuple(
        procedure._replace(is_called=k in called_numbers) for k, procedure in enumerate(procedures)
    )
    return program._replace(procedures=procedures_left, tasks=tasks, body=body)


def fold(expression: ir.Expression) -> ir.Expression:
    """Return an expression whose constant parts are calculated, where they do not fault."""
    if len(expression) == 1:
        return expression
    # each entry is an operand so far, and whether it is safe: see SAFE_OPS
    stack: list[_Operand] = []
    for term in expression:
        op = term.op
        if op in ("AND_LEFT", "OR_LEFT"):
            continue
        if op in ("AND", "OR"):
            right, left = stack.pop(), stack.pop()
            stack.append(_simplify(op, left, right))
        elif op in _UNARY:
            terms, is_safe_so_far = stack.pop()
            folded_terms = _calculate(op, terms, None) if _is_constant(terms) else None
            if folded_terms is None:
                terms.append(term)
                folded_terms, is_safe_so_far = terms, is_safe_so_far and op in SAFE_OPS
            stack.append((folded_terms, is_safe_so_far))
        elif op in _BINARY or op == "RANDOM":
            (right_terms, right_safe), (terms, left_safe) = stack.pop(), stack.pop()
            folded_terms = None
            if op in _BINARY and _is_constant(terms) and _is_constant(right_terms):
                folded_terms = _calculate(op, terms, right_terms)
            if folded_terms is None:
                terms.extend(right_terms)
                terms.append(term)
                stack.append((terms, left_safe and right_safe and op in SAFE_OPS))
            else:
                stack.append((folded_terms, True))
        else:
            stack.append(([term], op in SAFE_OPS))
    return tuple(stack[0][0])


def constant(expression: ir.Expression) -> int | None:
    """Return the value of a folded expression, or None if only the robot knows it."""
    return expression[0].value if _is_constant(expression) else None


def known_value(expression: ir.Expression | None) -> int | None:
    """Return the value of an expression; None if there is none or only the robot knows it."""
    return None if expression is None else constant(fold(expression))


def is_safe(terms: ir.Expression) -> bool:
    """Return whether evaluating these terms is free of faults and side effects."""
    return all(term.op in SAFE_OPS for term in terms)


def sure_fault(expression: ir.Expression) -> str:
    """Return the fault that a folded expression is sure to make when it is reached, or ""."""
    stack: list[int | None] = []
    for term in expression:
        op = term.op
        if op in ("NUMBER", "YES_NO"):
            stack.append(term.value)
        elif op in _UNARY or op in _BINARY or op in ("RANDOM", "AND", "OR"):
            right = stack.pop()
            left = right if op in _UNARY else stack.pop()
            if left is not None and right is not None:
                try:
                    _ = _UNARY[op](right) if op in _UNARY else _BINARY[op](left, right)
                except Fault as fault:
                    return fault.name
                except KeyError:  # RANDOM
                    pass
            stack.append(None)
        elif not op.endswith("_LEFT"):
            stack.append(None)
    return ""


def _is_constant(terms: ir.Expression | list[ir.Term]) -> bool:
    return len(terms) == 1 and terms[0].op in ("NUMBER", "YES_NO")


def _calculate(op: str, left: list[ir.Term], right: list[ir.Term] | None) -> list[ir.Term] | None:
    """Return the result of an operator on constants, or None if it faults."""
    try:
        if right is None:
            value = _UNARY[op](left[0].value)
        else:
            value = _BINARY[op](left[0].value, right[0].value)
    except Fault:
        return None
    return [ir.Term("YES_NO" if op in _YES_NO_OPS else "NUMBER", int(value))]


def _simplify(op: str, left: _Operand, right: _Operand) -> _Operand:
    """Return `left op right`, without the side that a constant makes needless."""
    deciding_value = 0 if op == "AND" else 1
    (terms, left_safe), (right_terms, right_safe) = left, right
    if _is_constant(terms):
        return left if terms[0].value == deciding_value else right
    if _is_constant(right_terms):
        if right_terms[0].value != deciding_value:
            return left
        if left_safe:
            return right
    terms.append(ir.Term(op + "_LEFT"))
    terms.extend(right_terms)
    terms.append(ir.Term(op))
    return terms, left_safe and right_safe


def _body(body: ir.Body) -> ir.Body:
    statements: list[ir.Statement] = []
    for statement in body:
        statements += _statement(statement)
        if statements and not ir.falls_through(tuple(statements[-1:])):
            break
    return tuple(statements)


def _task(task: ir.Task) -> ir.Task:
    until = task.until
    if until is not None:
        until = until._replace(condition=fold(until.condition))
    return task._replace(until=until, body=_body(task.body))


def _statement(statement: ir.Statement) -> tuple[ir.Statement, ...]:
    if isinstance(statement, ir.If):
        return _optimize_if(statement)
    if isinstance(statement, ir.Loop):
        return _loop(statement)
    if isinstance(statement, ir.While):
        return _while(statement)
    folded_values = ir.changed_values(statement, fold)
    if isinstance(statement, ir.Move) and statement.until is not None:
        folded_values["until"] = statement.until._replace(condition=fold(statement.until.condition))
    return (statement._replace(**folded_values) if folded_values else statement,)


def _optimize_if(statement: ir.If) -> tuple[ir.Statement, ...]:
    arms: list[ir.Arm] = []
    else_body = _body(statement.else_body)
    for arm in statement.arms:
        condition = fold(arm.condition)
        value = constant(condition)
        if value == 0 and not arm.reads:
            continue
        body = _body(arm.body)
        if value == 1 and not arm.reads:
            else_body = body
            break
        arms.append(ir.Arm(arm.reads, condition, body, arm.span))
        if value == 1:
            else_body = ()
            break
    if not arms:
        return else_body
    if arms[0].reads:  # an ELSEIF that became the IF: its readings come first
        reads = tuple(ir.Read(sensor, arms[0].span) for sensor in arms[0].reads)
        rest_of_if = ir.If((arms[0]._replace(reads=()), *arms[1:]), else_body, statement.span)
        return (*reads, *_optimize_if(rest_of_if))
    if not else_body and not any(arm.body or arm.reads for arm in arms):
        if all(is_safe(arm.condition) for arm in arms):
            return ()
    return (ir.If(tuple(arms), else_body, statement.span),)


def _loop(loop: ir.Loop) -> tuple[ir.Statement, ...]:
    if loop.times is None:
        return (loop._replace(body=_body(loop.body)),)
    count = fold(loop.times)
    value = constant(count)
    if value is not None and round_to_whole(value) <= 0:
        return ()
    return (loop._replace(times=count, body=_body(loop.body)),)


def _while(loop: ir.While) -> tuple[ir.Statement, ...]:
    condition = fold(loop.condition)
    value = constant(condition)
    if value == 0:
        return tuple(ir.Read(sensor, loop.span) for sensor in loop.reads)
    if value == 1:
        reads = tuple(ir.Read(sensor, loop.span) for sensor in loop.reads)
        return (ir.Loop(None, _body((*reads, *loop.body)), loop.span),)
    return (loop._replace(condition=condition, body=_body(loop.body)),)
