"""Warns of the effects of a move: they are only checked when it is over, or cannot be seen.

`F(5, 60)`, then `IF(DISTANCE < 20); S; ENDIF`, where while the robot moves was meant: the repair is
the move with that condition after UNTIL. `SI|M(2, 80)` and `M(80, 80); S`, where W is missing: the
program ends right after an M, or the motors change at once.
"""

from __future__ import annotations

from tiniscript.base.fixed_point import as_text
from tiniscript.base.source import Span
from tiniscript.diagnostics import codes
from tiniscript.semantics import ir
from tiniscript.semantics.comparisons import (
    asks_if_near,
    is_distance,
    is_usable_in_until,
    looks_ahead,
)
from tiniscript.semantics.lint.context import STANDING_STATEMENTS, BodyContext, LintContext
from tiniscript.semantics.optimizer import known_value
from tiniscript.syntax.operators import OPPOSITES, SIGN_OF

LONG_MOVE_MS = 500  # time in ms in which a robot moves a hand's breadth
LONG_STEP_MS = 1000  # time in ms after which a WHILE checks again
LONG_AFTER_MS = 5000  # length in ms of a move whose condition was checked only before it
_GREATER_COMPARATORS = ("GT", "GE")
_INSTANT_STATEMENTS = (ir.Read, ir.Assign, ir.Show, ir.Set, ir.Act)
_LIKELY_TIMES = range(1, 10_001)  # times that `M(2, 80)` may mean
_LIKELY_POWERS = range(20_000, 100_001)  # powers that `M(2, 80)` may mean


def report_late_conditions(body: ir.Body, body_context: BodyContext, context: LintContext) -> None:
    """Look at the statements of a body, not at those within them."""
    _LateConditions(context).check_body(body, body_context.loop, body_context.is_repeated)


