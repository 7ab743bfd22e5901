"""Warns of conditions whose answer does not come: nothing changes it, or it never comes exactly.

`D = DISTANCE; F(5, 60) UNTIL(D < 20)`, `N = 0; WHILE(N < 3)` without `N = N + 1`,
`F(5, 60) UNTIL(DISTANCE > 20)`, `UNTIL(DISTANCE = 20)`. Knows the IR, before it is optimised, and
the text of the conditions.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping

from tiniscript.base.fixed_point import as_text
from tiniscript.base.kit import Kit
from tiniscript.base.source import Source, Span
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Code, Diagnostic
from tiniscript.semantics import ir
from tiniscript.semantics.comparisons import (
    TIME,
    Comparison,
    answer_of,
    answer_of_both,
    comes_true,
    comparison,
    is_between,
    looks_ahead,
)
from tiniscript.semantics.optimizer import known_value
from tiniscript.semantics.written_conditions import written_condition
from tiniscript.syntax.operators import SIGN_OF

SHORT = 1000  # ms: a loop looks again after so long
_CHANGING = frozenset(("SENSOR", "TIME", "RANDOM"))
# By the way that the robot goes, what is true where the robot stands, and what comes true.
_TURNED = {"F": {"GT": "LT", "GE": "LE"}, "B": {"LT": "GT", "LE": "GE"}}
_WAYS = {"LT": "below", "LE": "below", "GT": "above", "GE": "above"}
_MOST_ARMS = 50  # of an IF whose conditions are compared
_REACHED = {"F": "LE", "B": "GE"}  # what is sure to come true, by the way that the robot goes


def _is_endless(loop: ir.Loop | ir.While) -> bool:
    """Whether a loop counts nothing: what counts may do what was decided before it."""
    return not isinstance(loop, ir.Loop) or loop.times is None


class InvariantConditions:
    """Looks at the statements of one program; `found` are its warnings."""

    def __init__(self, program: ir.Program, kit: Kit, source: Source) -> None:
        self._program = program
        self._kit = kit
        self._source = source
        self._set_to: dict[int, list[ir.Expression]] = {}
        for statement in ir.every(program):
            if isinstance(statement, ir.Assign):
                self._set_to.setdefault(statement.variable, []).append(statement.value)
        # By a loop's start, the variables that get a value in it; None where it takes no time.
        self._in_loops: dict[int, set[int] | None] = {}
        self._used: dict[int, set[ir.Term]] = {}  # by a loop's start
        self._sets: list[set[int]] = []  # for each DEF, the variables that it gives a value
        for procedure in program.procedures:
            self._sets.append(self._set_in(procedure.body))
        self.found: list[Diagnostic] = []

    def look_at(
        self,
        statement: ir.Statement,
        is_repeated: bool,
        asked: Collection[int],
        outermost: ir.Loop | ir.While | None,
    ) -> None:
        """Look at one statement.

        It is in a loop or a DEF where `is_repeated`; `outermost` is the loop around all others. The
        conditions around it ask the sensors `asked`: an answer may be known there.
        """
        if isinstance(statement, ir.Move) and statement.until is not None:
            self._until(statement, statement.until.condition, is_repeated, asked)
        elif isinstance(statement, ir.While):
            self._while(statement)
            head = Span(statement.span.start, statement.span.start + len("WHILE"))
            if compared := self._comparison(statement.condition):
                self._known(compared, head)
            self._known_of_both(statement.condition, head)
        elif isinstance(statement, ir.Show) and outermost is not None:
            self._frozen_show(statement, outermost)
        elif isinstance(statement, ir.If):
            self._late_arms(statement)
            for arm in statement.arms:
                self._subtracted(arm.condition, arm.span)
                self._known_of_both(arm.condition, arm.span)
                compared = self._comparison(arm.condition)
                if compared and not self._known(compared, arm.span):
                    self._exact(compared, arm.span, "IF", "")
                if outermost is not None and _is_endless(outermost):
                    self._frozen_if(arm, outermost)

    # -- UNTIL --------------------------------------------------------------------------------

    def _until(
        self, move: ir.Move, condition: ir.Expression, is_repeated: bool, asked: Collection[int]
    ) -> None:
        self._known_of_both(condition, move.span)
        variables = _variables(condition)
        if variables and not any(term.op in _CHANGING for term in condition):
            time = known_value(move.time)
            if not (is_repeated and time is not None and time < SHORT):
                self._frozen(move, condition, variables)
            return
        compared = self._comparison(condition)
        if compared is None or self._known(compared, move.span):
            self._subtracted(condition, move.span)
            return
        device, op, number = compared
        is_ahead = looks_ahead(device)
        is_turned = op in _TURNED.get(move.direction, {}) and is_ahead
        if is_turned and not set(asked) & _sensors(condition):
            turned = compared._replace(op=_TURNED[move.direction][op])
            other = "" if answer_of(turned) else self._with(move, str(turned))
            is_forward = move.direction == "F"
            number_is, repair = ("number", "fix") if is_forward else ("far", "away")
            values = {"sensor": device.name, number_is: as_text(number), repair: other}
            self.found.append(Diagnostic(codes.TURNED_ROUND, move.span, values))
        else:
            reached = "GE" if device is TIME else _REACHED.get(move.direction, "")
            written = f"{device.name} {SIGN_OF.get(reached, '')} {as_text(number)}"
            is_sure = bool(reached) and (is_ahead or device is TIME)
            fix = self._with(move, written) if is_sure else ""
            self._exact(compared, move.span, "UNTIL", fix)

    def _frozen(self, move: ir.Move, condition: ir.Expression, variables: list[int]) -> None:
        held = self._sensors_of(variables)
        name = self._program.variables[variables[0]]
        sign = ">" if move.direction == "B" else "<"
        values = {"name": name, "fix": "", "example": f"UNTIL(DISTANCE {sign} 20)"}
        if held:
            values["sensor"] = held[name]
            asked = self._asking(condition, held, move.span, "UNTIL", move.direction)
            values["fix"] = self._with(move, asked) if asked else ""
        self.found.append(Diagnostic(codes.FROZEN_UNTIL, move.span, values))

    def _with(self, move: ir.Move, written: str) -> str:
        """Return a move as it is written, with another condition behind UNTIL."""
        text = self._source[move.span]
        end = max((each.start() for each in re.finditer(r"(?i)\bUNTIL\b", text)), default=0)
        return f"{text[:end].rstrip()} UNTIL({written})" if end else ""

    # -- WHILE and IF -------------------------------------------------------------------------

    def _while(self, loop: ir.While) -> None:
        condition = loop.condition
        variables = _variables(condition)
        if not variables or any(term.op in _CHANGING for term in condition):
            return
        if (
            len(condition) == 1
            or ir.loops_end(loop.body)
            or self._set_in(loop.body) & set(variables)
        ):
            return
        held = self._sensors_of(variables)
        if not held and condition[-1].op not in ("LT", "LE", "GT", "GE", "NE"):
            return  # `WHILE(ON = 1)` is how others write LOOP(FOREVER)
        name = self._program.variables[variables[0]]
        head = Span(loop.span.start, loop.span.start + len("WHILE"))
        values = {"name": name, "fix": ""}
        if held:
            values["sensor"] = held[name]
            asked = self._asking(condition, held, loop.span, "WHILE")
            values["fix"] = f"WHILE({asked})" if asked else ""
        elif [term.op for term in condition[:-1]] == ["VARIABLE", "NUMBER"]:
            is_down = condition[-1].op in ("GT", "GE")
            values["step"] = f"{name} = {name} {'-' if is_down else '+'} 1"
        self.found.append(Diagnostic(codes.FROZEN_WHILE, head, values))

    def _set_in(self, body: ir.Body) -> set[int]:
        """Return the variables that a body, or a DEF that it calls, gives a value."""
        found = set()
        for statement in ir.walk(body):
            if isinstance(statement, ir.Assign):
                found.add(statement.variable)
            elif isinstance(statement, ir.Call) and statement.procedure < len(self._sets):
                found |= self._sets[statement.procedure]
        return found

    def _frozen_if(self, arm: ir.Arm, outermost: ir.Loop | ir.While) -> None:
        """`D = DISTANCE; LOOP(FOREVER); IF(D < 20) …`: it moves, and looks at what was before."""
        variables = _variables(arm.condition)
        held = self._held_in(outermost, variables)
        if not held or any(term.op in _CHANGING for term in arm.condition):
            return
        name = self._program.variables[variables[0]]
        word = "IF" if self._source[arm.span][:1].upper() == "I" else "ELSEIF"
        asked = self._asking(arm.condition, held, arm.span, word)
        fix = f"{word}({asked})" if asked else ""
        self._report(codes.FROZEN_WHILE, arm.span, name=name, sensor=held[name], fix=fix)

    def _frozen_show(self, show: ir.Show, outermost: ir.Loop | ir.While) -> None:
        """`D = DISTANCE; LOOP(5); SHOW(D); W(1); END_LOOP`: each round shows the same."""
        variables = _variables(show.value) if len(show.value) == 1 else []
        if variables and self._thrown_once(show, variables[0], outermost):
            return
        held = self._held_in(outermost, variables)
        if not held:
            return
        name = self._program.variables[variables[0]]
        sensor = next(k for k, each in enumerate(self._kit.readings) if each.name == held[name])
        used = self._used_in(outermost)
        if {ir.Term("SENSOR", sensor), ir.Term("VARIABLE", variables[0])} & used:
            return  # it is shown beside what is measured now, or the rounds need it
        fix = f"SHOW({held[name]})"
        self._report(codes.FROZEN_WHILE, show.span, name=name, sensor=held[name], fix=fix)

    def _thrown_once(self, show: ir.Show, variable: int, loop: ir.Loop | ir.While) -> bool:
        """`DICE = RANDOM(1, 6); LOOP(5); SHOW(DICE); END_LOOP`: five times the same number.

        It is said where the loop shows it in each round, shows nothing else that changes, and
        where the number is there for nothing else.
        """
        sets = [
            each
            for each in self._program.body
            if isinstance(each, ir.Assign) and each.variable == variable
        ]
        if len(sets) != 1 or self._set_to[variable] != [sets[0].value]:
            return False
        if all(term.op != "RANDOM" for term in sets[0].value) or _goes_once(loop):
            return False
        term = ir.Term("VARIABLE", variable)
        is_only_shown = all(
            isinstance(each, ir.Show)
            for each in ir.every(self._program)
            if any(term in expression for expression in ir.expressions(each))
        )
        shown = {
            term for each in ir.walk(loop.body) if isinstance(each, ir.Show) for term in each.value
        }
        others = [each for each in shown if each.op in _CHANGING or each.op == "VARIABLE"]
        is_before = sets[0].span.end <= loop.span.start
        if not (is_before and is_only_shown and others == [term] and show in _each_round(loop)):
            return False
        name, said = self._program.variables[variable], self._source[sets[0].span]
        if not any(each.values.get("thrown") == name for each in self.found):
            within = f"{said};{self._source[show.span]}"
            self._report(codes.FROZEN_WHILE, show.span, thrown=name, within=within)
        return True

    def _held_in(self, loop: ir.Loop | ir.While, variables: list[int]) -> dict[str, str]:
        """Return `_sensors_of` where a loop drives and gives none of the variables a value."""
        place = loop.span.start
        if place not in self._in_loops:
            drives = any(isinstance(each, (ir.Move, ir.Motors)) for each in ir.walk(loop.body))
            self._in_loops[place] = self._set_in(loop.body) if drives else None
        changed = self._in_loops[place]
        is_held = changed is not None and not changed & set(variables)
        return self._sensors_of(variables) if is_held else {}

    def _used_in(self, loop: ir.Loop | ir.While) -> set[ir.Term]:
        """Return the terms of a loop: all sensors, and what statements other than SHOW use."""
        place = loop.span.start
        if place not in self._used:
            self._used[place] = {
                term
                for each in ir.walk((loop,))
                for expression in ir.expressions(each)
                for term in expression
                if term.op == "SENSOR" or not isinstance(each, ir.Show)
            }
        return self._used[place]

    def _late_arms(self, statement: ir.If) -> None:
        """`IF(DISTANCE < 60) … ELSEIF(DISTANCE < 20)`: what is below 20 is below 60, too."""
        widest: dict[tuple[str, str], Comparison] = {}  # by sensor and the way of the sign
        for k, arm in enumerate(statement.arms[:_MOST_ARMS]):
            compared = self._comparison(arm.condition)
            if compared is None or compared.op not in _WAYS:
                continue
            key = (compared.device.name, _WAYS[compared.op])
            before = widest.get(key)
            if before is None or not _is_within(compared, before):
                widest[key] = compared
            elif k:
                self._report(codes.LATE_ARM, arm.span, wide=str(before),
                             narrow=str(compared))  # fmt: skip

    def _known(self, compared: Comparison, span: Span) -> bool:
        """Warn where the answer is known: `LIGHT_L > 5000`, of a sensor that goes up to 1023."""
        device = compared.device
        answer = answer_of(compared)
        if answer:
            self._report(codes.KNOWN_ANSWER, span, sensor=device.name, low=as_text(device.low),
                         high=as_text(device.high), answer=answer)  # fmt: skip
        return bool(answer)

    def _known_of_both(self, condition: ir.Expression, span: Span) -> None:
        """`DISTANCE < 10 AND DISTANCE > 40`: no distance is both, and OR was meant."""
        answer, meant = answer_of_both(condition, self._kit)
        if answer:
            self._report(codes.KNOWN_ANSWER, span, answer=answer, either=meant)

    def _subtracted(self, condition: ir.Expression, span: Span) -> None:
        """`DISTANCE = 5-20`: no distance is -15, and between is asked with two signs."""
        asked = [term.op for term in condition]
        if asked != ["SENSOR", "NUMBER", "NUMBER", "SUB", "EQ"]:
            return
        device = self._kit.readings[condition[0].value]
        first, second = (term.value for term in condition[1:3])
        if not device.is_yes_no and first - second < device.low <= first < second <= device.high:
            name, low, high = device.name, as_text(device.low), as_text(device.high)
            between = f"{name} > {as_text(first)} AND {name} < {as_text(second)}"
            self._report(codes.KNOWN_ANSWER, span, sensor=name, low=low, high=high,
                         answer="answer_no", between=between)  # fmt: skip

    def _exact(self, compared: Comparison, span: Span, word: str, fix: str) -> None:
        device, op, number = compared
        if op == "EQ" and is_between(device, number):
            self._report(codes.EXACT, span, sensor=device.name, number=as_text(number),
                         word=word, fix=fix)  # fmt: skip

    # -- what is in them ----------------------------------------------------------------------

    def _comparison(self, condition: ir.Expression) -> Comparison | None:
        return comparison(condition, self._kit)

    def _asking(
        self, condition: ir.Expression, held: Mapping[str, str], span: Span, word: str,
        direction: str = "",
    ) -> str:  # fmt: skip
        """Return a condition as it is written behind `word`, asking the sensors themselves.

        Nothing where it is none to write, as where a move in this direction never makes it true.
        """
        numbers = {device.name: k for k, device in enumerate(self._kit.readings)}
        asking = tuple(
            ir.Term("SENSOR", numbers[held[self._program.variables[term.value]]])
            if term.op == "VARIABLE"
            else term
            for term in condition
        )
        comes = comes_true(asking, direction, self._kit)
        written = written_condition(self._source, span, word)
        if not comes and (comes is not None or direction):
            return ""
        return re.sub(r"[A-Za-z_]\w*", lambda it: held.get(it[0].upper(), it[0]), written)

    def _sensors_of(self, variables: list[int]) -> dict[str, str]:
        """Return the sensor that each of these variables holds; nothing where one holds another."""
        held = {}
        for variable in variables:
            values = set(self._set_to.get(variable, ()))
            value = next(iter(values)) if len(values) == 1 else ()
            if len(value) != 1 or value[0].op != "SENSOR":
                return {}
            name = self._program.variables[variable]
            held[name] = self._kit.readings[value[0].value].name
        return held

    def _report(self, code: Code, span: Span, **values: str) -> None:
        self.found.append(Diagnostic(code, span, values))


def _goes_once(loop: ir.Loop | ir.While) -> bool:
    times = loop.times if isinstance(loop, ir.Loop) else None
    return known_value(times) == 1000


def _each_round(loop: ir.Loop | ir.While) -> list[ir.Statement]:
    """Return the statements of a loop that no IF is around."""
    found: list[ir.Statement] = []
    rest: list[ir.Loop | ir.While] = [loop]
    while rest:
        for each in rest.pop().body:
            found.append(each)
            if isinstance(each, (ir.Loop, ir.While)):
                rest.append(each)
    return found


def _variables(condition: ir.Expression) -> list[int]:
    return [term.value for term in condition if term.op == "VARIABLE"]


def _sensors(condition: ir.Expression) -> set[int]:
    return {term.value for term in condition if term.op == "SENSOR"}


def _is_within(narrow: Comparison, wide: Comparison) -> bool:
    """Whether one comparison is true only where the other one is; their signs go the same way."""
    if narrow.number == wide.number:
        return narrow.op == wide.op or wide.op in ("LE", "GE")
    return (narrow.number < wide.number) == (_WAYS[wide.op] == "below")
