"""Warns of numbers that nobody means: degrees, centimetres, milliseconds, `F(80, 2)`, `LOOP(0)`.

Looks only at literal numbers and at variables that are set once.
"""

from __future__ import annotations

import re

from tiniscript.base.fixed_point import ONE, Fault, as_text, round_to_whole
from tiniscript.base.kit import Kit
from tiniscript.base.source import Span
from tiniscript.base.words import POWER, UNIT_OF, Argument
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.semantics import ir
from tiniscript.semantics.comparisons import TIME, comparisons_in
from tiniscript.semantics.ir import Act, Expression, Move
from tiniscript.semantics.lint.context import BodyContext, LintContext
from tiniscript.semantics.named_values import is_power, is_time
from tiniscript.semantics.optimizer import fold, known_value, sure_fault
from tiniscript.semantics.ways import extent_move_ms
from tiniscript.syntax.lexer import NEWLINE, NUMBER, WORD
from tiniscript.syntax.operators import SIGN_OF

SECOND_MS = 1000  # ms
LONG_TIME_MS = 20 * SECOND_MS  # a power was meant, where the power is a time
LONG_DRIVE_MS = 30 * SECOND_MS  # longer than any classroom: centimetres or degrees were meant
LONGEST_DRIVE_MS = 60 * SECOND_MS  # … also where the number is no round one
LONG_WAIT_MS = 100 * SECOND_MS
USUAL_SPEED = 30 * SECOND_MS  # cm per second, of a robot whose kit has no speed
FAR_DISTANCE = (
    300 * SECOND_MS * 100 * SECOND_MS * SECOND_MS
)  # 3 m, as a product of speed, power and time
VERY_LONG_TIME_MS = (
    500 * SECOND_MS
)  # milliseconds were meant, as `delay(1000)` of an Arduino has them
LONG_BEEP_MS = 100 * SECOND_MS
LOW_HERTZ = 100_000  # thousandths: a power was meant
ANGLES = (360 * SECOND_MS, 720 * SECOND_MS)
TURN_PART = 45 * SECOND_MS  # parts of turns of more than one round
_LENGTHS = ("cm", "mm", "m")
_LEADING_ZERO = re.compile(r"\w+\s*\(\s*(0[0-9]{2,})\s*[,)]")  # a point is missing after its 0
_LEADING_ZERO_OF_TURN = re.compile(r"(?i)[LR]\s*\(\s*(0[1-9])\s*,\s*[1-9]")  # `L(03, 60)`
# `R(90`, with brackets in a calculation, and the text after it: the power, and UNTIL.
_FIRST_VALUE = re.compile(
    r"\w+\s*\((\s*(?:[^(),/]|/(?!/)|\((?:[^()]|\([^()]*\))*\))*?)(\s*[,)].*)", re.S
)
_UNTIL_CLAUSE = re.compile(r"(?is)\s*\bUNTIL\b.*")  # an UNTIL with its condition
_TOKENS_TO_SECOND_VALUE = 4  # tokens after its word, up to the second value
LITTLE_POWER = 10_000  # thousandths of a percent


def report_will_fault(
    statement: ir.Statement | ir.Task, body_context: BodyContext, context: LintContext
) -> None:
    for expression in ir.expressions(statement):
        fault = sure_fault(fold(expression))
        if fault:
            context.report(codes.WILL_FAULT, statement.span, fault=fault)
            return