class _LateConditions:
    def __init__(self, context: LintContext) -> None:
        self._context = context
        self._kit = context.kit
        self._source = context.source

    def check_body(self, body: ir.Body, loop: ir.Loop | ir.While | None, is_repeated: bool) -> None:
        """Look at the statements of a body, which `loop` repeats."""
        late_indexes = self._check_loop(body) if loop is not None else set()
        if isinstance(loop, ir.While):
            self._check_while(loop)
        for k, statement in enumerate(body):
            if isinstance(statement, ir.If) and k not in late_indexes:
                self._report_idle_stop(body, k, statement, loop)
                if not (is_repeated or self._context.program.tasks):
                    self._report_looked_before(body, k, statement)

    def _check_loop(self, body: ir.Body) -> set[int]:
        """Find a long move, then a look at a distance: the robot drives blind in between.

        Return the places of the conditions.
        """
        late_indexes = set()
        for k, statement in enumerate(body):
            if not isinstance(statement, ir.Move) or not self._is_blind(statement, LONG_MOVE_MS):
                continue
            indexes_after = range(k + 1, len(body))
            index = next(
                (index for index in indexes_after if not isinstance(body[index], ir.Read)), k
            )
            branch = body[index]
            if not isinstance(branch, ir.If):
                continue
            condition = branch.arms[0].condition
            sensor = self._distance_in(condition)
            is_usable = is_usable_in_until(condition, statement.direction, self._kit)
            if sensor is not None and is_usable:
                condition_text = self._context.condition_text(branch.arms[0].span, "IF")
                self._report_late_check(statement, sensor, condition_text)
                late_indexes.add(index)
        return late_indexes

    def _report_looked_before(self, body: ir.Body, k: int, branch: ir.If) -> None:
        """`IF(DISTANCE < 15); B(1, 70); ENDIF; F(10, 50)`: it looks once, and then drives on."""
        condition = branch.arms[0].condition
        sensor = self._distance_in(condition)
        move = _nearest_move(body, range(k + 1, len(body)))
        if sensor is None or branch.has_else or not asks_if_near(condition, self._kit):
            return
        if _only_stop(branch) or not isinstance(move, ir.Move):
            return
        is_blind = self._is_blind(move, LONG_AFTER_MS)
        if is_blind and is_usable_in_until(condition, move.direction, self._kit):
            self._report_late_check(
                move, sensor, self._context.condition_text(branch.arms[0].span, "IF")
            )

    def _check_while(self, loop: ir.While) -> None:
        """`WHILE(DISTANCE > 20); F(5, 60); END_WHILE`: it looks every 5 s."""
        body = [
            statement for statement in loop.body if not isinstance(statement, STANDING_STATEMENTS)
        ]
        condition = loop.condition
        if len(body) != 1 or len(condition) != 3 or condition[2].op not in _GREATER_COMPARATORS:
            return
        (move,) = body
        sensor = self._distance_in(condition[:1])
        if sensor is None or condition[1].op != "NUMBER" or not isinstance(move, ir.Move):
            return
        if move.direction == "F" and self._is_blind(move, LONG_STEP_MS):
            sign = OPPOSITES[SIGN_OF[condition[2].op]]
            device, number = self._kit.readings[sensor], condition[1].value
            if looks_ahead(device) and device.low < number <= device.high:
                self._report_late_check(move, sensor, f"{device.name} {sign} {as_text(number)}")

    def _report_late_check(self, move: ir.Move, sensor: int, condition_text: str) -> None:
        name = self._kit.readings[sensor].name
        text = self._source[move.span]
        values = {
            "word": move.direction,
            "time": as_text(_time_of(move) or 0),
            "sensor": name,
            "move": text,
            "fix": f"{text} UNTIL({condition_text})" if condition_text else "",
        }
        self._context.report(codes.LATE_CHECK, move.span, **values)

    def _report_idle_stop(
        self, body: ir.Body, k: int, branch: ir.If, loop: ir.Loop | ir.While | None
    ) -> None:
        """`F(5, 60); IF(DISTANCE < 20); S; ENDIF`: its S stops what stands."""
        stop = _only_stop(branch)
        condition = branch.arms[0].condition
        if stop is None or self._context.uses_motors or not _can_change(condition):
            return
        move_before = _nearest_move(body, range(k - 1, -1, -1))
        move_after = _nearest_move(body, range(k + 1, len(body)))
        pausing_statements = [
            statement for statement in branch.arms[0].body if ir.takes_time(statement)
        ]
        if any(isinstance(move, ir.Move) and move.direction == "W" for move in pausing_statements):
            return  # S with its wait is a pause
        has_pause = bool(pausing_statements)
        for move, gap in ((move_before, "move"), (move_after, "next")):
            if (
                isinstance(move, ir.Move)
                and move.direction in "FB"
                and self._is_blind(move, LONG_MOVE_MS)
            ):
                if move.direction == "B" and asks_if_near(condition, self._kit):
                    if gap == "move":
                        break
                    return  # the robot drives away from the obstacle
                values = self._idle_stop_values(stop, move, gap, branch)
                if values["fix"]:
                    values |= self._replacement_values(body, move, branch)
                if gap == "move" or not has_pause:
                    self._context.report(codes.IDLE_STOP, stop.span, **values)
                return
        repeated_move = move_before if isinstance(move_before, ir.Move) else move_after
        if (
            loop is not None
            and isinstance(repeated_move, ir.Move)
            and self._is_blind(repeated_move, 1)
            and not has_pause
        ):
            values = {"found": self._source[stop.span], "next": ""}
            values["again"] = self._source[repeated_move.span]
            self._context.report(codes.IDLE_STOP, stop.span, **values)

    def _idle_stop_values(
        self, stop: ir.Stop, move: ir.Move, gap: str, branch: ir.If
    ) -> dict[str, str]:
        """Return the words for an S before or after a move, with a repair where one is sure."""
        stop_text, move_text = self._source[stop.span], self._source[move.span]
        condition = branch.arms[0].condition
        is_usable = is_usable_in_until(condition, move.direction, self._kit)
        if move.direction == "B" and self._distance_in(condition) is not None:
            is_usable = False  # sensors do not see behind the robot
        condition_text = (
            self._context.condition_text(branch.arms[0].span, "IF") if is_usable else ""
        )
        values = {"found": stop_text, "move": "", "next": "", gap: move_text}
        values["fix"] = f"{move_text} UNTIL({condition_text})" if condition_text else ""
        if not is_usable:
            values["needless" if gap == "move" else "behind"] = move_text
        return values

    def _replacement_values(self, body: ir.Body, move: ir.Move, branch: ir.If) -> dict[str, str]:
        """Return the values that replace the move by one with an UNTIL: with the loop, or alone."""
        first_span, last_span = sorted((move.span, branch.span))
        first_line, if_line, last_line = (
            str(self._source.position(offset)[0])
            for offset in (first_span.start, branch.span.start, last_span.end - 1)
        )
        instructions_between = [
            statement
            for statement in body
            if first_span.end <= statement.span.start < last_span.start
        ]
        replaced_text = self._source[move.span]
        if len(branch.arms[0].body) > 1:
            return {"of": replaced_text, "rest": if_line}
        text = self._source.text
        rest_of_lines = (
            text[: first_span.start].rpartition("\n")[2] + text[last_span.end :].partition("\n")[0]
        )
        is_alone = first_line == last_line or not rest_of_lines.partition("//")[0].strip()
        if (
            any(not isinstance(statement, ir.Read) for statement in instructions_between)
            or not is_alone
        ):
            return {"of": replaced_text, "out": if_line}
        if first_line == last_line:
            return {"all": self._source[Span(first_span.start, last_span.end)]}
        return {"first": first_line, "last": last_line}

    def _is_blind(self, move: ir.Move, least_ms: int) -> bool:
        """Return whether a move takes long and checks no sensor."""
        time = _time_of(move)
        if move.direction not in ("F", "B") or move.until is not None:
            return False
        return time is not None and time >= least_ms

    def _distance_in(self, condition: ir.Expression) -> int | None:
        """Return the first sensor of a distance that a condition looks at."""
        for op, value in condition:
            if op == "SENSOR" and is_distance(self._kit.readings[value]):
                return value
        return None


