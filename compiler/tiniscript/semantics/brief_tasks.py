"""Warns of a TASK that is done once, and of a WHEN whose S lasts no longer than its answer.

Where another one was meant: `TASK;BEEP(0.2, 440);W(1);END_TASK` waits before nothing, and behind
`WHEN(DISTANCE < 10);S;END_WHEN` a loop drives on. Knows the IR, before it is optimised.
"""

from __future__ import annotations

import re

from tiniscript.base.source import Edit, Source, Span
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic, Repair
from tiniscript.semantics import ir
from tiniscript.semantics.kept_motors import drives, endless
from tiniscript.semantics.optimizer import known_value

_HEAD = re.compile(r"(?i)WHEN[ \t]*(\(.*\))[ \t]*(?=$|[;\r\n]|//)")
_END = re.compile(r"\w+\Z")
_TAKES_NO_TIME = (ir.Read, ir.Assign, ir.Show, ir.Set, ir.Stop, ir.Call)


def brief_tasks(program: ir.Program, source: Source) -> list[Diagnostic]:
    """Return the warnings for the tasks of a program."""
    found = []
    lower = [program.body, *(each.body for each in program.tasks if each.look is None)]
    driving = [
        body[-1] for body in lower
        if any(map(drives, ir.with_calls(endless(body), program.procedures)))
    ]  # fmt: skip
    for task in program.tasks:
        done = [*ir.with_calls(task.body, program.procedures)]
        if task.look is None:
            if task.body and _is_pause(task.body[-1]) and not any(map(_repeats, done)):
                found.append(_done_once(task, source))
        elif driving and known_value(task.look.condition) is None:
            is_brief = all(isinstance(each, _TAKES_NO_TIME) for each in done)
            if is_brief and any(isinstance(each, ir.Stop) for each in done):
                found.append(_goes_on(task, driving[0], source))
    return found


def _is_pause(statement: ir.Statement) -> bool:
    is_move = isinstance(statement, ir.Move) and statement.power is None
    return is_move and statement.until is None  # type: ignore[union-attr]


def _repeats(statement: ir.Statement) -> bool:
    return isinstance(statement, (ir.Loop, ir.While))


def _done_once(task: ir.Task, source: Source) -> Diagnostic:
    """It says to write a loop around all of it, on lines of its own where the TASK has them."""
    text = source[task.span]
    end = _END.search(text)
    assert end is not None
    behind, before = task.word.end, task.span.start + end.start()
    between = "\n" if "\n" in text else ";"
    edits = (Edit(Span(behind, behind), f"{between}LOOP(FOREVER)"),
             Edit(Span(before, before), f"END_LOOP{between}"))  # fmt: skip
    return Diagnostic(codes.TASK_DONE_ONCE, task.word, {}, None, Repair(edits, False))


def _goes_on(task: ir.Task, driving: ir.Statement, source: Source) -> Diagnostic:
    head = _HEAD.match(source[task.span])
    values = {"line": str(source.position(driving.span.start)[0])}
    if head is not None:
        ended = f"IF{head[1]};BREAK;ENDIF" if isinstance(driving, ir.Loop) else f"UNTIL{head[1]}"
        values["ended"] = ended
    # a DEF that is called may have it
    stops = [each for each in task.body if isinstance(each, (ir.Stop, ir.Call))]
    stop = min(stops, key=lambda each: isinstance(each, ir.Call))
    return Diagnostic(codes.WHEN_GOES_ON, stop.span, values)
