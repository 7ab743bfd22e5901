"""The lint: advice about a program that has no mistakes.

Knows the IR, before it is optimised. Gives warnings, never mistakes.
"""

from __future__ import annotations

from collections.abc import Iterator

from tiniscript.bytecode.opcodes import COMPARATORS
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Code, Diagnostic
from tiniscript.fixed_point import as_text
from tiniscript.kit import Kit
from tiniscript.semantics.ir import (
    Assign,
    Beep,
    Body,
    Call,
    Expression,
    If,
    Loop,
    Motors,
    Move,
    Program,
    Read,
    Statement,
    While,
    bodies,
    expressions,
    goes_on,
    loops_end,
    walk,
)
from tiniscript.semantics.optimizer import constant, fold, sure_fault
from tiniscript.source import Span
from tiniscript.syntax.operators import SIGN_OF
from tiniscript.words import DEVICE_WORDS, POWER_WORDS, names_of

LONG_MOVE = 500  # ms: a robot goes a hand's breadth in this time
LONG_TIME = 20_000  # ms: a power was meant, where the power is a time
VERY_LONG_TIME = 500_000  # ms: milliseconds were meant, as `delay(1000)` of an Arduino has them
LONG_BEEP = 100_000  # ms
ANGLES = (45_000, 90_000, 135_000, 180_000, 270_000, 360_000)  # ms: degrees were meant
LITTLE_POWER = 10_000  # thousandths of a percent
# Names of variables that say which value is in them.
_TIMES = frozenset(names_of("time"))
_POWERS = frozenset((*names_of("power"), *POWER_WORDS))
_COMPARATORS = frozenset(name for name, _ in COMPARATORS)


def advice(program: Program, kit: Kit) -> list[Diagnostic]:
    """Return the warnings for a program that has no mistakes."""
    found: list[Diagnostic] = []
    routines = [*(procedure.body for procedure in program.procedures), program.body]
    for body in routines:
        _swapped_names(body, program, found)
        _look_at(body, program, kit, found)
    statements = [statement for body in routines for statement in walk(body)]
    found += _unused(program, statements)
    return found


def _report(found: list[Diagnostic], code: Code, span: Span, **values: str) -> None:
    found.append(Diagnostic(code, span, values))


def _look_at(body: Body, program: Program, kit: Kit, found: list[Diagnostic]) -> None:
    for k, statement in enumerate(body):
        if k + 1 < len(body) and not goes_on((statement,)):
            _report(found, codes.NEVER_REACHED, body[k + 1].span)
            break
    for statement in body:
        _expressions(statement, found)
        if isinstance(statement, Move) and statement.until is None:
            time = None if statement.time is None else constant(fold(statement.time))
            if time is not None and time <= 0:
                _report(found, codes.MOVE_OF_NO_TIME, statement.span, word=statement.direction)
            _swapped(statement, time, found)
            _very_long(statement, time, found)
        if isinstance(statement, Beep):
            _long_beep(statement, found)
        if isinstance(statement, (Loop, While)):
            _late_checks(statement.body, kit, found)
            _never_repeats(statement, found)
            if _is_forever(statement) and not (
                loops_end(statement.body) or _takes_time(statement.body, program)
            ):
                word = "LOOP(FOREVER)" if isinstance(statement, Loop) else "WHILE"
                head = Span(statement.span.start, statement.span.start + len(word))
                _report(found, codes.BUSY_LOOP, head, word=word)
        for inner in bodies(statement):
            _look_at(inner, program, kit, found)


def _expressions(statement: Statement, found: list[Diagnostic]) -> None:
    for expression in expressions(statement):
        fault = sure_fault(fold(expression))
        if fault:
            _report(found, codes.WILL_FAULT, statement.span, fault=fault)
            return


def _swapped(move: Move, time: int | None, found: list[Diagnostic]) -> None:
    """`F(80, 2)`: a long time with a power that moves hardly any robot."""
    power = None if move.power is None else constant(fold(move.power))
    if time is None or power is None or not (LONG_TIME <= time <= 100_000):
        return
    if 0 < power <= LITTLE_POWER:
        seconds, percent = as_text(time), as_text(power)
        fix = f"{move.direction}({percent}, {seconds})"
        _report(found, codes.SWAPPED, move.span, time=seconds, power=percent, fix=fix)


def _swapped_names(body: Body, program: Program, found: list[Diagnostic]) -> None:
    """`F(SPEED, TIME_S)`: variables that are set once, in the wrong order by name and number."""
    routines = [*(procedure.body for procedure in program.procedures), program.body]
    set_to: dict[int, list[int | None]] = {}
    for statement in (each for routine in routines for each in walk(routine)):
        if isinstance(statement, Assign):
            set_to.setdefault(statement.variable, []).append(constant(fold(statement.value)))
    for move in (each for each in walk(body) if isinstance(each, Move)):
        if move.until is not None or move.time is None or move.power is None:
            continue
        sides = (move.time, move.power)
        if not all(len(side) == 1 and side[0].op == "VARIABLE" for side in sides):
            continue
        numbers = [side[0].value for side in sides]
        values = [set_to.get(each, []) for each in numbers]
        if not all(len(each) == 1 and each[0] is not None for each in values):
            continue
        time, power = (each[0] or 0 for each in values)
        first, second = (program.variables[each] for each in numbers)
        if _is_right_order(first, second):
            continue
        if LONG_TIME <= time <= 100_000 and 0 < power <= LITTLE_POWER:
            fix = f"{move.direction}({second}, {first})"
            _report(found, codes.SWAPPED, move.span, fix=fix,
                    time=as_text(time), power=as_text(power))  # fmt: skip