def _nearest_move(body: ir.Body, indexes: range) -> ir.Statement | None:
    """Return the first statement there that may move the robot."""
    return next(
        (body[index] for index in indexes if not isinstance(body[index], STANDING_STATEMENTS)), None
    )


def _time_of(move: ir.Move) -> int | None:
    return None if move.unit else known_value(move.time)


def _can_change(condition: ir.Expression) -> bool:
    """Return whether a condition may change while the robot moves, through sensors and numbers."""
    ops = [term.op for term in condition]
    return "SENSOR" in ops and "VARIABLE" not in ops and "RANDOM" not in ops


def _only_stop(branch: ir.If) -> ir.Stop | None:
    """Return the S of an IF that uses the motors only for it, and has no ELSE."""
    if len(branch.arms) != 1 or branch.has_else:
        return None
    stop: ir.Stop | None = None
    for statement in branch.arms[0].body:
        if isinstance(statement, ir.Stop):
            stop = stop or statement
        elif not _is_talk(statement):
            return None
    return stop


def _is_talk(statement: ir.Statement) -> bool:
    is_wait = isinstance(statement, ir.Move) and statement.direction == "W"
    return is_wait or isinstance(statement, (ir.Read, ir.Show, ir.Act))


def report_unseen_motors(body: ir.Body, body_context: BodyContext, context: LintContext) -> None:
    """Warn of each M of a body that the robot does not do for a while."""
    source = context.source
    for k, motors in enumerate(body):
        if not isinstance(motors, ir.Motors) or _is_still(motors):
            continue
        rest = (body[index] for index in range(k + 1, len(body)))
        next_statement = next(
            (item for item in rest if isinstance(item, ir.If) or not _is_instant(item)), None
        )
        if isinstance(next_statement, ir.If) and all(map(_is_instant, (next_statement, *rest))):
            next_statement = None
        if isinstance(next_statement, ir.Motors) and next_statement[:2] == motors[:2]:
            continue  # the motors are set to the same values again
        values = {"found": source[motors.span]}
        if isinstance(next_statement, (ir.Motors, ir.Stop)) or (
            isinstance(next_statement, ir.Move)
            and next_statement.direction != "W"
            and next_statement.until is None
        ):
            values["next"] = source[next_statement.span]
        elif next_statement is not None or not body_context.is_last:
            continue
        left, right = known_value(motors.left) or 0, known_value(motors.right) or 0
        if left in _LIKELY_TIMES and right in _LIKELY_POWERS:
            values["time"] = as_text(left)
            values["move"] = f"F({as_text(left)}, {as_text(right)})"
        context.report(codes.UNSEEN_MOTORS, motors.span, **values)


def _is_instant(statement: ir.Statement) -> bool:
    """Also an IF that is over at once, whatever the answer is."""
    if not isinstance(statement, ir.If):
        return isinstance(statement, _INSTANT_STATEMENTS) and not ir.takes_time(statement)
    bodies = (statement.else_body, *(arm.body for arm in statement.arms))
    return all(isinstance(item, ir.Stop) or _is_instant(item) for body in bodies for item in body)


def _is_still(motors: ir.Motors) -> bool:
    """`M(0, 0)` is a way to stop."""
    return not known_value(motors.left) and not known_value(motors.right)
