"""The instructions of a program as lines of C++, each with its TiniScript beside it.

Knows which helper does what a word means. `Uses` collects what the sketch has to have for that.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import NamedTuple

from tiniscript.base.fixed_point import ONE, as_text, clamp, whole
from tiniscript.base.kit import Kit
from tiniscript.base.source import Source, printable
from tiniscript.codegen.sketch.expressions import Expressions, has_random, reads_once
from tiniscript.codegen.sketch.names import counter
from tiniscript.semantics import ir
from tiniscript.semantics.ir import Term
from tiniscript.semantics.optimizer import constant
from tiniscript.semantics.ways import to_timed

MOST_COLUMNS = 100  # columns of a line with what stands beside it
COMMENT_COLUMN = 40  # the column of what stands beside code
_MOVE_FUNCTIONS = {"F": "forward", "B": "backward", "L": "turn_left", "R": "turn_right"}
_START_FUNCTIONS = {
    "F": "start_forward",
    "B": "start_backward",
    "L": "start_left",
    "R": "start_right",
}
_LARGEST_INT = 2**15 - 1

Part = tuple[ir.Expression, tuple[int, int] | None]  # and its limits; None: a time


class Comment(NamedTuple):
    """A comment of the program: where it begins, the line it is in, and its text."""

    start: int
    line: int
    text: str


class SketchNames(NamedTuple):
    """What things are called in C++. `reads` and `sets` are functions."""

    sensors: Sequence[str]
    reads: Sequence[str]
    sets: Sequence[str]
    procedures: Sequence[str]
    variables: Sequence[str]


class Statements:
    def __init__(
        self,
        source: Source,
        kit: Kit,
        names: SketchNames,
        write: Expressions,
        comments: Sequence[Comment],
    ) -> None:
        self.source = source
        self.kit = kit
        self.names = names
        self.write = write
        self.use = write.use
        self.lines: list[str] = []
        self.waiting = list(reversed(comments))
        self.read_sensors: set[int] = set()
        self.set_actuators: set[int] = set()
        self.depth = 1
        self.loops = 0
        self.variables_set_by_calls: frozenset[int] = frozenset()  # arguments
        self.values: list[ir.Expression] = []  # of the arguments of the call that is next

    def body(self, body: ir.Body) -> None:
        for statement in body:
            if (
                isinstance(statement, ir.Assign)
                and statement.variable in self.variables_set_by_calls
            ):
                self.values.append(statement.value)
            else:
                self.statement(statement)

    # -- lines

    def line(self, code: str, comment: str = "") -> None:
        indent = "  " * self.depth
        plain = f"{indent}{code}"
        if comment:
            padded = f"{plain:<{COMMENT_COLUMN - 2}}  // {comment}"
            if len(padded) <= MOST_COLUMNS:
                plain = padded
            else:
                self.lines.append(
                    f"{indent}// {_truncate(comment, MOST_COLUMNS - len(indent) - 3)}"
                )
        self.lines.append(plain)

    def instruction_text(self, start: int) -> str:
        """Return the instruction or the header of a block that begins at an offset."""
        text, at, open_brackets = self.source.text, start, 0
        while at < len(text):
            letter = text[at]
            if text.startswith("//", at):
                end = re.compile(r"[^\r\n]*").match(text, at)
                assert end is not None
                if not open_brackets:
                    break
                at = end.end()
                continue
            if letter in ";~" or (letter in "\r\n" and not open_brackets):
                break
            open_brackets += {"(": 1, ")": -1}.get(letter, 0)
            at += 1
        result = re.sub(r"//[^\r\n]*", " ", text[start:at])
        return comment_text(" ".join(result.split()))

    def remarks(self, start: int) -> None:
        """Add the comments of the program before an offset, and those in its line."""
        line = self.source.position(start)[0]
        while self.waiting and (self.waiting[-1].start < start or self.waiting[-1].line == line):
            for row in _rows(self.waiting.pop().text, MOST_COLUMNS - 2 * self.depth - 3):
                self.line(f"// {row}")

    def remaining_comments(self) -> None:
        """Add the comments after the last instruction."""
        self.remarks(len(self.source.text) + 1)

    # -- instructions

    def statement(self, statement: ir.Statement) -> None:
        start = statement.span.start
        self.remarks(start)
        _STATEMENTS[type(statement)](self, statement, self.instruction_text(start))

    def read(self, read: ir.Read, said: str) -> None:
        name = said.upper() if said.replace("_", "").isalnum() else ""
        self.line(self.reading(read.sensor), name)

    def motors(self, motors: ir.Motors, said: str) -> None:
        powers = ((motors.left, (-100, 100)), (motors.right, (-100, 100)))
        self.call("motors", said, self.arguments(*powers))

    def stop(self, _: ir.Stop, said: str) -> None:
        self.line(f"{self.use('stop_motors')}();", said)

    def beep(self, beep: ir.Beep, said: str) -> None:
        parts = ((beep.time, None), (beep.hertz, (31, 20_000)))
        self.call("beep", said, self.arguments(*parts))

    def assign(self, assign: ir.Assign, said: str) -> None:
        name = self.names.variables[assign.variable]
        self.line(f"{name} = {self.write.text(assign.value)};", said)

    def break_(self, _: ir.Break, said: str) -> None:
        self.line("break;", said)

    def call_def(self, call: ir.Call, said: str) -> None:
        """Call a function; of its arguments with a RANDOM all but the last come before."""
        arguments, self.values = self.values, []
        texts = [self.write.text(argument) for argument in arguments]
        for k in [k for k, terms in enumerate(arguments) if has_random(terms)][:-1]:
            first = self.write.keep()
            self.line(f"{first} = {texts[k]};")
            texts[k] = first
        name = self.names.procedures[call.procedure]
        self.line(f"{name}({', '.join(texts)});", said)

    def reading(self, sensor: int) -> str:
        self.read_sensors.add(sensor)
        return f"{self.names.reads[sensor]}();"

    def call(self, key: str, comment: str, values: Sequence[str]) -> None:
        self.line(f"{self.use(key)}({', '.join(values)});", comment)

    # -- arguments

    def arguments(self, *parts: Part) -> list[str]:
        """Return arguments; the first one is calculated before, where both have a RANDOM."""
        keeps = len(parts) > 1 and all(has_random(value) for value, _ in parts)
        texts: list[str] = []
        for value, limits in parts:
            fixed = constant(value)
            if fixed is not None:
                rounded = max(0, fixed) if limits is None else clamp(whole(fixed), *limits) * ONE
                texts.append(self.write.text((Term("NUMBER", rounded),)))
                continue
            text = self.write.text(value)
            if keeps and not texts:
                first = self.write.keep()
                self.line(f"{first} = {text};")
                text = first
            low, high = limits or (0, 0)
            texts.append(
                text if limits is None else f"{self.use('limited')}({text}, {low}, {high})"
            )
        return texts

    # -- moves and what is shown

    def move(self, move: ir.Move, comment: str) -> None:
        if move.until is not None:
            self.until(move, move.until, comment)
            return
        assert move.time is not None
        if move.power is None:
            self.call("wait", comment, self.drive(move))
        else:
            self.call(_MOVE_FUNCTIONS[move.direction], comment, self.drive(move))

    def drive(self, move: ir.Move) -> list[str]:
        if move.unit:
            move = to_timed(move, self.kit)
        parts: list[Part] = [] if move.time is None else [(move.time, None)]
        if move.power is not None:
            parts.append((move.power, (0, 100)))
        texts = self.arguments(*parts)
        return texts if move.time is not None else [self.use("FOREVER"), *texts]

    def set(self, statement: ir.Set, comment: str) -> None:
        self.set_actuators.add(statement.actuator)
        device = self.kit.actuators[statement.actuator]
        if device.is_yes_no:
            value = self.write.text(statement.value)
        else:
            (value,) = self.arguments((statement.value, (device.low // ONE, device.high // ONE)))
        self.line(f"{self.names.sets[statement.actuator]}({value});", comment)

    def until(self, move: ir.Move, until: ir.Until, comment: str) -> None:
        self.call(_START_FUNCTIONS.get(move.direction, "start_wait"), comment, self.drive(move))
        self.line(f"while ({self.use('move_lasts')}()) {{")
        self.depth += 1
        condition = self.condition(until.reads, until.condition)
        self.line(f"if ({condition}) break;")
        self.depth -= 1
        self.line("}")
        self.line(f"{self.use('end_move')}();")

    def condition(self, reads: Sequence[int], condition: ir.Expression) -> str:
        """Return a condition; its readings are taken in it, or in lines before it."""
        if len(reads) == 1 and reads_once(condition, reads[0]):
            return self.write.text(condition, (reads[0], self.reading(reads[0])[:-1]))
        for sensor in reads:
            self.line(self.reading(sensor))
        return self.write.text(condition)

    def show(self, show: ir.Show, comment: str) -> None:
        fixed = constant(show.value)
        self.use("Serial")
        if show.is_yes_no:
            self.line(f"{self.use('show_yes_no')}({self.write.text(show.value)});", comment)
        elif fixed is not None:
            self.line(f'Serial.println("{as_text(fixed)}");', comment)
        elif self.write.is_exact:
            self.line(f"{self.use('show_number')}({self.write.text(show.value)});", comment)
        else:
            self.line(f"Serial.println({self.write.text(show.value)});", comment)

    # -- blocks

    def block(self, body: ir.Body, is_loop: bool = False) -> None:
        self.depth += 1
        self.loops += is_loop
        self.body(body)
        self.loops -= is_loop
        self.depth -= 1

    def if_(self, statement: ir.If, _said: str) -> None:
        nested = 0
        for k, arm in enumerate(statement.arms):
            text = self.instruction_text(arm.span.start)
            self.remarks_in(arm.span.start, k)
            line_count_before = len(self.lines)
            inline = len(arm.reads) == 1 and reads_once(arm.condition, arm.reads[0])
            if k and arm.reads and not inline:
                self.line("} else {")
                self.depth += 1
                nested += 1
                condition = self.condition(arm.reads, arm.condition)
                self.line(f"if ({condition}) {{", text)
            else:
                condition = self.condition(arm.reads, arm.condition)
                assert line_count_before == len(self.lines)
                self.line(f"{'} else ' if k else ''}if ({condition}) {{", text)
            self.block(arm.body)
        if statement.otherwise:
            self.line("} else {", "ELSE")
            self.block(statement.otherwise)
        for _ in range(nested):
            self.line("}")
            self.depth -= 1
        self.line("}")

    def remarks_in(self, start: int, arm: int) -> None:
        """Add comments before an arm: those of an ELSEIF stand in the block before it."""
        self.depth += arm > 0
        self.remarks(start)
        self.depth -= arm > 0

    def loop(self, loop: ir.Loop, comment: str) -> None:
        if loop.times is None:
            self.line("while (true) {", comment)
        else:
            name = counter(self.loops)
            fixed = constant(loop.times)
            if fixed is None:
                times = f"{self.use('whole')}({self.write.text(loop.times)})"
                self.line(f"for (long {name} = {times}; {name} > 0; {name}--) {{", comment)
            else:
                count = whole(fixed)
                kind = "int" if abs(count) <= _LARGEST_INT else "long"
                self.line(f"for ({kind} {name} = 0; {name} < {count}; {name}++) {{", comment)
        self.block(loop.body, is_loop=True)
        self.line("}")

    def while_(self, loop: ir.While, comment: str) -> None:
        inline = len(loop.reads) == 1 and reads_once(loop.condition, loop.reads[0])
        if inline or not loop.reads:
            self.line(f"while ({self.condition(loop.reads, loop.condition)}) {{", comment)
        else:
            self.line("while (true) {", comment)
            self.depth += 1
            condition = self.condition(loop.reads, loop.condition)
            self.line(f"if (!({condition})) break;")
            self.depth -= 1
        self.block(loop.body, is_loop=True)
        self.line("}")


# A statement of the IR that has no row here is a KeyError, not a sketch that lacks it.
_STATEMENTS: dict[type, Callable[..., None]] = {
    ir.Read: Statements.read,
    ir.Move: Statements.move,
    ir.Motors: Statements.motors,
    ir.Stop: Statements.stop,
    ir.Beep: Statements.beep,
    ir.Show: Statements.show,
    ir.Set: Statements.set,
    ir.Assign: Statements.assign,
    ir.If: Statements.if_,
    ir.Loop: Statements.loop,
    ir.While: Statements.while_,
    ir.Break: Statements.break_,
    ir.Call: Statements.call_def,
}


def comment_text(text: str) -> str:
    """Return a text that stays in its comment: no controls, and nothing that joins lines."""
    return printable(text).replace("??/", "?? /").rstrip("\\ ")


def _truncate(text: str, most_characters: int) -> str:
    return text if len(text) <= most_characters else text[: most_characters - 1] + "…"


def _rows(text: str, most_characters: int) -> list[str]:
    return [
        comment_text(text[at : at + most_characters]) for at in range(0, len(text), most_characters)
    ] or [""]