def _is_right_order(first: str, second: str) -> bool:
    """Whether no name of `F(first, second)` says that it is in the other's place."""
    if _says(first, _TIMES) or _says(second, _POWERS):
        return True
    return not _says(first, _POWERS) and not _says(second, _TIMES)


def _says(name: str, meanings: frozenset[str]) -> bool:
    """Whether a part of a name is in `meanings`: TIME_S, MI_TIEMPO, VEL1."""
    return any(part.rstrip("0123456789") in meanings for part in name.split("_"))


def _very_long(move: Move, time: int | None, found: list[Diagnostic]) -> None:
    """`R(90, 50)`, `W(1000)`: degrees and milliseconds were meant."""
    if time is None:
        return
    power = None if move.power is None else constant(fold(move.power))
    shown = "" if move.direction == "W" else f", {'80' if power is None else as_text(power)}"
    if move.direction in ("L", "R") and time in ANGLES:
        fix = f"{move.direction}(1{shown})"
        _report(found, codes.LONG_TIME, move.span, degrees=as_text(time), fix=fix)
    elif time >= VERY_LONG_TIME:
        fix = f"{move.direction}({as_text(time // 1000)}{shown})"
        _report(found, codes.LONG_TIME, move.span, time=as_text(time), fix=fix)


def _long_beep(beep: Beep, found: list[Diagnostic]) -> None:
    time, hertz = constant(fold(beep.time)), constant(fold(beep.hertz))
    if time is not None and hertz is not None and time >= LONG_BEEP:
        # of an Arduino: `tone(pin, hertz, milliseconds)`; or in this order, with milliseconds
        fix = f"BEEP({as_text(hertz // 1000)}, {as_text(time)})"
        if time % 100_000 == 0:  # a round time, and no note's hertz
            fix = f"BEEP({as_text(time // 1000)}, {as_text(hertz)})"
            fix = fix if hertz % 100_000 else ""
        _report(found, codes.LONG_TIME, beep.span, time=as_text(time), fix=fix)


def _never_repeats(loop: Loop | While, found: list[Diagnostic]) -> None:
    """`LOOP(0)`, `LOOP(-1)`, which other languages take for one without an end."""
    times = None if isinstance(loop, While) or loop.times is None else constant(fold(loop.times))
    if times is not None and times < 500:  # it is rounded
        head = Span(loop.span.start, loop.span.start + len("LOOP"))
        _report(found, codes.NEVER_REPEATS, head, times=as_text(times))


def _is_forever(statement: Loop | While) -> bool:
    if isinstance(statement, Loop):
        return statement.times is None
    return constant(fold(statement.condition)) == 1


def _takes_time(body: Body, program: Program) -> bool:
    """Whether a body moves, waits or beeps, or calls something that does."""
    for statement in walk(body):
        if isinstance(statement, (Move, Beep, Motors)):
            return True
        if isinstance(statement, Call):
            if _takes_time(program.procedures[statement.procedure].body, program):
                return True
    return False


def _late_checks(body: Body, kit: Kit, found: list[Diagnostic]) -> None:
    """Find a long move, then a look at a distance: the robot drives blind in between."""
    for k, statement in enumerate(body):
        if not isinstance(statement, Move) or statement.direction not in ("F", "B"):
            continue
        time = None if statement.time is None else constant(fold(statement.time))
        if statement.until is not None or time is None or time < LONG_MOVE:
            continue
        following = next((each for each in body[k + 1 :] if not isinstance(each, Read)), None)
        if not isinstance(following, If):
            continue
        condition = following.arms[0].condition
        sensor = next((term.value for term in condition if _is_distance(term.op, term.value, kit)),
                      None)  # fmt: skip
        if sensor is not None:
            power = None if statement.power is None else constant(fold(statement.power))
            shown = "80" if power is None else as_text(power)
            fix = (
                f"{statement.direction}({as_text(time)}, {shown}) "
                f"UNTIL({_comparison(condition, kit) or kit.sensors[sensor].name + ' < 10'})"
            )
            _report(found, codes.LATE_CHECK, statement.span, word=statement.direction,
                    time=as_text(time), sensor=kit.sensors[sensor].name, fix=fix)  # fmt: skip


def _is_distance(op: str, sensor: int, kit: Kit) -> bool:
    return op == "SENSOR" and kit.sensors[sensor].unit in ("cm", "mm", "m")


def _comparison(condition: Expression, kit: Kit) -> str:
    """Return `DISTANCE < 10` for a condition that is just that, else nothing."""
    if len(condition) != 3 or condition[2].op not in _COMPARATORS:
        return ""
    texts = [
        kit.sensors[term.value].name if term.op == "SENSOR" else as_text(term.value)
        for term in condition[:2]
        if term.op in ("SENSOR", "NUMBER")
    ]
    return f" {SIGN_OF[condition[2].op]} ".join(texts) if len(texts) == 2 else ""


def _unused(program: Program, statements: list[Statement]) -> Iterator[Diagnostic]:
    used = {
        term.value
        for statement in statements
        for expression in expressions(statement)
        for term in expression
        if term.op == "VARIABLE"
    }
    for statement in statements:
        if isinstance(statement, Assign) and statement.variable not in used:
            used.add(statement.variable)  # said once
            name = program.variables[statement.variable]
            device = name if name in DEVICE_WORDS else ""
            values = {"name": name, "device": device}
            yield Diagnostic(codes.UNUSED_VARIABLE, statement.span, values)
    called = {each.procedure for each in statements if isinstance(each, Call)}
    for number, procedure in enumerate(program.procedures):
        if number not in called:
            span = Span(procedure.span.start, procedure.span.start + len("DEF"))
            yield Diagnostic(codes.UNUSED_DEF, span, {"name": procedure.name})
