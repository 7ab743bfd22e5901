"""Diagnoses wrong values: an unknown name, a number instead of a yes or no.

Knows the names of the program and the text around a value. `types` knows which values are right,
and asks here about the others.
"""

from __future__ import annotations

import re

from tiniscript.base.source import Span
from tiniscript.base.words import OPPOSITE_MOVES, WORDS
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import MAX_DIAGNOSTICS
from tiniscript.recovery.amounts import amount_values, is_amount
from tiniscript.recovery.meanings import certain_concept, lexicon_meaning
from tiniscript.semantics.comparisons import is_aside
from tiniscript.semantics.named_values import value_of, yes_no_of
from tiniscript.semantics.symbols import NUMBER, Operand, Scope
from tiniscript.semantics.unknown_words import whole_name
from tiniscript.syntax.ast import Def, Part
from tiniscript.syntax.operators import SIGN_OF

_EQUALITY_OPS = frozenset(("EQ", "NE"))
_COMPARISON = re.compile(r"\w+\s*((?:<=|>=|<>|[<>=])\s*[\w.]+)")  # `> 5` of `X > 5`
_LEADING_COMPARISON = re.compile(
    r"[^<>=]{1,40}?\s*(?:<=|>=|<>|[<>=])(?=[^<>=]*$)"
)  # `X =` of `X = 5`
_MAX_CHARACTERS_BACK = 20  # characters before a name in which its word is looked for
_EQUALITY_AT_END = re.compile(r"(\w+)\s*(?:=|<>)\s*$")  # `BUTTON = ` of `BUTTON = HIGH`
_BEFORE_LOOP_COUNT = re.compile(r"(?i)\bLOOP[ \t]*\([ \t]*$")
_BEFORE_FREQUENCY = re.compile(r"(?i)\bBEEP[ \t]*\([^(),]*,[ \t]*$")
_DIGITS = "0123456789"
_BEFORE_TIME = re.compile(r"(?i)\b(?:[FBLRW]|BEEP)[ \t]*\([ \t]*$")  # the time comes first


