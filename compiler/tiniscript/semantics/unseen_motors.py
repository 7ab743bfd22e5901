"""Warns of an M that nobody sees: the program ends right behind it, or the motors change at once.

`SI|M(2, 80)` and `M(80, 80); S`, where W is missing. Knows the IR, before it is optimised.
"""

from __future__ import annotations

from tiniscript.base.fixed_point import as_text
from tiniscript.base.source import Source
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.semantics import ir
from tiniscript.semantics.optimizer import known_value

_TAKE_NO_TIME = (ir.Read, ir.Assign, ir.Show, ir.Set)
_TIMES = range(1, 10_001)  # of `M(2, 80)`: a time was meant,
_POWERS = range(20_000, 100_001)  # and a power


def unseen(body: ir.Body, ends: bool, source: Source) -> list[Diagnostic]:
    """Return the warnings for each M of a body; the program ends with the body where `ends`."""
    found = []
    for k, motors in enumerate(body):
        if not isinstance(motors, ir.Motors) or _is_still(motors):
            continue
        rest = (body[at] for at in range(k + 1, len(body)))
        after = next((each for each in rest if not isinstance(each, _TAKE_NO_TIME)), None)
        if isinstance(after, ir.If) and all(map(_takes_no_time, (after, *rest))):
            after = None
        if isinstance(after, ir.Motors) and after[:2] == motors[:2]:
            continue  # they are set again to the same
        values = {"found": source[motors.span]}
        if isinstance(after, (ir.Motors, ir.Stop)) or (
            isinstance(after, ir.Move) and after.direction != "W" and after.until is None
        ):
            values["next"] = source[after.span]
        elif after is not None or not ends:
            continue
        left, right = known_value(motors.left) or 0, known_value(motors.right) or 0
        if left in _TIMES and right in _POWERS:
            values["time"] = as_text(left)
            values["move"] = f"F({as_text(left)}, {as_text(right)})"
        found.append(Diagnostic(codes.UNSEEN_MOTORS, motors.span, values))
    return found


def _takes_no_time(statement: ir.Statement) -> bool:
    """Also an IF that is over at once, whatever the answer is."""
    if not isinstance(statement, ir.If):
        return isinstance(statement, _TAKE_NO_TIME)
    bodies = (statement.otherwise, *(arm.body for arm in statement.arms))
    return all(
        isinstance(each, ir.Stop) or _takes_no_time(each) for body in bodies for each in body
    )


def _is_still(motors: ir.Motors) -> bool:
    """`M(0, 0)` is a way to stop."""
    return not known_value(motors.left) and not known_value(motors.right)
