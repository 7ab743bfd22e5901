"""Diagnoses wrong instructions: the word, the number of values, a number out of range.

Knows the program up to there. The checker knows which instructions are right, and asks here about
the others.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import islice
from typing import TYPE_CHECKING

from tiniscript.base.fixed_point import HIGHEST, as_text
from tiniscript.base.kit import Device
from tiniscript.base.source import Edit, Source, Span
from tiniscript.base.words import (
    OPPOSITE_MOVES,
    POWER,
    TIME,
    UNIT_OF,
    VALUE,
    Argument,
    Word,
)
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import MAX_DIAGNOSTICS, Diagnostic, Repair
from tiniscript.semantics import ir
from tiniscript.semantics.comparisons import looks_ahead
from tiniscript.semantics.driven_on import find_move_end
from tiniscript.semantics.left_out import rewrite_without_break
from tiniscript.semantics.named_values import yes_no_of
from tiniscript.semantics.symbols import Name, Scope
from tiniscript.semantics.unknown_words import (
    report_not_callable,
    report_placeholders,
    report_unknown,
    report_words_shown,
)
from tiniscript.semantics.wrong_values import hints_of_def
from tiniscript.syntax import ast
from tiniscript.syntax.free_names import numbered_names

if TYPE_CHECKING:
    from tiniscript.semantics.task_copies import Excess

_MOVE_WITH_UNIT = re.compile(r"(?i)\b([FBLR])[ \t]*\([ \t]*(\w+)[ \t]*(CM|DEG)\b")  # `F(20 DEG`
# How a condition ends an instruction, by the role of its word.
_REPEATED_CALL = "WHILE(NOT ({c}));{call};END_WHILE"
_UNTIL_REPAIR_BY_ROLE = {"motors": "{call};W(FOREVER) UNTIL({c});S",
          **dict.fromkeys(("stop", "actuator"), "{call};W(FOREVER) UNTIL({c})"),
          **dict.fromkeys(("show", "def"), _REPEATED_CALL)}  # fmt: skip
_LONG_TIME_S = 20  # longer moves are rarely meant: the number is a power, degrees or steps
_LOWEST_HERTZ = 30
_HIGHEST_POWER = 100
_TIME_AND_POWER = (0, 1)  # their places
_NUMBER = re.compile(r"[0-9]+(\.[0-9]+)?|\.[0-9]+")
_UNTIL_CLAUSE = re.compile(r"(?i)\s*\bUNTIL\b.*")  # an UNTIL with its condition
_UNTIL_AT_END = re.compile(r"(?i)\bUNTIL[ \t]*(\([^()\n;]+\))[\s;]*$")
_MAX_CHARACTERS_BACK = 200
_FEW_TIMES = [str(k) for k in range(2, 10)]  # numbers small enough to be repetitions or seconds
_NAMED_VALUE = re.compile(r"(\w+)\s*=\s*([^=].*)")  # `size=20`
# For each sensor's unit, the unit of a move of that size, and the factor.
_MOVE_UNIT_BY_SENSOR_UNIT = {
    "cm": ("CM", Fraction(1)),
    "mm": ("CM", Fraction(1, 10)),
    "m": ("CM", Fraction(100)),
    "°": ("DEG", Fraction(1)),
    "deg": ("DEG", Fraction(1)),
}


class WrongCalls:
    def __init__(self, scope: Scope) -> None:
        self.scope = scope
        self._free_names: dict[str, tuple[Iterator[str], list[str]]] = {}  # see `free_name`

    def report_unknown(self, node: ast.Command, def_name: str | None) -> None:
        report_unknown(self.scope, node, def_name)

    def report_not_callable(self, node: ast.Command) -> None:
        report_not_callable(self.scope, node)

    def report_value_count(
        self, node: ast.Command, procedure: ir.Procedure, names: Sequence[str]
    ) -> None:
        """Another count of values than the DEF has names."""
        if not names:
            report_not_callable(self.scope, node)
            return
        usage = f"{node.word}({', '.join(names)})"
        self.scope.report(codes.CALL_VALUES, node.span, name=node.word, usage=usage,
                          wanted=str(len(names)), found=str(len(node.arguments or ())))  # fmt: skip

    def report_too_many_copies(self, program: ir.Program, excess: Excess) -> None:
        """A DEF with values is compiled once for each task that reaches it."""
        procedure = program.procedures[excess.procedure]
        span = Span(procedure.span.start, procedure.span.start + len("DEF"))
        block_starts = [program.body[0].span, *(task.span for task in program.tasks)]
        lines = [self.scope.source.position(block_starts[k].start)[0] for k in excess.tasks]
        values = {
            "count": str(len(lines)),
            excess.resource: str(excess.total),
            "limit": str(excess.limit),
        }
        if len({*lines}) > 1:
            values["lines"] = ", ".join(map(str, sorted({*lines})))
        self.scope.report(codes.TOO_MANY_COPIES, span, None, name=procedure.name, **values)

    def report_until_not_here(
        self, node: ast.Command, until: ast.Argument, word: Word | None
    ) -> None:
        source = self.scope.source
        start = _until_offset(source, node, until)
        call = source[Span(node.span.start, start)].rstrip()
        own_name = self.scope.names.get(node.word)
        role = word.role.name if word else own_name.kind if own_name else "def"
        is_act = word is not None and word.is_call and not word.expansion
        template = _UNTIL_REPAIR_BY_ROLE.get(
            role, _REPEATED_CALL if is_act else "F(5, 60) UNTIL({c})"
        )
        example = template.format(call=call, c=source[until.span])
        until_span = Span(start, node.span.end)
        self.scope.report(codes.UNTIL_NOT_HERE, until_span, word=node.word, example=example)

    def report_break_outside(self, node: ast.Break) -> None:
        """BREAK as the last of a branch of an IF: the other branch has what it leaves out."""
        rewritten_if = rewrite_without_break(self.scope.source, self.scope.parsed_program, node)
        if rewritten_if is None:
            self.scope.report(codes.BREAK_OUTSIDE, node.span)
            return
        values = {"fix": rewritten_if.text}
        repair = Repair(rewritten_if.edits, False)
        self.scope.diagnostics.append(
            Diagnostic(codes.BREAK_OUTSIDE, node.span, values, None, repair)
        )

    def report_forever(self, span: Span, word: Word, node: ast.Command) -> None:
        """FOREVER at `span` in a move without UNTIL."""
        source = self.scope.source
        fix = f"{source[node.span]} UNTIL({next_condition(source, node.span)})"
        values = {"fix": fix, **find_move_end(source, self.scope.parsed_program, node)}
        self.scope.report(codes.FOREVER_NEEDS_UNTIL, span, None, word=word.text, **values)

    def report_count(self, word: Word, arguments: Sequence[ast.Argument], span: Span) -> None:
        source = self.scope.source
        texts = [source[argument.span] for argument in arguments]
        values = {
            "usage": word.usage,
            "example": "" if texts else word.example,
            **_count_values(texts, word, _until_match(source, span)),
            **self._extent_values(texts, word),
            "wanted": str(len(word.arguments)),
            "found": str(len(arguments)),
        }
        self.scope.report(codes.ARGUMENT_COUNT, span, None, word=word.text, **values)

    def _extent_values(self, texts: Sequence[str], word: Word) -> dict[str, str]:
        """`R(90)`, `F(30)`: what the one value is, if it is no power."""
        unit = UNIT_OF.get(word.text, "")
        is_one_number = (
            len(texts) == 1 and _NUMBER.fullmatch(texts[0]) and float(texts[0]) >= _LONG_TIME_S
        )
        if not (unit and self._knows_speed(unit) and is_one_number):
            return {}
        extent_call = f"{word.text}({texts[0]} {unit}, {POWER.sample})"
        return {"number": texts[0], "turn" if unit == "DEG" else "way": extent_call}

    def report_unit_pair(self, node: ast.Command, unit: ast.Part) -> None:
        """`F(20 DEG, 60)`: forward goes centimetres."""
        right_unit, unit_span = UNIT_OF[node.word], Span(unit.start, unit.end)
        start = node.span.start
        span_before, span_after = Span(start, unit.start), Span(unit.end, node.span.end)
        fix = f"{self.scope.source[span_before]}{right_unit}{self.scope.source[span_after]}"
        values = {
            "found": unit.op,
            "right": right_unit,
            "cm": right_unit if right_unit == "CM" else "",
        }
        other_word = "R" if right_unit == "CM" else "F"
        values["other"] = other_word + self.scope.source[node.span][len(node.word) :]
        is_among_first = len(self.scope.diagnostics) < MAX_DIAGNOSTICS
        pairs = _MOVE_WITH_UNIT.finditer(self.scope.source.text) if is_among_first else ()
        wrong_pairs = [match for match in pairs if UNIT_OF[match[1].upper()] != match[3].upper()]
        for pair, other_pair in (wrong_pairs, wrong_pairs[::-1]) if len(wrong_pairs) == 2 else ():
            if (
                pair.start() == start
                and pair[2] != other_pair[2]
                and pair[3].upper() != other_pair[3].upper()
            ):
                text_after = self.scope.source[Span(unit.end, node.span.end)]
                values["swapped"] = f"{node.word}({other_pair[2]} {right_unit}{text_after}"
                values["line"] = str(self.scope.source.position(other_pair.start())[0])
        self.scope.report(codes.UNIT_PAIR, unit_span, node.span, word=node.word, fix=fix, **values)

    def report_values(self, node: ast.Command, word: Word, diagnostic_count: int) -> None:
        """Say more of values that have had diagnostics since there were `diagnostic_count`."""
        if VALUE in word.arguments:
            report_words_shown(self.scope, diagnostic_count)
        report_placeholders(self.scope, node, word, diagnostic_count)

    def report_out_of_range(
        self, span: Span, number: int, spec: Argument, word: str,
        command_and_word: tuple[ast.Command, Word] | None,
    ) -> None:  # fmt: skip
        """`number`, in thousandths, is a value of the command `command_and_word`, if of one."""
        low, high = as_text(spec.low), "" if spec.high == HIGHEST else as_text(spec.high)
        values = (
            {} if command_and_word is None else repair_values(self.scope.source, *command_and_word)
        )
        values |= {"low": low, "high": high, "found": as_text(number)}
        whole_span = (
            None
            if command_and_word is None
            else _span_without_until(self.scope.source, command_and_word[0])
        )
        self.scope.report(codes.OUT_OF_RANGE, span, whole_span, word=word, name=spec.name,
                          unit=spec.unit, **values)  # fmt: skip

    def report_not_number(self, span: Span, word: str) -> None:
        """A yes or no where `word` takes a number."""
        text = self.scope.source[span]
        fix = f"W(FOREVER) UNTIL({text})" if word == "W" and set(text) & set("<>=") else ""
        if word == "LOOP":
            fix = "LOOP(FOREVER)" if text.upper() == "TRUE" else f"WHILE({text})"
        def_hints = hints_of_def(self.scope, span)
        self.scope.report(codes.WANTS_NUMBER, span, None, by=word, found=text, fix=fix, **def_hints)

    def report_device_set(self, node: ast.Assign, device: Name) -> None:
        """`DISTANCE = 20`, `LED = TRUE`: a number for a distance may be where to stop."""
        value = "5" if node.value is None else self.scope.source[node.value.span]
        values = {"name": node.name, "value": value}
        if device.kind == "actuator":
            is_yes_no = self.scope.kit.actuators[device.number].is_yes_no
            values["value"] = (is_yes_no and yes_no_of(value.upper())) or value
            self.scope.report(codes.ACTUATOR_SET, node.name_span, None, **values)
            return
        sensor = self.scope.kit.readings[device.number]
        if _NUMBER.fullmatch(value) and (
            diagnostic := self._travel_diagnostic(node, sensor, value)
        ):
            self.scope.diagnostics.append(diagnostic)
            return
        if value.isdecimal() and looks_ahead(sensor):
            until = f"UNTIL({node.name} < {value})"
            values |= {"until": until, "example": f"F(5, 60) {until}"}
        self.scope.report(codes.SENSOR_SET, node.name_span, None, **values)

    def _travel_diagnostic(self, node: ast.Assign, sensor: Device, value: str) -> Diagnostic | None:
        """`DISTANCE = 90;F(DISTANCE, 80)`: so many centimetres are driven, F(90 CM, 80).

        A move that goes by another unit, or a robot that knows none, gets its own number.
        """
        text, end = self.scope.source.text, node.span.end
        next_match = re.compile(rf"(?i)(?:^|[;|\n])[ \t]*{node.name}[ \t]*=").search(text, end)
        end_offset = next_match.start() if next_match else len(text)
        pattern = re.compile(
            rf"(?i)\b([FBLR])[ \t]*\([ \t]*({node.name}(?:[ \t]+(?:CM|DEG))?)[ \t]*,[^()\n]*\)"
        )
        uses = [*pattern.finditer(text, end, end_offset)]
        unit, factor = _MOVE_UNIT_BY_SENSOR_UNIT.get(sensor.unit.lower(), ("", Fraction()))
        if not uses or not unit:
            return None
        values = {"name": node.name, "value": value, "used": uses[0][0]}
        words = {call_match[1].upper() for call_match in uses}
        other_word = min((word for word in words if UNIT_OF[word] != unit), default="")
        if other_word or not self._knows_speed(unit):
            values |= {"word": other_word or min(words), "unit": unit}
            if other_word and self._knows_speed(UNIT_OF[other_word]):
                call_match = next(
                    call_match for call_match in uses if call_match[1].upper() == other_word
                )
                values |= {
                    "used": call_match[0],
                    "other": _with_first_value(call_match, f"{value} {UNIT_OF[other_word]}"),
                }
            return Diagnostic(codes.SENSOR_SET, node.name_span, values)
        extent = f"{as_text(int(Fraction(value) * factor * 1000))} {unit}"
        if len({call_match[0] for call_match in uses}) > 1:
            values["ways"] = "; ".join(
                dict.fromkeys(_with_first_value(call_match, extent) for call_match in uses)
            )
        edits = [Edit(_span_with_separator(self.scope.source, node.span), "")]
        edits += [Edit(Span(*call_match.span(2)), extent) for call_match in uses]
        values["way"] = _with_first_value(uses[0], extent)
        return Diagnostic(codes.SENSOR_SET, node.name_span, values, None, Repair((*edits,), False))

    def _knows_speed(self, unit: str) -> bool:
        return bool(self.scope.kit.speed if unit == "CM" else self.scope.kit.turn)

    def report_named_values(self, node: ast.Command, names: Sequence[str]) -> bool:
        """Report `SIDE(size=20)`, which names a value of the DEF; return whether it does."""
        texts = [self.scope.source[argument.span] for argument in node.arguments or ()]
        named_matches = [_NAMED_VALUE.fullmatch(text) for text in texts]
        value_of = {match[1].upper(): match[2] for match in named_matches if match}
        unnamed_texts = [
            text for text, match in zip(texts, named_matches, strict=True) if match is None
        ]
        free_names = [name for name in names if name not in value_of]
        if (
            not value_of
            or not value_of.keys() <= {*names} - {*self.scope.names}
            or len(free_names) != len(unnamed_texts)
        ):
            return False
        value_of |= dict(zip(free_names, unnamed_texts, strict=True))
        fix = f"{node.word}({', '.join(value_of[name] for name in names)})"
        self.scope.report(codes.NAMED_ARGUMENT, node.span, None, word=node.word, fix=fix)
        return True

    def report_def_set(self, node: ast.Assign, procedures: Sequence[ir.Procedure]) -> None:
        """`SQUARE = 30`, where SQUARE is a DEF with one value: it is called, if no value is."""
        free_name = self.free_name(node.name, procedures)
        called_def = next(
            (procedure for procedure in procedures if procedure.name == node.name), None
        )
        value_pattern = rf"(?i)[(,=<>+*/%-][ \t]*{node.name}\b(?![ \t]*\()"
        value_match = re.search(value_pattern, self.scope.source.text)
        if called_def is None or len(called_def.values) != 1 or node.value is None or value_match:
            self.scope.report(codes.NAME_TAKEN, node.name_span, name=node.name, other=free_name)
            return
        fix = f"{node.name}({self.scope.source[node.value.span]})"
        self.scope.report(codes.NAME_TAKEN, node.span, None, name=node.name, other="", fix=fix)

    def free_name(self, name: str, procedures: Sequence[ir.Procedure]) -> str:
        """Return `DANCE_2`, or with the first number that makes an unused name."""
        if name not in self._free_names:
            self._free_names[name] = (numbered_names(self.scope.source.text, name), [])
        candidates, free_names = self._free_names[name]
        k = max(
            0, sum(procedure.name == name for procedure in procedures) - 1
        )  # these got one already
        free_names += islice(candidates, max(0, k + 1 - len(free_names)))
        return free_names[k]


def _with_first_value(call_match: re.Match[str], value: str) -> str:
    """Return a call with this value in place of the group 2."""
    start, end = (offset - call_match.start() for offset in call_match.span(2))
    return call_match[0][:start] + value + call_match[0][end:]


def _span_with_separator(source: Source, span: Span) -> Span:
    """Return the span of an instruction, with the `;` or the line end after it."""
    match = re.compile(r"[ \t]*(?:;[ \t]*|\r?\n|$)").match(source.text, span.end)
    return Span(span.start, match.end()) if match else span


def _until_offset(source: Source, node: ast.Command, until: ast.Argument) -> int:
    text_before = source[Span(node.span.start, until.span.start)]
    return node.span.start + text_before.upper().rfind("UNTIL")


def _span_without_until(source: Source, node: ast.Command) -> Span:
    """Return the span of an instruction without its UNTIL."""
    if node.until is None:
        return node.span
    call = source[Span(node.span.start, _until_offset(source, node, node.until))]
    return Span(node.span.start, node.span.start + len(call.rstrip()))


_NEXT_QUESTION = re.compile(r"(?i)[\s;]{0,200}IF[ \t]*\(([^()\r\n;]{0,60}[<>=][^()\r\n;]{1,60})\)")

_NEAR_QUESTION = re.compile(
    r"\b(DISTANCE)[ \t]{0,9}(<=?)[ \t]{0,9}([0-9]+(?:\.[0-9]+)?)\b", re.IGNORECASE
)


def next_condition(source: Source, span: Span) -> str:
    """Return the condition of an IF after `span`.

    Otherwise return the program's question about the same sensor, first one after it, or else an
    example.
    """
    if match := _NEXT_QUESTION.match(source.text, span.end):
        return match[1].strip()
    question_match = _NEAR_QUESTION.search(source.text, span.end) or _NEAR_QUESTION.search(
        source.text, 0, span.start
    )
    return " ".join(question_match.groups()) if question_match else "DISTANCE < 10"


def _until_match(source: Source, span: Span) -> re.Match[str] | None:
    """Return the UNTIL after an instruction, or alone before it like the start of a block."""
    text_before = source.text[max(0, span.start - _MAX_CHARACTERS_BACK) : span.start]
    return _UNTIL_CLAUSE.search(source[span]) or _UNTIL_AT_END.search(text_before)


_LOW_TONE = 150  # hertz: a note that is no round number, as powers are
_ROUND_STEP = 50


def repair_values(source: Source, node: ast.Command, word: Word) -> dict[str, str]:
    """Return the values of a diagnostic: `fix`, or an example, or none."""
    arguments = node.arguments or ()
    texts = [
        source[Span(argument.span.start, argument.unit.end if argument.unit else argument.span.end)]
        for argument in arguments
    ]
    values: dict[str, str] = {}
    if len(texts) != 2 or not all(argument.is_plain for argument in arguments):
        return values
    first_text, second_text = texts
    is_short = first_text.replace(".", "", 1).isdecimal() and float(first_text) < _LONG_TIME_S
    if word.has_tone:
        if re.fullmatch(r"\d+\.\d{3}", second_text):  # `BEEP(1, 1.000)`
            values["fix"] = f"{word.text}({first_text}, {second_text.replace('.', '')})"
        elif _whole_number(first_text) > _LOWEST_HERTZ:
            values |= {"fix": f"{word.text}({second_text}, {first_text})", "usage": word.usage}
        elif is_short:
            values["tone"] = f"{word.text}({first_text}, {word.arguments[1].sample})"
    elif word.text in OPPOSITE_MOVES:
        if sum(text.startswith("-") for text in texts) == 1:
            values_text = ", ".join(text.lstrip("- ") for text in texts)
            values["fix"] = f"{OPPOSITE_MOVES[word.text]}({values_text})"
        elif word.text == "B" and is_short and _is_frequency(second_text):
            values["sound"] = f"BEEP({first_text}, {second_text})"
        elif is_short:
            values["most"] = f"{word.text}({first_text}, {as_text(word.arguments[1].high)})"
    return values


def _whole_number(text: str) -> int:
    """Return a whole number, 0 for anything else."""
    return int(text[:9]) if text.isdecimal() else 0


def _is_frequency(text: str) -> bool:
    """Return whether a number is a tone rather than a power: 440, but not 200."""
    return _whole_number(text) >= _LOW_TONE and _whole_number(text) % _ROUND_STEP != 0


def _count_values(
    texts: Sequence[str], word: Word, until_match: re.Match[str] | None
) -> dict[str, str]:
    """Return the values for a wrong number of arguments: `power` of F(80) is F(2, 80), `spare` of
    F(2, 80, 5) is F(2, 80).

    `kept` is W(2) for W(2, 80): a wait has no power. With UNTIL, the time may be FOREVER.
    """
    numbers = [float(text) if _NUMBER.fullmatch(text) else -1 for text in texts]
    values = {"power": "", "spare": "", "kept": ""}
    if word.has_tone and len(texts) == 1 and texts[0] in _FEW_TIMES:
        values["number"] = texts[0]
        values["often"] = f"LOOP({texts[0]});{word.example};W(0.5);END_LOOP"
        values["long"] = _call_text(word, [texts[0], word.arguments[1].sample])
    if word.role.is_move and len(texts) == 1 and _LONG_TIME_S <= numbers[0] <= _HIGHEST_POWER:
        values["power"] = _call_text(word, [TIME.sample, texts[0]])
        if until_match is not None:
            values["endless"] = (
                f"{word.text}(FOREVER, {texts[0]}) {until_match[0].strip().rstrip(';')}"
            )
        values["number"] = texts[0]
    elif len(texts) > len(word.arguments) and min(numbers) >= 0:
        is_sound = word.has_tone and numbers[1] > _LOWEST_HERTZ
        if is_sound or len(word.arguments) == 1:
            values["spare"] = _call_text(word, texts[: len(word.arguments)])
        if word.role.is_move and numbers[0] < _LONG_TIME_S <= numbers[1] <= _HIGHEST_POWER:
            values["spare"] = _call_text(word, texts[:2])
        is_timed = word.role.name == "wait" and len(texts) == len(_TIME_AND_POWER)
        for first, second in (_TIME_AND_POWER, _TIME_AND_POWER[::-1]):
            if is_timed and 0 <= numbers[first] < _LONG_TIME_S <= numbers[second] <= _HIGHEST_POWER:
                values["kept"] = _call_text(word, [texts[first]])
    return values


def _call_text(word: Word, texts: Sequence[str]) -> str:
    return f"{word.text}({', '.join(texts)})"