class WrongValues:
    def __init__(self, scope: Scope) -> None:
        self.scope = scope

    def report_unknown(self, part: Part, name: str, target: str | None) -> None:
        scope, span = self.scope, Span(part.start, part.end)
        if name in scope.def_names:
            scope.report(codes.NO_VALUE, span, word=name)
            return
        concept = certain_concept(name) or ""
        text_before = scope.source.text[max(0, span.start - _MAX_CHARACTERS_BACK) : span.start]
        is_variable = concept == "TIME" and _BEFORE_TIME.search(text_before) is not None
        if concept == "BUTTON" or name == "BUTTON":
            scope.report(codes.NO_BUTTON, span)
            return
        is_free = name != target and name not in scope.assigned_names
        amount_values = self._amount_values(span, name) if is_free else {}
        if amount_values:
            if not self._has_example(span):
                scope.report(codes.UNKNOWN_NAME, span, None, found=name, **amount_values)
            return
        names = scope.names.items() if len(scope.diagnostics) < MAX_DIAGNOSTICS else ()
        known_names = [
            known_name for known_name, meaning in names if meaning.kind in ("sensor", "variable")
        ]
        is_forever = _BEFORE_TIME.search(text_before) or _BEFORE_LOOP_COUNT.search(text_before)
        known_names += ["FOREVER"] if is_forever else []
        suggestion = "".join(lexicon_meaning(name, "number")) or scope.nearest_word(
            name, known_names
        )
        suggestion = suggestion or (
            "".join(lexicon_meaning(name, "power")) if text_before.rstrip().endswith("=") else ""
        )
        suggestion = suggestion or whole_name(scope, name, scope.assigned_names)
        if (match := _EQUALITY_AT_END.search(text_before)) and scope.is_yes_no_sensor(
            match[1].upper()
        ):
            suggestion = yes_no_of(name) or suggestion
        base = name.rstrip(_DIGITS).rstrip("_")  # DISTANCE, of DISTANCE2
        stem = (
            "".join(lexicon_meaning(base, "stem")) or base
        ) + "_"  # `LIGHT` of LIGHT_R and LIGHT_L
        similar_names = [known_name for known_name in known_names if known_name.startswith(stem)]
        pair_hints = (
            {}
            if len(similar_names) != 2
            else {"first": similar_names[0], "second": similar_names[1]}
        )
        sensors = [known_name for known_name, meaning in names if meaning.kind == "sensor"]
        if name == target or name in scope.assigned_names:
            if any(diagnostic.code is codes.USED_BEFORE_SET and diagnostic.values["name"] == name
                   for diagnostic in scope.diagnostics[-MAX_DIAGNOSTICS:]):  # fmt: skip
                return  # reported once
            scope.report_used_before_set(name, span, suggestion)
        else:
            suggestion = "" if pair_hints or is_variable else suggestion
            owner_sensor = next((sensor for sensor in sensors if name.startswith(sensor + "_")), "")
            aside_sensor = owner_sensor if is_aside(name.rpartition("_")[2]) else ""
            alike_name = suggestion if suggestion and suggestion.rstrip(_DIGITS) == base else ""
            suggestion = "" if aside_sensor or alike_name else owner_sensor or suggestion
            hints = {"alike": alike_name} if alike_name and not pair_hints else {}
            has_no_hint = not (suggestion or hints or pair_hints or owner_sensor or is_variable)
            if (
                has_no_hint
                and self._is_compared(span)
                and (side_sensor := self._sensor_on_side(concept))
            ):
                suggestion = side_sensor
            elif has_no_hint and concept in OPPOSITE_MOVES:
                hints = {"way": concept, "call": WORDS[concept].example}
            elif (
                has_no_hint
                and lexicon_meaning(name + "4", "note")
                and _BEFORE_FREQUENCY.search(text_before)
            ):
                hints = {"pitch": lexicon_meaning(name + "4", "note")[0]}
            elif not pair_hints and not is_variable and lexicon_meaning(name, "unsensed"):
                sensor_names = ", ".join(sensor.name for sensor in scope.kit.sensors)
                hints, suggestion = {"unsensed": name, "sensors": sensor_names}, ""
            elif has_no_hint and lexicon_meaning(name, "colour"):
                hints = {"colour": name}
            scope.report(codes.UNKNOWN_NAME, span, None, found=name, near=suggestion,
                         value=value_of(name), only=owner_sensor, aside=aside_sensor, **hints,
                         **pair_hints)  # fmt: skip

    def _is_compared(self, span: Span) -> bool:
        """Return whether a name is next to `<` or `>`."""
        text = self.scope.source.text
        texts_around = text[: span.start].rstrip()[-2:], text[span.end :].lstrip()[:2]
        return any(it in "".join(texts_around) for it in "<>")

    def _sensor_on_side(self, direction: str) -> str:
        """Return the one sensor of the robot on L or R, which measures, "" for none."""
        sensors = [
            sensor.name
            for sensor in self.scope.kit.sensors
            if sensor.name.endswith(f"_{direction}")
        ]
        return sensors[0] if len(sensors) == 1 and direction in OPPOSITE_MOVES else ""

    def _amount_values(self, span: Span, name: str) -> dict[str, str]:
        """Return the call around `poco`, or around the `lento` next to it, with numbers."""
        scope = self.scope
        if not is_amount(name) and not lexicon_meaning(name, "power"):
            return {}
        values = amount_values(scope.source.text, span, scope.assigned_names)
        return values if is_amount(name) or "(" in values.get("example", "") else {}

    def _has_example(self, span: Span) -> bool:
        """Return whether the example for a value of the same call also has a number for this
        one.
        """
        diagnostics = self.scope.diagnostics[-1:]
        if (
            not diagnostics
            or "amount" not in diagnostics[0].values
            or diagnostics[0].span.start > span.start
        ):
            return False
        text_between = self.scope.source[Span(diagnostics[0].span.end, span.start)]
        return not set(text_between) & set("();\r\n") and "," in text_between

    def report_mixed(self, op: str, left: Operand, right: Operand, span: Span) -> None:
        """A number is compared with a yes or no."""
        self.scope.report(codes.MIXED_COMPARE, span, sign=SIGN_OF[op],
                          left="@" + left.type, right="@" + right.type,
                          fix=self._yes_no_alone(op, left, right))  # fmt: skip

    def report_yes_no_order(self, op: str, span: Span) -> None:
        self.scope.report(codes.YES_NO_ORDER, span, sign=SIGN_OF[op])

    def report_not_number(self, op: str, operand: Operand) -> None:
        span = Span(operand.start, operand.end)
        operator_text = "-" if op == "NEG" else SIGN_OF.get(op, op)
        def_hints = hints_of_def(self.scope, span)
        operand_text = self.scope.source[span]
        self.scope.report(
            codes.WANTS_NUMBER, span, None, by=operator_text, found=operand_text, **def_hints
        )

    def report_not_yes_no(self, asker: str, operand: Operand, other: Operand | None) -> None:
        """`other` is the other side of an AND or OR.

        `X = 5 OR 6` means `X = 5 OR X = 6`, and `X AND Y > 5` means `X > 5 AND Y > 5`.
        """
        span = Span(operand.start, operand.end)
        operand_text = self.scope.source[span]
        values = self.condition(span)
        if asker == "NOT" and "example" in values:  # NOT X is `X = 0`, as other languages have it
            values = {**values, "example": f"{operand_text.upper()} > 0"}
        if other is not None and other.end - other.start <= 80:
            compared_text = self.scope.source[Span(other.start, other.end)]
            comparison_before, comparison_after = (
                _LEADING_COMPARISON.match(compared_text),
                _COMPARISON.fullmatch(compared_text),
            )
            is_sensor = operand_text.upper() in (
                reading.name for reading in self.scope.kit.readings
            )
            if other.start < operand.start and comparison_before and not is_sensor:
                values = {"fix": f"{comparison_before[0]} {operand_text}"}
            elif comparison_after and operand_text.isidentifier():
                values = {"fix": f"{operand_text} {comparison_after[1]}"}
        self.scope.report(codes.WANTS_CONDITION, span, None, by=asker, found=operand_text, **values)

    def condition(self, span: Span) -> dict[str, str]:
        """Return the yes or no that a number alone means, or an example of a condition with it."""
        word = self.scope.source[span].upper()
        name = self.scope.names.get(word)
        if name is not None:
            example = f"{word} < 10" if name.kind == "sensor" else f"{word} > 0"
            return {"example": example, **hints_of_def(self.scope, span)}
        truth_word = {"0": "FALSE", "1": "TRUE"}.get(word)
        if truth_word or not word.isdecimal():
            return {"fix": truth_word} if truth_word else {}
        names = {device.name for device in self.scope.kit.sensors if not device.is_yes_no}
        sensor = "DISTANCE" if "DISTANCE" in names else "X"
        return {"times": word, "example": f"{sensor} < {word}"}

    def _yes_no_alone(self, op: str, left: Operand, right: Operand) -> str:
        """`BUTTON = 1` is `BUTTON`, and `BUTTON = 0` is `NOT BUTTON`."""
        number, answer = (left, right) if left.type == NUMBER else (right, left)
        digit = self.scope.source[Span(number.start, number.end)]
        answer_text = self.scope.source[Span(answer.start, answer.end)]
        if digit not in ("0", "1") or op not in _EQUALITY_OPS or not answer_text.isidentifier():
            return ""
        return (
            answer_text.upper() if (digit == "1") == (op == "EQ") else f"NOT {answer_text.upper()}"
        )


def hints_of_def(scope: Scope, span: Span) -> dict[str, str]:
    """Return the value at `span` and its DEF, whose first call says what it is; or nothing."""
    name = scope.source[span].upper()
    for node in scope.parsed_program.body:
        if isinstance(node, Def) and node.span.start < span.start < node.span.end:
            is_parameter = any(parameter.name == name for parameter in node.parameters)
            return {"own": name, "called": node.name} if is_parameter else {}
    return {}
