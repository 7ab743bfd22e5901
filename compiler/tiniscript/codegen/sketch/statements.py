"""The instructions of a program as lines of C++, each with its TiniScript in a comment.

It knows which helper carries out the meaning of a word. `Uses` collects the parts that the sketch
needs for that.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import NamedTuple

from tiniscript.base.fixed_point import ONE, as_text, clamp, round_to_whole
from tiniscript.base.kit import Kit
from tiniscript.base.source import Source, printable
from tiniscript.codegen.sketch.expressions import Expressions, has_random, reads_once
from tiniscript.codegen.sketch.names import counter
from tiniscript.semantics import ir
from tiniscript.semantics.ir import Term
from tiniscript.semantics.optimizer import constant
from tiniscript.semantics.ways import timed_move

MAX_COLUMNS = 100  # columns of a line with its comment
COMMENT_COLUMN = 40  # column of the comments after code
_MOVE_FUNCTIONS = {"F": "forward", "B": "backward", "L": "turn_left", "R": "turn_right"}
_START_FUNCTIONS = {
    "F": "start_forward",
    "B": "start_backward",
    "L": "start_left",
    "R": "start_right",
}
_LARGEST_INT = 2**15 - 1

Part = tuple[ir.Expression, tuple[int, int] | None]  # an expression and its limits; a time has None


class Comment(NamedTuple):
    """A comment of the program: where it begins, the line it is in, and its text."""

    start: int
    line: int
    text: str


class SketchNames(NamedTuple):
    """The C++ names in a sketch. `readers` and `setters` are functions."""

    sensors: Sequence[str]
    readers: Sequence[str]
    setters: Sequence[str]
    procedures: Sequence[str]
    variables: Sequence[str]


class Statements:
    def __init__(
        self,
        source: Source,
        kit: Kit,
        names: SketchNames,
        expressions: Expressions,
        comments: Sequence[Comment],
    ) -> None:
        self.source = source
        self.kit = kit
        self.names = names
        self.expressions = expressions
        self.use = expressions.use
        self.lines: list[str] = []
        self.pending_comments = list(reversed(comments))
        self.read_sensors: set[int] = set()
        self.set_actuators: set[int] = set()
        self.depth = 1
        self.loop_depth = 0
        self.variables_set_by_calls: frozenset[int] = frozenset()  # arguments
        self.argument_values: list[ir.Expression] = []  # arguments of the next call

    def add_body(self, body: ir.Body) -> None:
        for statement in body:
            if (
                isinstance(statement, ir.Assign)
                and statement.variable in self.variables_set_by_calls
            ):
                self.argument_values.append(statement.value)
            else:
                self.add_statement(statement)

    # -- lines

    def add_line(self, code: str, comment: str = "") -> None:
        indent = "  " * self.depth
        code_line = f"{indent}{code}"
        if comment:
            commented_line = f"{code_line:<{COMMENT_COLUMN - 2}}  // {comment}"
            if len(commented_line) <= MAX_COLUMNS:
                code_line = commented_line
            else:
                self.lines.append(f"{indent}// {_truncate(comment, MAX_COLUMNS - len(indent) - 3)}")
        self.lines.append(code_line)

    def instruction_text(self, start: int) -> str:
        """Return the instruction or the header of a block that begins at an offset."""
        text, offset, open_brackets = self.source.text, start, 0
        while offset < len(text):
            character = text[offset]
            if text.startswith("//", offset):
                comment_match = re.compile(r"[^\r\n]*").match(text, offset)
                assert comment_match is not None
                if not open_brackets:
                    break
                offset = comment_match.end()
                continue
            if character in ";~" or (character in "\r\n" and not open_brackets):
                break
            open_brackets += {"(": 1, ")": -1}.get(character, 0)
            offset += 1
        text_without_comments = re.sub(r"//[^\r\n]*", " ", text[start:offset])
        return comment_text(" ".join(text_without_comments.split()))

    def add_comments(self, start: int) -> None:
        """Add the comments of the program before an offset, and those in its line."""
        line = self.source.position(start)[0]
        while self.pending_comments and (
            self.pending_comments[-1].start < start or self.pending_comments[-1].line == line
        ):
            for row in _rows(self.pending_comments.pop().text, MAX_COLUMNS - 2 * self.depth - 3):
                self.add_line(f"// {row}")

    def add_remaining_comments(self) -> None:
        """Add the comments after the last instruction."""
        self.add_comments(len(self.source.text) + 1)

    # -- instructions

    def add_statement(self, statement: ir.Statement) -> None:
        start = statement.span.start
        self.add_comments(start)
        _STATEMENTS[type(statement)](self, statement, self.instruction_text(start))

    def read(self, read: ir.Read, comment: str) -> None:
        name = comment.upper() if comment.replace("_", "").isalnum() else ""
        self.add_line(self.reading_code(read.sensor), name)

    def motors(self, motors: ir.Motors, comment: str) -> None:
        powers = ((motors.left, (-100, 100)), (motors.right, (-100, 100)))
        self.add_call("motors", comment, self.argument_codes(*powers))

    def stop(self, _: ir.Stop, comment: str) -> None:
        self.add_line(f"{self.use('stop_motors')}();", comment)

    def act(self, act: ir.Act, comment: str) -> None:
        """Call the helper that is named as the role of the word."""
        parts = ((value, argument.whole_limits) for argument, value in act.arguments)
        self.add_call(act.word.role.name, comment, self.argument_codes(*parts))

    def assign(self, assign: ir.Assign, comment: str) -> None:
        name = self.names.variables[assign.variable]
        self.add_line(f"{name} = {self.expressions.code_of(assign.value)};", comment)

    def break_(self, _: ir.Break, comment: str) -> None:
        self.add_line("break;", comment)

    def call_def(self, call: ir.Call, comment: str) -> None:
        """Call a function; of its arguments with a RANDOM all but the last come before."""
        arguments, self.argument_values = self.argument_values, []
        texts = [self.expressions.code_of(argument) for argument in arguments]
        for k in [k for k, terms in enumerate(arguments) if has_random(terms)][:-1]:
            kept_name = self.expressions.new_variable()
            self.add_line(f"{kept_name} = {texts[k]};")
            texts[k] = kept_name
        name = self.names.procedures[call.procedure]
        self.add_line(f"{name}({', '.join(texts)});", comment)

    def reading_code(self, sensor: int) -> str:
        self.read_sensors.add(sensor)
        return f"{self.names.readers[sensor]}();"

    def add_call(self, key: str, comment: str, values: Sequence[str]) -> None:
        self.add_line(f"{self.use(key)}({', '.join(values)});", comment)

    # -- arguments

    def argument_codes(self, *parts: Part) -> list[str]:
        """Return arguments; the first one is calculated before, where both have a RANDOM."""
        must_keep = len(parts) > 1 and all(has_random(value) for value, _ in parts)
        texts: list[str] = []
        for value, limits in parts:
            constant_value = constant(value)
            if constant_value is not None:
                rounded_value = (
                    max(0, constant_value)
                    if limits is None
                    else clamp(round_to_whole(constant_value), *limits) * ONE
                )
                texts.append(self.expressions.code_of((Term("NUMBER", rounded_value),)))
                continue
            text = self.expressions.code_of(value)
            if must_keep and not texts:
                kept_name = self.expressions.new_variable()
                self.add_line(f"{kept_name} = {text};")
                text = kept_name
            low, high = limits or (0, 0)
            texts.append(
                text if limits is None else f"{self.use('limited')}({text}, {low}, {high})"
            )
        return texts

    # -- moves and shown values

    def move(self, move: ir.Move, comment: str) -> None:
        if move.until is not None:
            self.move_until(move, move.until, comment)
            return
        assert move.time is not None
        if move.power is None:
            self.add_call("wait", comment, self.move_arguments(move))
        else:
            self.add_call(_MOVE_FUNCTIONS[move.direction], comment, self.move_arguments(move))

    def move_arguments(self, move: ir.Move) -> list[str]:
        if move.unit:
            move = timed_move(move, self.kit)
        parts: list[Part] = [] if move.time is None else [(move.time, None)]
        if move.power is not None:
            parts.append((move.power, (0, 100)))
        texts = self.argument_codes(*parts)
        return texts if move.time is not None else [self.use("FOREVER"), *texts]

    def set(self, statement: ir.Set, comment: str) -> None:
        self.set_actuators.add(statement.actuator)
        device = self.kit.actuators[statement.actuator]
        if device.is_yes_no:
            value = self.expressions.code_of(statement.value)
        else:
            (value,) = self.argument_codes(
                (statement.value, (device.low // ONE, device.high // ONE))
            )
        self.add_line(f"{self.names.setters[statement.actuator]}({value});", comment)

    def move_until(self, move: ir.Move, until: ir.Until, comment: str) -> None:
        self.add_call(
            _START_FUNCTIONS.get(move.direction, "start_wait"), comment, self.move_arguments(move)
        )
        self.add_line(f"while ({self.use('move_lasts')}()) {{")
        self.depth += 1
        condition = self.condition_code(until.reads, until.condition)
        self.add_line(f"if ({condition}) break;")
        self.depth -= 1
        self.add_line("}")
        self.add_line(f"{self.use('end_move')}();")

    def condition_code(self, reads: Sequence[int], condition: ir.Expression) -> str:
        """Return a condition; its readings are taken in it, or in lines before it."""
        if len(reads) == 1 and reads_once(condition, reads[0]):
            return self.expressions.code_of(condition, (reads[0], self.reading_code(reads[0])[:-1]))
        for sensor in reads:
            self.add_line(self.reading_code(sensor))
        return self.expressions.code_of(condition)

    def show(self, show: ir.Show, comment: str) -> None:
        constant_value = constant(show.value)
        self.use("Serial")
        if show.is_yes_no:
            self.add_line(
                f"{self.use('show_yes_no')}({self.expressions.code_of(show.value)});", comment
            )
        elif constant_value is not None:
            self.add_line(f'Serial.println("{as_text(constant_value)}");', comment)
        elif self.expressions.is_exact:
            self.add_line(
                f"{self.use('show_number')}({self.expressions.code_of(show.value)});", comment
            )
        else:
            self.add_line(f"Serial.println({self.expressions.code_of(show.value)});", comment)

    # -- blocks

    def add_block(self, body: ir.Body, is_loop: bool = False) -> None:
        self.depth += 1
        self.loop_depth += is_loop
        self.add_body(body)
        self.loop_depth -= is_loop
        self.depth -= 1

    def if_(self, statement: ir.If, _comment: str) -> None:
        nested_depth = 0
        for k, arm in enumerate(statement.arms):
            text = self.instruction_text(arm.span.start)
            self.add_comments_before_arm(arm.span.start, k)
            line_count_before = len(self.lines)
            is_inline = len(arm.reads) == 1 and reads_once(arm.condition, arm.reads[0])
            if k and arm.reads and not is_inline:
                self.add_line("} else {")
                self.depth += 1
                nested_depth += 1
                condition = self.condition_code(arm.reads, arm.condition)
                self.add_line(f"if ({condition}) {{", text)
            else:
                condition = self.condition_code(arm.reads, arm.condition)
                assert line_count_before == len(self.lines)
                self.add_line(f"{'} else ' if k else ''}if ({condition}) {{", text)
            self.add_block(arm.body)
        if statement.else_body:
            self.add_line("} else {", "ELSE")
            self.add_block(statement.else_body)
        for _ in range(nested_depth):
            self.add_line("}")
            self.depth -= 1
        self.add_line("}")

    def add_comments_before_arm(self, start: int, arm: int) -> None:
        """Add comments before an arm: those of an ELSEIF are in the block before it."""
        self.depth += arm > 0
        self.add_comments(start)
        self.depth -= arm > 0

    def loop(self, loop: ir.Loop, comment: str) -> None:
        if loop.times is None:
            self.add_line("while (true) {", comment)
        else:
            name = counter(self.loop_depth)
            constant_value = constant(loop.times)
            if constant_value is None:
                times = f"{self.use('whole')}({self.expressions.code_of(loop.times)})"
                self.add_line(f"for (long {name} = {times}; {name} > 0; {name}--) {{", comment)
            else:
                count = round_to_whole(constant_value)
                kind = "int" if abs(count) <= _LARGEST_INT else "long"
                self.add_line(f"for ({kind} {name} = 0; {name} < {count}; {name}++) {{", comment)
        self.add_block(loop.body, is_loop=True)
        self.add_line("}")

    def while_(self, loop: ir.While, comment: str) -> None:
        is_inline = len(loop.reads) == 1 and reads_once(loop.condition, loop.reads[0])
        if is_inline or not loop.reads:
            self.add_line(f"while ({self.condition_code(loop.reads, loop.condition)}) {{", comment)
        else:
            self.add_line("while (true) {", comment)
            self.depth += 1
            condition = self.condition_code(loop.reads, loop.condition)
            self.add_line(f"if (!({condition})) break;")
            self.depth -= 1
        self.add_block(loop.body, is_loop=True)
        self.add_line("}")


# A statement of the IR that has no row here is a KeyError, not a sketch that lacks it.
_STATEMENTS: dict[type, Callable[..., None]] = {
    ir.Read: Statements.read,
    ir.Move: Statements.move,
    ir.Motors: Statements.motors,
    ir.Stop: Statements.stop,
    ir.Act: Statements.act,
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
    """Return a text that stays in its comment: without control characters, and without a sign that
    joins lines."""
    return printable(text).replace("??/", "?? /").rstrip("\\ ")


def _truncate(text: str, most_characters: int) -> str:
    return text if len(text) <= most_characters else text[: most_characters - 1] + "…"


def _rows(text: str, most_characters: int) -> list[str]:
    return [
        comment_text(text[start : start + most_characters])
        for start in range(0, len(text), most_characters)
    ] or [""]
