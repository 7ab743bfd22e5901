"""A sketch is put together: its limits, the pins, the program, then the functions it needs.

It first determines which kind of numbers the program needs.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from textwrap import wrap

from tiniscript.base.kit import Kit
from tiniscript.base.source import Source
from tiniscript.codegen.sketch import helpers, numbers
from tiniscript.codegen.sketch.expressions import FUNCTIONS, Expressions, is_float
from tiniscript.codegen.sketch.names import (
    IDENTIFIERS,
    Names,
    note_text,
    translate_locals,
    translated_name,
)
from tiniscript.codegen.sketch.statements import Comment, SketchNames, Statements, comment_text
from tiniscript.codegen.sketch.wiring import SketchPlan, is_exact_as_float, reads_counts
from tiniscript.robots.profile import Robot
from tiniscript.semantics import ir
from tiniscript.semantics.optimizer import constant
from tiniscript.semantics.ways import has_unknown_extent
from tiniscript.syntax.lexer import scan


def needs_numbers(program: ir.Program, robot: Robot) -> bool:
    """Return whether a program calculates, so that it needs exact numbers."""
    kit, wirings = robot.kit, robot.board.sensors
    for statement in ir.all_statements(program):
        if isinstance(statement, ir.Show) and not statement.is_yes_no:
            value = statement.value[0]
            if value.op == "SENSOR" and not reads_counts(
                kit.sensors[value.value], wirings[value.value]
            ):
                return True
        if isinstance(statement, ir.Assign) or any(map(_is_computed, _arguments(statement, robot))):
            return True
        for expression in ir.expressions(statement):
            if any(_needs_arithmetic(term) for term in expression):
                return True
    return not is_exact_as_float(kit.sensors)


def _arguments(statement: ir.Statement, robot: Robot) -> tuple[ir.Expression, ...]:
    """Return the arguments that are numbers."""
    if isinstance(statement, (ir.Move, ir.Motors, ir.Act, ir.Loop)):
        return (*ir.values_of(statement).values(),)
    if isinstance(statement, ir.Set) and not robot.kit.actuators[statement.actuator].is_yes_no:
        return (statement.value,)
    return ()


def _is_computed(expression: ir.Expression) -> bool:
    return constant(expression) is None


def _needs_arithmetic(term: ir.Term) -> bool:
    if term.op == "NUMBER":
        return not is_float(term.value) or abs(term.value) >= 2**24
    return term.op in FUNCTIONS or term.op in ("ADD", "SUB", "MUL", "DIV", "MOD", "NEG", "ABS",
                                               "TIME")  # fmt: skip


MAX_COLUMNS = 98
_WORD = re.compile(r"\$(\w+?)(?=_\$|_PIN\b|\b)")
BOARD_TITLES = {"uno": "Uno", "nano": "Nano", "mega": "Mega 2560"}


def missing_feature(program: ir.Program, kit: Kit) -> str | None:
    """Return a feature of a program that sketches lack: "tasks", "remote" or "ways".

    Tasks are TASK and WHEN, ways are CM and DEG that are calculated. None if a sketch can be
    written.
    """
    statements = list(ir.all_statements(program))
    sensors_read = {statement.sensor for statement in statements if isinstance(statement, ir.Read)}
    if program.tasks:
        return "tasks"
    if any(
        k >= len(kit.sensors) for k in sensors_read | ir.referenced_numbers("SENSOR", statements)
    ):
        return "remote"
    return "ways" if any(map(has_unknown_extent, statements)) else None


def sketch_of(source: Source, program: ir.Program, robot: Robot, language: str) -> str:
    """Return the sketch of a checked program with no `missing_feature`, for a robot on an AVR.

    See `robots.firmware.fits`.
    """
    return _Sketch(source, program, robot, language).sketch_text()


class _Sketch:
    def __init__(self, source: Source, program: ir.Program, robot: Robot, language: str) -> None:
        self.source, self.program, self.robot, self.language = source, program, robot, language
        self.is_exact = needs_numbers(program, robot)
        # For each variable, whether it is a yes-no value.
        self.are_yes_no = ir.yes_no_variables(program, robot.kit)
        self.argument_variables = frozenset(
            k for procedure in program.procedures for k in procedure.values
        )
        self.needed_helpers: dict[str, None] = {}  # helpers, in the order in which they are met
        names = Names(language)
        kit = robot.kit
        devices = (
            [names.name_of(sensor.name) for sensor in kit.sensors],
            [
                names.name_of(sensor.name, translated_name("read", language))
                for sensor in kit.sensors
            ],
            [
                names.name_of(actuator.name, translated_name("set", language))
                for actuator in kit.actuators
            ],
        )
        procedures = [names.name_of(procedure.name) for procedure in program.procedures]
        variables = {
            variable: names.name_of(variable) for variable in dict.fromkeys(program.variables)
        }
        # values of two DEFs may have one name
        self.sketch_names = SketchNames(
            *devices, procedures, [variables[variable] for variable in program.variables]
        )
        self.expressions = Expressions(
            self.use_name, self.is_exact, self.sketch_names.variables, self.sketch_names.sensors
        )
        self.plan = SketchPlan(robot, self.label, self.is_exact)
        self.functions = {**helpers.HELPERS, **numbers.NUMBERS}
        self.functions["to_ms"] = helpers.TO_MS[self.is_exact]
        self.functions["servo_pulse"] = helpers.SERVO_PULSE
        self.functions["begin_servos"] = helpers.BEGIN_SERVOS
        if robot.board.buzzer is None:
            self.functions = {key: _silent(code) for key, code in self.functions.items()}

    def use_name(self, key: str) -> str:
        self.needed_helpers[key] = None
        return translated_name(key, self.language)

    def label(self, name: str) -> str:
        return comment_text(self.robot.labels[self.language][name])

    def translate_code(self, code: str) -> str:
        return translate_locals(code, self.language)

    def text_of_key(self, key: str, **values: str) -> str:
        return note_text(key, self.language).format(**values)

    # -- the whole

    def sketch_text(self) -> str:
        program, statements = self.program, self.statements()
        loop: ir.Body = ()
        body = program.body
        is_ping = program.start == "PING"
        last_statement = body[-1] if body else None
        if (
            isinstance(last_statement, ir.Loop)
            and last_statement.times is None
            and not ir.breaks_out(last_statement.body)
        ):
            body, loop = body[:-1], last_statement.body
        procedures = [
            self.procedure_code(statements, procedure) for procedure in program.procedures
        ]
        statements.variables_set_by_calls = self.argument_variables
        statements.add_body(body)
        if isinstance(last_statement, ir.Loop) and loop:
            start = last_statement.span.start
            statements.add_comments(start)
            statements.add_line(
                f"// {statements.instruction_text(start)}: {self.text_of_key('in_loop')}"
            )
        main_lines, statements.lines = statements.lines, []
        statements.add_body(loop)
        statements.add_remaining_comments()
        repeated_lines, statements.lines = statements.lines, []
        if is_ping:
            main_lines = []
        elif not loop:
            statements.add_line(f"{self.use_name('finish')}();", self.text_of_key("no_more"))
            main_lines += [*repeated_lines, *statements.lines]
            repeated_lines = []
        return self.assemble_text(statements, main_lines, repeated_lines, procedures)

    def statements(self) -> Statements:
        comments = [
            Comment(
                comment.start,
                self.source.position(comment.start)[0],
                comment_text(comment.text[2:].strip()),
            )
            for comment in scan(self.source.text).comments
        ]
        return Statements(
            self.source, self.robot.kit, self.sketch_names, self.expressions, comments
        )

    def procedure_code(self, statements: Statements, procedure: ir.Procedure) -> str:
        statements.depth = 0
        statements.add_comments(procedure.span.start)
        statements.depth = 1
        name = self.sketch_names.procedures[self.program.procedures.index(procedure)]
        comment_lines, statements.lines = statements.lines, []
        statements.variables_set_by_calls = self.argument_variables - {
            *procedure.values
        }  # the DEF sets these itself
        read_variables = ir.referenced_numbers("VARIABLE", ir.walk(procedure.body))
        for k in procedure.values:
            if k not in read_variables:  # a compiler would warn about an unused variable
                statements.add_line(f"(void){self.sketch_names.variables[k]};")
        statements.add_body(procedure.body)
        body, statements.lines = statements.lines, []
        types = ("bool" if self.are_yes_no[k] else "$N" for k in procedure.values)
        names = (self.sketch_names.variables[k] for k in procedure.values)
        header = f"void {name}({', '.join(map(' '.join, zip(types, names, strict=True)))}) {{"
        commented_header = f"{header:<38}  // {statements.instruction_text(procedure.span.start)}"
        return "\n".join([*comment_lines, commented_header, *body, "}"])

    def assemble_text(
        self,
        statements: Statements,
        main_lines: list[str],
        repeated_lines: list[str],
        procedures: list[str],
    ) -> str:
        """Return the sketch; the parts that the program uses are known by now."""
        is_ping, plan = self.program.start == "PING", self.plan
        if not is_ping:
            self.plan.add_motors()
        own_functions = {
            **{
                self.sketch_names.readers[k]: self.plan.reader_code(
                    k, self.sketch_names.sensors[k], self.sketch_names.readers[k]
                )
                for k in sorted(statements.read_sensors)
            },
            **{
                self.sketch_names.setters[k]: self.translate_code(
                    self.plan.setter_code(k, self.sketch_names.setters[k])
                )
                for k in sorted(statements.set_actuators)
            },
        }
        self.functions.update(plan.functions)
        self.functions["halt"] = self.halt_code()
        setup_lines = [] if is_ping else self.setup_lines()
        self.add_needed_helpers(
            [*main_lines, *repeated_lines, *procedures, *own_functions.values(), *setup_lines]
        )
        wiring_functions = [*own_functions.values()]
        kit = self.robot.kit
        introduction = [
            *(
                self.text_of_key("read", name=kit.sensors[k].name)
                for k in sorted(statements.read_sensors)
            ),
            *(
                self.text_of_key("set", name=kit.actuators[k].name)
                for k in sorted(statements.set_actuators)
            ),
        ]
        functions = {
            key: self.translate_code(self.functions[key])
            for key in self.needed_helpers
            if key in self.functions
        }
        commented_lines = [
            *(
                self.with_comment(note, code)
                for note, code in zip(introduction, wiring_functions, strict=True)
            ),
            *(self.with_comment(self.note_comment(key), code) for key, code in functions.items()),
        ]
        all_functions = [*procedures, *wiring_functions, *functions.values()]
        pieces = [
            self.opening_text(),
            "#include <Arduino.h>\n",
            self.constants_code(),
            self.number_struct() if self.is_exact else "",
            self.variables_code(statements),
            self.prototypes_code(all_functions),
            f"void setup() {{\n{_lines(setup_lines, main_lines)}}}\n",
            f"void loop() {{\n{_lines(repeated_lines)}}}\n",
        ]
        if procedures:
            pieces += [
                _heading(self.text_of_key("def")),
                *(f"{procedure}\n" for procedure in procedures),
            ]
        if commented_lines:
            pieces += [_heading(self.text_of_key("helpers")), *commented_lines]
        return self.fill_words("\n".join(piece for piece in pieces if piece))

    # -- its parts

    def setup_lines(self) -> list[str]:
        """Return the first lines of setup()."""
        lines = list(self.plan.begin_lines)
        if self.needs_serial():
            lines.append(f"Serial.begin({self.robot.board.baud});")
        lines.append("pinMode($START_BUTTON_$PIN, INPUT_PULLUP);")
        if self.robot.board.buzzer is not None:
            self.plan.pin("$BUZZER_$PIN", self.robot.board.buzzer)
        self.plan.pin("$START_BUTTON_$PIN", self.robot.board.start_button)
        if self.plan.servo_pins:
            lines.append("$begin_servos();")
        self.needed_helpers["due"] = None
        if self.program.start == "SB":
            lines.append("$wait_for_button();")
        else:
            lines.append("$started = $due = millis();")
        return lines

    def needs_serial(self) -> bool:
        self.add_needed_helpers([])
        return "Serial" in self.needed_helpers or any(
            "Serial" in self.functions.get(key, "") for key in self.needed_helpers
        )

    def halt_code(self) -> str:
        lines = ["$stop_motors();", "noTone($BUZZER_PIN);", *self.plan.off_lines, "while (true) {"]
        body = "\n".join(f"  {line}" for line in lines)
        code = f"void $halt() {{\n{body}\n  }}\n}}"
        return code if self.robot.board.buzzer is not None else _silent(code)

    def add_needed_helpers(self, texts: Iterable[str]) -> None:
        """Find the helpers that texts and other helpers need."""
        helper_by_name = {
            translated_name(key, self.language): key for key in self.functions if key in IDENTIFIERS
        }
        for text in texts:
            for word in re.findall(r"\w+", text):
                if word in helper_by_name and f"{word}(" in text:
                    self.needed_helpers[helper_by_name[word]] = None
            self._note_helpers_in(text)
        pending_keys = list(self.needed_helpers)
        while pending_keys:
            text = self.functions.get(pending_keys.pop(), "")
            needed_before = set(self.needed_helpers)
            self._note_helpers_in(text)
            pending_keys += [key for key in self.needed_helpers if key not in needed_before]

    def _note_helpers_in(self, text: str) -> None:
        for key in re.findall(r"\$([a-z_]+)", text):
            key = key.rstrip("_")
            key = "due" if key == "started" else "move_runs" if key.startswith("move_") and (
                key not in self.functions
            ) else key  # fmt: skip
            self.needed_helpers[key] = None
        if "$is_forever" in text:
            self.needed_helpers["FOREVER"] = None
            if self.is_exact:
                self.needed_helpers["exactly"] = None

    def opening_text(self) -> str:
        file_name = comment_text(self.source.name or "-e")
        robot, board = self.label("robot"), BOARD_TITLES[self.robot.board.chip]
        lines = [self.text_of_key("made", file=file_name, robot=robot, board=board), ""]
        lines.append(self.text_of_key("limits"))
        limits = ["limit_ping"]
        if self.program.start != "PING":
            limits = ["limit_link", "limit_watch", "limit_time"]
            limits += ["limit_si"] if self.program.start == "SI" else []
            limits += [f"limit_{key}" for key in ("random", "fault") if key in self.needed_helpers]
            shows = {"Serial", "show_number", "show_yes_no"} & set(self.needed_helpers)
            limits += ["limit_show"] if shows else []
        baud = str(self.robot.board.baud)
        comment_lines = ["// " + line if line else "//" for line in lines]
        for key in limits:
            comment_lines += _wrap(self.text_of_key(key, baud=baud), "// - ", "//   ")
        return "\n".join(comment_lines) + "\n"

    def constants_code(self) -> str:
        if not self.plan.constant_lines:
            return ""
        heading = f"// {self.text_of_key('pins', robot=self.label('robot'))}"
        return "\n".join([heading, *self.plan.constant_lines]) + "\n"

    def number_struct(self) -> str:
        return self.with_comment(
            self.text_of_key("Number"), self.translate_code(numbers.STRUCT.rstrip())
        )

    def variables_code(self, statements: Statements) -> str:
        """Return the variables of the program, of the readings, and those that functions share."""
        lines = []
        for k, name in enumerate(self.sketch_names.variables):
            if k not in self.argument_variables:
                lines.append(f"bool {name} = false;" if self.are_yes_no[k] else f"$N {name} = 0;")
        named_sensors = ir.referenced_numbers(
            "SENSOR", ir.all_statements(self.program)
        )  # read or not
        for k in sorted(statements.read_sensors | named_sensors):
            kind = self.plan.reading_type(k)
            lines.append(
                f"{kind} {self.sketch_names.sensors[k]} = {'false' if kind == 'bool' else '0'};"
            )
        pieces = ["\n".join([f"// {self.text_of_key('values')}", *lines])] if lines else []
        for key, (note, code) in helpers.SHARED_VARIABLES.items():
            if key in self.needed_helpers:
                pieces.append((f"// {self.text_of_key(note)}\n" if note else "") + code)
        if self.plan.servo_pins:
            pieces.append(helpers.shared_servo_code(self.plan.servo_pins))
        if self.expressions.kept_count:
            shared_names = ", ".join(f"first{k + 1}" for k in range(self.expressions.kept_count))
            pieces.append(f"// {self.text_of_key('shared_first')}\n$N {shared_names};")
        return "\n".join(pieces) + "\n" if pieces else ""

    def prototypes_code(self, codes: Iterable[str]) -> str:
        declarations = [
            f"{line[: line.index('{')].rstrip()};"
            for code in codes
            for line in code.splitlines()
            if re.match(r"(?!ISR|struct)[\w$]+( [\w$]+)* [\w$]+[^\w$ (]*\(.*\) \{", line)
        ]
        if not declarations:
            return ""
        forever_line = helpers.FOREVER[self.is_exact] if "FOREVER" in self.needed_helpers else ""
        lines = [
            f"// {self.text_of_key('prototypes')}",
            *declarations,
            *([forever_line] if forever_line else []),
        ]
        return "\n".join(lines) + "\n"

    def note_comment(self, key: str) -> str:
        if key in ("ADD", "SUB", "MUL", "DIV", "MOD", "NEG"):
            return self.text_of_key("operator")
        if key in numbers.NUMBERS and not self.text_of_key(key):
            return self.text_of_key("compare")
        if key.startswith("start_") and key != "start_wait" and key != "start_move":
            return self.text_of_key("start_forward")
        return self.text_of_key(key)

    def with_comment(self, note: str, code: str) -> str:
        comment = "\n".join(_wrap(note, "// ", "// ")) + "\n" if note else ""
        return f"{comment}{code}\n"

    def fill_words(self, text: str) -> str:
        """Return a text with names in the place of its `$words`."""
        is_forever = self.translate_code(helpers.IS_FOREVER[self.is_exact])
        text = text.replace("$is_forever", is_forever)
        text = re.sub(
            r"\$N\b", translated_name("Number", self.language) if self.is_exact else "float", text
        )

        def name(match: re.Match[str]) -> str:
            return translated_name(match[1], self.language)

        return _WORD.sub(name, text)


def _lines(*parts: list[str]) -> str:
    first_part, *other_parts = parts
    if other_parts:
        first_part = [f"  {line}" for line in first_part]
        if first_part and other_parts[0]:
            first_part.append("")
    return "".join(
        f"{line}\n" for line in (*first_part, *(row for rows in other_parts for row in rows))
    )


def _silent(code: str) -> str:
    """Return a helper for a robot without a buzzer: a sound takes its time."""
    return "\n".join(line for line in code.split("\n") if "$BUZZER_PIN" not in line)


def _heading(text: str) -> str:
    return f"// {'-' * 4} {text} {'-' * max(4, 90 - len(text))}\n"


def _wrap(text: str, first_indent: str, next_indent: str) -> list[str]:
    return wrap(text, MAX_COLUMNS, initial_indent=first_indent, subsequent_indent=next_indent)
