"""Warns of conditions whose answer does not come: nothing changes it, or it never comes exactly.

`D = DISTANCE; F(5, 60) UNTIL(D < 20)`, `N = 0; WHILE(N < 3)` without `N = N + 1`,
`F(5, 60) UNTIL(DISTANCE > 20)`, `UNTIL(DISTANCE = 20)`. Says nothing of a program with tasks: what
one asks another may change.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from tiniscript.base.fixed_point import as_text
from tiniscript.base.source import Span
from tiniscript.diagnostics import codes
from tiniscript.semantics import ir
from tiniscript.semantics.comparisons import (
    TIME,
    Comparison,
    answer_of,
    answer_of_both,
    comparison_of,
    is_one_of_many,
    is_usable_in_until,
    looks_ahead,
)
from tiniscript.semantics.lint.context import STANDING_STATEMENTS, BodyContext, LintContext
from tiniscript.semantics.optimizer import known_value
from tiniscript.syntax.operators import BINARY, OPPOSITES, SIGN_OF

SHORT_MOVE_MS = 1000  # time in ms after which a loop checks again
_CHANGING_OPS = frozenset(("SENSOR", "TIME", "RANDOM"))
# Comparisons that hold and that become true, by direction of the move.
_REVERSED_COMPARATORS = {"F": {"GT": "LT", "GE": "LE"}, "B": {"LT": "GT", "LE": "GE"}}
_SIDE_BY_COMPARATOR = {"LT": "below", "LE": "below", "GT": "above", "GE": "above"}
_MAX_ARMS = 50  # most arms of an IF whose conditions are compared
_COMPARATOR_REACHED = {
    "F": "LE",
    "B": "GE",
}  # comparisons certain to become true, by direction of the move


def _is_endless(loop: ir.Loop | ir.While) -> bool:
    """Return whether a loop counts nothing: the counted part may do what was decided before it."""
    return not isinstance(loop, ir.Loop) or loop.times is None


def check_until(move: ir.Move, body_context: BodyContext, context: LintContext) -> None:
    if move.until is not None and not context.program.tasks:
        _Conditions(context).check_until(move, move.until.condition, body_context)


def check_while(loop: ir.While, body_context: BodyContext, context: LintContext) -> None:
    if not context.program.tasks:
        _Conditions(context).check_while(loop, body_context)


def check_if(statement: ir.If, body_context: BodyContext, context: LintContext) -> None:
    if not context.program.tasks:
        _Conditions(context).check_if(statement, body_context.outermost)


def check_show(show: ir.Show, body_context: BodyContext, context: LintContext) -> None:
    if body_context.outermost is not None and not context.program.tasks:
        _Conditions(context).report_frozen_show(show, body_context.outermost)


def report_asked_once(context: LintContext) -> None:
    """A program that reads no remote control loads nothing for it."""
    remote = {*range(len(context.kit.sensors), len(context.kit.readings))}
    if remote & ir.referenced_numbers("SENSOR", context.statements):
        from tiniscript.semantics.lint import once

        once.report_asked_once(context, remote)


class _Conditions:
    def __init__(self, context: LintContext) -> None:
        self._context = context
        self._program = context.program
        self._kit = context.kit
        self._source = context.source

    # -- UNTIL --------------------------------------------------------------------------------

    def check_until(
        self, move: ir.Move, condition: ir.Expression, body_context: BodyContext
    ) -> None:
        self._report_known_of_both(condition, move.span)
        variables = _variables(condition)
        if variables and not any(term.op in _CHANGING_OPS for term in condition):
            time = known_value(move.time)
            if not (body_context.is_repeated and time is not None and time < SHORT_MOVE_MS):
                self._report_frozen_until(move, condition, variables)
            return
        comparison = self._comparison(condition)
        if comparison is None or self._report_known(comparison, move.span):
            self._report_subtracted(condition, move.span)
            return
        device, op, number = comparison
        is_ahead = looks_ahead(device)
        is_turned = op in _REVERSED_COMPARATORS.get(move.direction, {}) and is_ahead
        if is_turned and not body_context.asked_sensors & _sensors(condition):
            reversed_comparison = comparison._replace(op=_REVERSED_COMPARATORS[move.direction][op])
            fixed_move = (
                ""
                if answer_of(reversed_comparison)
                else self._with_condition(move, str(reversed_comparison))
            )
            is_forward = move.direction == "F"
            number_gap, repair_gap = ("number", "fix") if is_forward else ("far", "away")
            values = {"sensor": device.name, number_gap: as_text(number), repair_gap: fixed_move}
            self._context.report(codes.TURNED_ROUND, move.span, **values)
        else:
            reached_op = "GE" if device is TIME else _COMPARATOR_REACHED.get(move.direction, "")
            condition_text = f"{device.name} {SIGN_OF.get(reached_op, '')} {as_text(number)}"
            is_sure = bool(reached_op) and (is_ahead or device is TIME)
            fix = self._with_condition(move, condition_text) if is_sure else ""
            self._report_exact(comparison, move.span, "UNTIL", fix)

    def _report_frozen_until(
        self, move: ir.Move, condition: ir.Expression, variables: list[int]
    ) -> None:
        sensor_of_variable = self._context.variables.sensors_of(variables)
        name = self._program.variables[variables[0]]
        sign = ">" if move.direction == "B" else "<"
        values = {"name": name, "fix": "", "example": f"UNTIL(DISTANCE {sign} 20)"}
        if sensor_of_variable:
            values["sensor"] = sensor_of_variable[name]
            condition_text = self._condition_text(
                condition, sensor_of_variable, move.span, "UNTIL", move.direction
            )
            values["fix"] = self._with_condition(move, condition_text) if condition_text else ""
        self._context.report(codes.FROZEN_UNTIL, move.span, **values)

    def _with_condition(self, move: ir.Move, new_condition: str) -> str:
        """Return a move as written, with another condition after UNTIL."""
        text = self._source[move.span]
        end = max((match.start() for match in re.finditer(r"(?i)\bUNTIL\b", text)), default=0)
        return f"{text[:end].rstrip()} UNTIL({new_condition})" if end else ""

    # -- WHILE and IF -------------------------------------------------------------------------

    def check_while(self, loop: ir.While, body_context: BodyContext) -> None:
        self._report_frozen_while(loop)
        header_span = Span(loop.span.start, loop.span.start + len("WHILE"))
        comparison = self._comparison(loop.condition)
        if comparison and not self._report_known(comparison, header_span):
            if not body_context.asked_sensors & _sensors(loop.condition):
                self._report_turned_while(loop, comparison)
        self._report_known_of_both(loop.condition, header_span)

    def check_if(self, statement: ir.If, outermost: ir.Loop | ir.While | None) -> None:
        self._report_late_arms(statement)
        for arm in statement.arms:
            self._report_subtracted(arm.condition, arm.span)
            self._report_known_of_both(arm.condition, arm.span)
            comparison = self._comparison(arm.condition)
            if comparison and not self._report_known(comparison, arm.span):
                self._report_exact(comparison, arm.span, "IF", "")
            if outermost is not None and _is_endless(outermost):
                self._report_frozen_if(arm, outermost)

    def _report_turned_while(self, loop: ir.While, comparison: Comparison) -> None:
        """`WHILE(DISTANCE < 10); F(0.2, 60); END_WHILE`: what ends it does not come that way."""
        direction, ending_op = self._direction_and_ending_op(loop, comparison)
        if ending_op:
            device, _, number = comparison
            reversed_comparison = comparison._replace(op=_opposite(ending_op))
            is_short = all(_duration_ms(statement) < SHORT_MOVE_MS for statement in loop.body)
            fix = (
                f"WHILE({reversed_comparison})"
                if is_short and not answer_of(reversed_comparison)
                else ""
            )
            number_gap = "near" if direction == "F" else "beyond"
            values = {"sensor": device.name, number_gap: as_text(number), "fix": fix}
            self._context.report(codes.TURNED_ROUND, self._context.header_span(loop.span), **values)

    def _direction_and_ending_op(self, loop: ir.While, comparison: Comparison) -> tuple[str, str]:
        """Return the direction of all moves of a loop, and the other condition that would end it,
        if any."""
        moves = [
            statement for statement in loop.body if not isinstance(statement, STANDING_STATEMENTS)
        ]
        directions = {
            statement.direction if isinstance(statement, ir.Move) else "" for statement in moves
        }
        is_watched = any(isinstance(statement, ir.Move) and statement.until for statement in moves)
        if len(directions) != 1 or is_watched or not looks_ahead(comparison.device):
            return "", ""
        (direction,) = directions
        return direction, _REVERSED_COMPARATORS.get(direction, {}).get(_opposite(comparison.op), "")

    def _report_frozen_while(self, loop: ir.While) -> None:
        condition = loop.condition
        variables = _variables(condition)
        if not variables or any(term.op in _CHANGING_OPS for term in condition):
            return
        if (
            len(condition) == 1
            or ir.breaks_out(loop.body)
            or self._context.variables.assigned_in(loop.body) & set(variables)
        ):
            return
        sensor_of_variable = self._context.variables.sensors_of(variables)
        if not sensor_of_variable and condition[-1].op not in ("LT", "LE", "GT", "GE", "NE"):
            return  # `WHILE(ON = 1)` is how others write LOOP(FOREVER)
        name = self._program.variables[variables[0]]
        header_span = Span(loop.span.start, loop.span.start + len("WHILE"))
        values = {"name": name, "fix": ""}
        if sensor_of_variable:
            values["sensor"] = sensor_of_variable[name]
            condition_text = self._condition_text(condition, sensor_of_variable, loop.span, "WHILE")
            comparison = self._comparison(self._condition_of_sensors(condition, sensor_of_variable))
            is_turned = comparison is not None and bool(
                self._direction_and_ending_op(loop, comparison)[1]
            )
            values["fix"] = f"WHILE({condition_text})" if condition_text and not is_turned else ""
        elif [term.op for term in condition[:-1]] == ["VARIABLE", "NUMBER"]:
            is_down = condition[-1].op in ("GT", "GE")
            values["step"] = f"{name} = {name} {'-' if is_down else '+'} 1"
        self._context.report(codes.FROZEN_WHILE, header_span, **values)

    def _report_frozen_if(self, arm: ir.Arm, outermost: ir.Loop | ir.While) -> None:
        """`D = DISTANCE; LOOP(FOREVER); IF(D < 20) …`: it moves, and looks at what was before."""
        variables = _variables(arm.condition)
        sensor_of_variable = self._context.variables.sensors_held_in(outermost, variables)
        if not sensor_of_variable or any(term.op in _CHANGING_OPS for term in arm.condition):
            return
        name = self._program.variables[variables[0]]
        word = "IF" if self._source[arm.span][:1].upper() == "I" else "ELSEIF"
        condition_text = self._condition_text(arm.condition, sensor_of_variable, arm.span, word)
        fix = f"{word}({condition_text})" if condition_text else ""
        self._context.report(
            codes.FROZEN_WHILE, arm.span, name=name, sensor=sensor_of_variable[name], fix=fix
        )

    def report_frozen_show(self, show: ir.Show, outermost: ir.Loop | ir.While) -> None:
        """`D = DISTANCE; LOOP(5); SHOW(D); W(1); END_LOOP`: each round shows the same."""
        variables = _variables(show.value) if len(show.value) == 1 else []
        if variables and self._report_thrown_once(show, variables[0], outermost):
            return
        sensor_of_variable = self._context.variables.sensors_held_in(outermost, variables)
        if not sensor_of_variable:
            return
        name = self._program.variables[variables[0]]
        sensor = next(
            k
            for k, device in enumerate(self._kit.readings)
            if device.name == sensor_of_variable[name]
        )
        used_terms = self._context.variables.terms_used_in(outermost)
        if {ir.Term("SENSOR", sensor), ir.Term("VARIABLE", variables[0])} & used_terms:
            return  # it is shown together with the current measurement, or the rounds depend on it
        fix = f"SHOW({sensor_of_variable[name]})"
        self._context.report(
            codes.FROZEN_WHILE, show.span, name=name, sensor=sensor_of_variable[name], fix=fix
        )

    def _report_thrown_once(self, show: ir.Show, variable: int, loop: ir.Loop | ir.While) -> bool:
        """`DICE = RANDOM(1, 6); LOOP(5); SHOW(DICE); END_LOOP`: five times the same number.

        The warning appears if the loop shows the number in each round, shows no other value that
        changes, and the number has no other use.
        """
        assignments = [
            statement
            for statement in self._program.body
            if isinstance(statement, ir.Assign) and statement.variable == variable
        ]
        if len(assignments) != 1 or self._context.variables.values_by_variable[variable] != [
            assignments[0].value
        ]:
            return False
        if all(term.op != "RANDOM" for term in assignments[0].value) or _runs_once(loop):
            return False
        term = ir.Term("VARIABLE", variable)
        is_only_shown = all(
            isinstance(statement, ir.Show)
            for statement in ir.all_statements(self._program)
            if any(term in expression for expression in ir.expressions(statement))
        )
        shown_terms = {
            term for show in ir.walk(loop.body) if isinstance(show, ir.Show) for term in show.value
        }
        changing_terms = [
            term for term in shown_terms if term.op in _CHANGING_OPS or term.op == "VARIABLE"
        ]
        is_before = assignments[0].span.end <= loop.span.start
        if not (
            is_before
            and is_only_shown
            and changing_terms == [term]
            and show in _round_statements(loop)
        ):
            return False
        name, assignment = self._program.variables[variable], self._source[assignments[0].span]
        if not any(
            diagnostic.values.get("thrown") == name for diagnostic in self._context.diagnostics
        ):
            example = f"{assignment};{self._source[show.span]}"
            self._context.report(codes.FROZEN_WHILE, show.span, thrown=name, within=example)
        return True

    def _report_late_arms(self, statement: ir.If) -> None:
        """`IF(DISTANCE < 60) … ELSEIF(DISTANCE < 20)`: any distance below 20 is below 60, too."""
        widest_comparisons: dict[
            tuple[str, str], Comparison
        ] = {}  # keyed by sensor and direction of the comparison
        for k, arm in enumerate(statement.arms[:_MAX_ARMS]):
            comparison = self._comparison(arm.condition)
            if comparison is None or comparison.op not in _SIDE_BY_COMPARATOR:
                continue
            key = (comparison.device.name, _SIDE_BY_COMPARATOR[comparison.op])
            wider_comparison = widest_comparisons.get(key)
            if wider_comparison is None or not _is_within(comparison, wider_comparison):
                widest_comparisons[key] = comparison
            elif k:
                self._context.report(codes.LATE_ARM, arm.span, wide=str(wider_comparison),
                                     narrow=str(comparison))  # fmt: skip

    def _report_known(self, comparison: Comparison, span: Span) -> bool:
        """Warn where the answer is known: `LIGHT_L > 5000`, of a sensor that goes up to 1023."""
        device = comparison.device
        answer = answer_of(comparison)
        if answer:
            self._context.report(
                codes.KNOWN_ANSWER,
                span,
                sensor=device.name,
                low=as_text(device.low),
                high=as_text(device.high),
                answer=answer,
            )
        return bool(answer)

    def _report_known_of_both(self, condition: ir.Expression, span: Span) -> None:
        """`DISTANCE < 10 AND DISTANCE > 40`: no distance is both, and OR was meant."""
        answer, intended_condition = answer_of_both(condition, self._kit)
        if answer:
            self._context.report(codes.KNOWN_ANSWER, span, answer=answer, either=intended_condition)

    def _report_subtracted(self, condition: ir.Expression, span: Span) -> None:
        """`DISTANCE = 5-20`: no distance is -15, and between is asked with two signs."""
        ops = [term.op for term in condition]
        if ops != ["SENSOR", "NUMBER", "NUMBER", "SUB", "EQ"]:
            return
        device = self._kit.readings[condition[0].value]
        first, second = (term.value for term in condition[1:3])
        if not device.is_yes_no and first - second < device.low <= first < second <= device.high:
            name, low, high = device.name, as_text(device.low), as_text(device.high)
            range_condition = f"{name} > {as_text(first)} AND {name} < {as_text(second)}"
            self._context.report(codes.KNOWN_ANSWER, span, sensor=name, low=low, high=high,
                                 answer="answer_no", between=range_condition)  # fmt: skip

    def _report_exact(self, comparison: Comparison, span: Span, word: str, fix: str) -> None:
        device, op, number = comparison
        if op == "EQ" and is_one_of_many(device, number):
            self._context.report(codes.EXACT, span, sensor=device.name, number=as_text(number),
                         word=word, fix=fix)  # fmt: skip

    # -- what is in them ----------------------------------------------------------------------

    def _comparison(self, condition: ir.Expression) -> Comparison | None:
        return comparison_of(condition, self._kit)

    def _condition_of_sensors(
        self, condition: ir.Expression, sensor_of_variable: Mapping[str, str]
    ) -> ir.Expression:
        """Return a condition that asks the sensors in place of the variables that hold them."""
        numbers = {device.name: k for k, device in enumerate(self._kit.readings)}
        return tuple(
            ir.Term("SENSOR", numbers[sensor_of_variable[self._program.variables[term.value]]])
            if term.op == "VARIABLE"
            else term
            for term in condition
        )

    def _condition_text(
        self,
        condition: ir.Expression,
        sensor_of_variable: Mapping[str, str],
        span: Span,
        word: str,
        direction: str = "",
    ) -> str:
        """Return the condition's text after `word`, with each variable replaced by the sensor it
        was read from.

        Return "" if there is none to write, as when a move in this direction never makes it true.
        """
        sensor_condition = self._condition_of_sensors(condition, sensor_of_variable)
        is_usable = is_usable_in_until(sensor_condition, direction, self._kit)
        text = self._context.condition_text(span, word)
        if not is_usable and (is_usable is not None or direction):
            return ""
        return re.sub(
            r"[A-Za-z_]\w*", lambda match: sensor_of_variable.get(match[0].upper(), match[0]), text
        )


def _opposite(op: str) -> str:
    """Return the comparison that is TRUE when the other is not."""
    return BINARY[OPPOSITES[SIGN_OF[op]]][1]


def _duration_ms(statement: ir.Statement) -> int:
    """Return the duration of a timed move, or 0 if unknown."""
    if not isinstance(statement, ir.Move) or statement.unit:
        return 0
    return known_value(statement.time) or 0


def _runs_once(loop: ir.Loop | ir.While) -> bool:
    times = loop.times if isinstance(loop, ir.Loop) else None
    return known_value(times) == 1000


def _round_statements(loop: ir.Loop | ir.While) -> list[ir.Statement]:
    """Return the statements of a loop that no IF is around."""
    statements: list[ir.Statement] = []
    loops_left: list[ir.Loop | ir.While] = [loop]
    while loops_left:
        for statement in loops_left.pop().body:
            statements.append(statement)
            if isinstance(statement, (ir.Loop, ir.While)):
                loops_left.append(statement)
    return statements


def _variables(condition: ir.Expression) -> list[int]:
    return [term.value for term in condition if term.op == "VARIABLE"]


def _sensors(condition: ir.Expression) -> set[int]:
    return {term.value for term in condition if term.op == "SENSOR"}


def _is_within(narrower_comparison: Comparison, wider_comparison: Comparison) -> bool:
    """Return whether one comparison implies the other; their signs have the same direction."""
    if narrower_comparison.number == wider_comparison.number:
        return narrower_comparison.op == wider_comparison.op or wider_comparison.op in ("LE", "GE")
    return (narrower_comparison.number < wider_comparison.number) == (
        _SIDE_BY_COMPARATOR[wider_comparison.op] == "below"
    )