def check_clock(
    statement: ir.Statement | ir.Task, body_context: BodyContext, context: LintContext
) -> None:
    """`TIME < 10000`: the clock counts seconds."""
    for expression in ir.expressions(statement):
        for device, op, number in comparisons_in(expression, context.kit):
            if device is TIME and _is_milliseconds(number):
                limit, seconds = as_text(number), as_text(number // 1000)
                values = {"limit": limit, "fix": f"TIME {SIGN_OF[op]} {seconds}"}
                context.report(codes.LONG_TIME, _clock_span(statement, limit, context), **values)


def _clock_span(statement: ir.Statement | ir.Task, limit: str, context: LintContext) -> Span:
    """Return the place of a comparison of the clock as written, or its statement."""
    pattern = rf"(?i)\bTIME\b[ \t]*[<>=]+[ \t]*{limit}\b|\b{limit}[ \t]*[<>=]+[ \t]*TIME\b"
    clock_match = re.compile(pattern).search(context.source.text, *statement.span)
    return Span(*clock_match.span()) if clock_match else statement.span


def check_times(loop: ir.Loop, body_context: BodyContext, context: LintContext) -> None:
    """`LOOP(0)`, `LOOP(-1)`, which other languages take for one without an end; `LOOP(4.5)`."""
    times = known_value(loop.times)
    header_span = Span(loop.span.start, loop.span.start + len("LOOP"))
    if times is not None and times < 500:  # a number below 0.5 is rounded
        context.report(codes.NEVER_REPEATS, header_span, times=as_text(times))
    elif times is not None and times % 1000:
        context.report(
            codes.ROUNDED_TIMES, header_span, times=as_text(times), right=str(round_to_whole(times))
        )


def check_move(move: Move, body_context: BodyContext, context: LintContext) -> None:
    diagnostics = _check_extent(move, context.kit) if move.unit else _check_time(move, context)
    context.diagnostics += diagnostics or _check_named_time(move, context)


def _check_named_time(move: Move, context: LintContext) -> list[Diagnostic]:
    """`DEF SIDE(SIZE); F(SIZE, 60)`, called with 30: the values of its calls are looked at."""
    time = move.time or ()
    if move.unit or move.until is not None or [term.op for term in time] != ["VARIABLE"]:
        return []
    variable = time[0].value
    if not any(variable in procedure.values for procedure in context.program.procedures):
        return []
    values = [
        known_value(value) for value in context.variables.values_by_variable.get(variable, ())
    ]
    if not values or None in values or is_time(context.program.variables[variable]):
        return []
    longest_ms, text = max(value or 0 for value in values), context.source[move.span]
    diagnostics = _warn_of_long_time(move, longest_ms, known_value(move.power), context.kit, text)
    return [
        diagnostic._replace(values={**diagnostic.values, "fix": ""}) for diagnostic in diagnostics
    ]


def _check_time(move: Move, context: LintContext) -> list[Diagnostic]:
    """Return the warnings about the numbers of a move or a wait by its time.

    It is one thing at most, and for `R(03, 2)` what is said of its power, too. With UNTIL, a long
    time is only a limit.
    """
    time, power, kit = known_value(move.time), known_value(move.power), context.kit
    text, is_ended = context.source[move.span], move.until is not None
    zero_match = (
        None if is_ended else _LEADING_ZERO.match(text) or _LEADING_ZERO_OF_TURN.match(text)
    )
    if time is None:
        return _check_power(move) if is_ended else _report_extent_as_time(move, kit, text)
    if time <= 0 and not is_ended:
        return [Diagnostic(codes.ZERO_TIME_MOVE, move.span, {"word": move.direction})]
    if zero_match is not None:  # `L(039, 60)`
        fix = f"{text[: zero_match.start(1)]}0.{zero_match[1][1:]}{text[zero_match.end(1) :]}"
        is_sure = len(zero_match[1]) > 2 and not zero_match[1].startswith("00")
        values = {"found": zero_match[1], "right": as_text(time), "fix": fix if is_sure else ""}
        if len(zero_match[1]) == 2:  # 3 seconds or 0.3
            values["point"] = f"0.{zero_match[1][1:]}"
        zero_span = Span(move.span.start + zero_match.start(1), move.span.start + zero_match.end(1))
        return [Diagnostic(codes.ZERO_BEFORE, zero_span, values, move.span), *_check_power(move)]
    if _is_swapped(time, power):
        seconds, percent = as_text(time), as_text(power or 0)
        until_match = _UNTIL_CLAUSE.search(text) if is_ended else None
        fix = f"{move.direction}({percent}, {seconds}){until_match[0] if until_match else ''}"
        values = {"time": seconds, "power": percent, "fix": fix}
        return [Diagnostic(codes.SWAPPED, move.span, values)]
    may_last = is_ended and not (move.direction in ("L", "R") and kit.turn)
    return ([] if may_last else _warn_of_long_time(move, time, power, kit, text)) or _check_power(
        move
    )


def _check_extent(move: Move, kit: Kit) -> list[Diagnostic]:
    """Return the warning about a move by its way: what its numbers surely make."""
    extent = known_value(move.time)
    if extent is not None and extent <= 0:
        values = {"word": move.direction, "unit": move.unit}
        return [Diagnostic(codes.ZERO_TIME_MOVE, move.span, values)]
    try:
        extent_move_ms(move, kit)
    except Fault as fault:
        values = {"fault": fault.name, "unit": move.unit if fault.name == "NO_POWER" else ""}
        return [Diagnostic(codes.WILL_FAULT, move.span, values)]
    return _check_power(move)


def _report_extent_as_time(move: Move, kit: Kit, text: str) -> list[Diagnostic]:
    """`F(DISTANCE, 60)`, `F(TIME, 60)`: centimetres, or a clock, in the place of seconds."""
    time = move.time or ()
    is_clock = len(time) == 1 and time[0].op == "TIME"
    power = text.rpartition(",")[2].rstrip(") ")
    seconds = f"{move.direction}(1)" if move.power is None else f"{move.direction}(2,{power})"
    if is_clock:
        values = {"clock": "TIME", "seconds": seconds}
        return [Diagnostic(codes.LONG_TIME, move.span, values)]
    # `F(DISTANCE - 5, 60)`
    is_sum = all(part.op in ("SENSOR", "NUMBER", "ADD", "SUB") for part in time)
    sensors = [kit.readings[part.value] for part in time if part.op == "SENSOR"]
    if not is_sum or len(sensors) != 1 or sensors[0].unit not in _LENGTHS:
        return []
    name = sensors[0].name
    limit = next((as_text(part.value) for part in time if part.op == "NUMBER"), "10")
    until_example = f"F(FOREVER,{power}) UNTIL({name} < {limit})" if move.direction == "F" else ""
    values = {"sensor": name, "word": move.direction, "until": until_example, "seconds": seconds}
    return [Diagnostic(codes.LONG_TIME, move.span, values)]


def _check_power(move: Move) -> list[Diagnostic]:
    """Return the warning about a power that moves no robot, or that is too much."""
    time, power = known_value(move.time), known_value(move.power)
    diagnostics = (
        []
        if move.power is None
        else _warn_of_cut_value(move.power, POWER, move.span, move.direction)
    )
    if (
        power is not None
        and 0 <= power < LITTLE_POWER
        and (time is None or time < LONG_TIME_MS or move.unit)
    ):
        time_text = "2" if not time else as_text(time)
        time_text = "FOREVER" if move.time is None else f"{time_text} {move.unit}".rstrip()
        values = {"power": as_text(power), "example": f"{move.direction}({time_text}, 50)"}
        if 0 < power < ONE:  # `F(2, 0.8)`
            values["percent"] = as_text(power * 100)
            values["whole"] = f"{move.direction}({time_text}, {as_text(power * 100)})"
        diagnostics.append(Diagnostic(codes.LITTLE_POWER, move.span, values))
    return diagnostics


def _warn_of_long_time(
    move: Move, time: int, power: int | None, kit: Kit, text: str
) -> list[Diagnostic]:
    """`R(90, 50)`, `F(90, 60)`, `W(1000)`: degrees, centimetres and milliseconds were meant."""
    word = move.direction
    power_text = as_text(80_000 if power is None else power)
    is_turn, is_drive = word in ("L", "R"), word in ("F", "B")
    is_round = time % (5 * SECOND_MS) == 0
    is_long = time > LONGEST_DRIVE_MS or (time >= LONG_DRIVE_MS and is_round)
    is_very_long = time >= VERY_LONG_TIME_MS
    usage = f"{word}( , {power_text})"
    time_text = as_text(time)
    call_match = _FIRST_VALUE.fullmatch(text)
    first_text, rest_text = call_match.groups() if call_match else ("", f", {power_text})")
    extent_call = (
        first_text and f"{word}({first_text} {UNIT_OF.get(word, '')}{rest_text}"
    )  # a beep after a note is different
    speed = kit.speed or USUAL_SPEED
    is_far_drive = is_round and time >= LONG_TIME_MS and speed * (power or 0) * time >= FAR_DISTANCE
    if is_turn and _is_turn(time, kit, is_long) and not (is_very_long and time % TURN_PART):
        values = {"degrees": time_text, "word": word, "turn": usage}
        values |= {"way": extent_call} if kit.turn else {}
    elif is_drive and (is_long or is_far_drive) and not is_very_long:
        values = {"centimetres": time_text, "word": word, "drive": usage}
        values |= {"way": extent_call} if kit.speed else {}
    elif _is_milliseconds(time) if word == "W" else is_very_long:
        values = {"time": time_text, "fix": f"{word}({as_text(time // 1000)}{rest_text}"}
    else:
        return []
    return [Diagnostic(codes.LONG_TIME, move.span, values)]


def _is_turn(time: int, kit: Kit, is_long: bool) -> bool:
    """`R(90, 60)`, which turns for 90 seconds: degrees were meant."""
    if kit.turn:
        return time >= LONG_TIME_MS
    return time in ANGLES or (is_long and time < VERY_LONG_TIME_MS)


def _is_milliseconds(time: int) -> bool:
    """`W(200)`: a round number, and no round number of minutes, but for W(1500) and W(3000)."""
    is_whole = time >= LONG_WAIT_MS and time % (50 * SECOND_MS) == 0
    return is_whole and (time % (500 * SECOND_MS) == 0 or time % (30 * SECOND_MS) != 0)


def check_act(act: Act, body_context: BodyContext, context: LintContext) -> None:
    """Warn of values outside their range, and of a sound that is longer than anybody can bear."""
    word, time = act.word.text, known_value(act.time)
    for argument, value in act.arguments:
        if argument.whole_limits is not None:
            context.diagnostics += _warn_of_cut_value(value, argument, act.span, word)
    if time is not None and time <= 0:
        context.report(codes.ZERO_TIME_MOVE, act.span, word=word)
    hertz = known_value(act.values[1]) if act.word.has_tone else None
    if time is None or hertz is None or time < LONG_BEEP_MS:
        return
    # Arduino's `tone(pin, hertz, milliseconds)`, or this order with milliseconds.
    rival = f"{word}({as_text(time // 1000)}, {as_text(hertz)})"
    fix = f"{word}({as_text(hertz // 1000)}, {as_text(time)})"
    sound = ""
    if time % (100 * SECOND_MS) == 0:  # a round time, and no note's hertz
        fix, rival = rival if hertz % 100_000 else "", ""
    elif hertz <= LOW_HERTZ:  # `BEEP(440, 80)`: the duration is missing
        fix, rival, sound = "", "", f"{word}(seconds, {as_text(time)})"
    elif time % (50 * SECOND_MS) == 0 and hertz % 50_000:  # `BEEP(250, 440)`
        fix, rival = rival, fix
    gaps = {"fix": fix, "sound": sound} | ({"rival": rival} if rival else {})
    context.report(codes.LONG_TIME, act.span, time=as_text(time), **gaps)


def report_swapped_rounds(context: LintContext) -> None:
    """`ROUND(1, DISTANCE)`: a whole number is rounded, and the other value gives the number of
    decimals."""
    tokens = [token for token in context.scan.tokens if token.kind is not NEWLINE]
    for k, token in enumerate(tokens[:-_TOKENS_TO_SECOND_VALUE]):
        if token.text != "ROUND":
            continue
        number, comma, value_start = tokens[k + 2 : k + 2 + _TOKENS_TO_SECOND_VALUE - 1]
        is_whole = number.kind is NUMBER and float(number.text).is_integer()
        if not is_whole or comma.kind != ",":
            continue
        depth, end = 1, k + 4
        while depth:
            depth += (tokens[end].kind == "(") - (tokens[end].kind == ")")
            end += 1
        if any(token.kind is WORD for token in tokens[k + 4 : end - 1]):
            value = context.source[Span(value_start.start, tokens[end - 2].end)]
            fix = f"ROUND({value}, {number.text})"
            span = Span(token.start, tokens[end - 1].end)
            context.report(codes.SWAPPED, span, number=number.text, value=value, fix=fix)


def report_swapped_names(move: Move, body_context: BodyContext, context: LintContext) -> None:
    """`F(SPEED, TIME_S)`: variables that are set once, in the wrong order by name and number."""
    if move.until is not None or move.time is None or move.power is None or move.unit:
        return
    operands = (move.time, move.power)
    if not all(len(operand) == 1 and operand[0].op == "VARIABLE" for operand in operands):
        return
    assigned_values = context.variables.values_by_variable
    values = [
        [*map(known_value, assigned_values.get(operand[0].value, ()))] for operand in operands
    ]
    if not all(len(value) == 1 and value[0] is not None for value in values):
        return
    time, power = (value[0] or 0 for value in values)
    first_name, second_name = (context.program.variables[operand[0].value] for operand in operands)
    if _is_swapped(time, power) and not _is_right_order(first_name, second_name):
        fix = f"{move.direction}({second_name}, {first_name})"
        context.report(codes.SWAPPED, move.span, fix=fix, time=as_text(time), power=as_text(power))


def _is_right_order(first_name: str, second_name: str) -> bool:
    """Return whether the names in `F(first, second)` do not suggest the reverse order."""
    if is_time(first_name) or is_power(second_name):
        return True
    return not is_power(first_name) and not is_time(second_name)


def _is_swapped(time: int, power: int | None) -> bool:
    """`F(80, 2)`: a long time with a power that moves hardly any robot."""
    return power is not None and LONG_TIME_MS <= time <= 100_000 and 0 < power <= LITTLE_POWER


def _warn_of_cut_value(
    expression: Expression, argument: Argument, span: Span, word: str
) -> list[Diagnostic]:
    """`BEEP(0.2, 440-660)`: the robot takes the lowest or the highest value instead."""
    value = known_value(expression)
    if value is None or argument.low <= value <= argument.high:
        return []
    limit = as_text(argument.low if value < argument.low else argument.high)
    values = {"word": word, "value": as_text(value), "unit": argument.unit, "taken": limit}
    return [Diagnostic(codes.CUT_VALUE, span, values)]
