"""The IR as text: compared by tests of the checker and the optimiser."""

from __future__ import annotations

from collections.abc import Iterator

from tiniscript.base.fixed_point import as_text
from tiniscript.semantics.ir import Body, Expression, If, Loop, Move, Program, While, values_of

SHOWN_FIELDS = ("direction", "unit", "sensor", "actuator", "variable", "procedure", "reads")


def expression_text(expression: Expression) -> str:
    """Return `n5 v0 ADD`: an expression for people who debug the compiler."""
    letters = {"VARIABLE": "v", "SENSOR": "s", "YES_NO": "yes_no"}
    words = []
    for op, value in expression:
        if op == "NUMBER":
            words.append(as_text(value))
        elif op in letters:
            words.append(f"{letters[op]}{value}")
        else:
            words.append(op)
    return " ".join(words)


def program_text(program: Program) -> str:
    """Return the whole program as lines of text, blocks indented."""
    lines = [program.start]
    for procedure in (procedure for procedure in program.procedures if procedure.is_called):
        lines += [f"DEF {procedure.name}", *_body_lines(procedure.body, "  ")]
    for task in program.tasks:
        task_head = "TASK"
        if task.until is not None:
            task_head = f"WHEN {task.until.reads} {expression_text(task.until.condition)}"
        lines += [task_head, *_body_lines(task.body, "  ")]
    return "\n".join([*lines, *_body_lines(program.body, "")]) + "\n"


def _body_lines(body: Body, indent: str) -> Iterator[str]:
    for statement in body:
        words, values = [type(statement).__name__], values_of(statement)
        for name, value in statement._asdict().items():
            if value == "":
                continue
            if value is None and name in ("time", "times"):
                words.append("FOREVER")
            elif name in values:
                words.append(expression_text(value))
            elif name in SHOWN_FIELDS:
                words.append(str(value))
        yield indent + " ".join(words)
        if isinstance(statement, Move) and statement.until is not None:
            reading, condition = statement.until
            yield f"{indent}  until {reading} {expression_text(condition)}"
        if isinstance(statement, If):
            for arm in statement.arms:
                yield f"{indent}  arm {arm.reads} {expression_text(arm.condition)}"
                yield from _body_lines(arm.body, indent + "    ")
            yield f"{indent}  else"
            yield from _body_lines(statement.else_body, indent + "    ")
        elif isinstance(statement, (Loop, While)):
            yield from _body_lines(statement.body, indent + "  ")
