"""A sketch is put together: its limits, the pins, the program, then the functions it needs.

Which kind of numbers it needs is found first.
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
from tiniscript.semantics.ways import is_open_way
from tiniscript.syntax.lexer import scan


def needs_numbers(program: ir.Program, robot: Robot) -> bool:
    """Whether a program calculates: then it needs numbers that are exact."""
    kit, wired = robot.kit, robot.board.sensors
    for statement in ir.all_statements(program):
        if isinstance(statement, ir.Show) and not statement.is_yes_no:
            value = statement.value[0]
            if value.op == "SENSOR" and not reads_counts(
                kit.sensors[value.value], wired[value.value]
            ):
                return True
        if isinstance(statement, ir.Assign) or any(map(_is_computed, _arguments(statement, robot))):
            return True
        for expression in ir.expressions(statement):
            if any(_needs_arithmetic(term) for term in expression):
                return True
    return not is_exact_as_float(kit.sensors)


def _arguments(statement: ir.Statement, robot: Robot) -> tuple[ir.Expression | None, ...]:
    """Return the arguments that are numbers."""
    if isinstance(statement, ir.Move):
        return statement.time, statement.power
    if isinstance(statement, ir.Motors):
        return statement.left, statement.right
    if isinstance(statement, ir.Beep):
        return statement.time, statement.hertz
    if isinstance(statement, ir.Loop):
        return (statement.times,)
    if isinstance(statement, ir.Set) and not robot.kit.actuators[statement.actuator].is_yes_no:
        return (statement.value,)
    return ()


def _is_computed(expression: ir.Expression | None) -> bool:
    return expression is not None and constant(expression) is None


def _needs_arithmetic(term: ir.Term) -> bool:
    if term.op == "NUMBER":
        return not is_float(term.value) or abs(term.value) >= 2**24
    return term.op in FUNCTIONS or term.op in ("ADD", "SUB", "MUL", "DIV", "MOD", "NEG", "ABS",
                                               "TIME")  # fmt: skip


MOST_COLUMNS = 98
_WORD = re.compile(r"\$(\w+?)(?=_\$|_PIN\b|\b)")
BOARD_TITLES = {"uno": "Uno", "nano": "Nano", "mega": "Mega 2560"}


def missing_feature(program: ir.Program, kit: Kit) -> str | None:
    """Return what a program needs and no sketch has: "tasks", "remote" or "ways".

    Tasks are TASK and WHEN, ways are CM and DEG that are calculated. None where there is a sketch.
    """
    statements = list(ir.all_statements(program))
    sensors_read = {statement.sensor for statement in statements if isinstance(statement, ir.Read)}
    if program.tasks:
        return "tasks"
    if any(
        k >= len(kit.sensors) for k in sensors_read | ir.referenced_numbers("SENSOR", statements)
    ):
        return "remote"
    return "ways" if any(map(is_open_way, statements)) else None


def sketch_of(source: Source, program: ir.Program, robot: Robot, language: str) -> str:
    """Return the sketch of a checked program with no `missing_feature`, for a robot on an AVR.

    See `robots.firmware.fits`.
    """
    return _Sketch(source, program, robot, language).text()


class _Sketch:
    def __init__(self, source: Source, program: ir.Program, robot: Robot, language: str) -> None:
        self.source, self.program, self.robot, self.language = source, program, robot, language
        self.is_exact = needs_numbers(program, robot)
        self.yes_no = ir.yes_no_variables(program, robot.kit)  # of each variable
        self.arguments = frozenset(k for procedure in program.procedures for k in procedure.values)
        self.needed: dict[str, None] = {}  # helpers, in the order in which they are met
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
        self.named = SketchNames(
            *devices, procedures, [variables[variable] for variable in program.variables]
        )
        self.write = Expressions(self.use, self.is_exact, self.named.variables, self.named.sensors)
        self.plan = SketchPlan(robot, self.label, self.is_exact)
        self.functions = {**helpers.HELPERS, **numbers.NUMBERS}
        self.functions["to_ms"] = helpers.TO_MS[self.is_exact]
        self.functions["servo_pulse"] = helpers.SERVO_PULSE
        self.functions["begin_servos"] = helpers.BEGIN_SERVOS
        if robot.board.buzzer is None:
            self.functions = {key: _silent(code) for key, code in self.functions.items()}

    def use(self, key: str) -> str:
        self.needed[key] = None
        return translated_name(key, self.language)

    def label(self, name: str) -> str:
        return comment_text(self.robot.labels[self.language][name])

    def translate_code(self, code: str) -> str:
        return translate_locals(code, self.language)

    def text_of_key(self, key: str, **values: str) -> str:
        return note_text(key, self.language).format(**values)

    # -- the whole

    def text(self) -> str:
        program, rows = self.program, self.statements()
        loop: ir.Body = ()
        body = program.body
        is_ping = program.start == "PING"
        last = body[-1] if body else None
        if isinstance(last, ir.Loop) and last.times is None and not ir.breaks_out(last.body):
            body, loop = body[:-1], last.body
        procedures = [self.procedure(rows, procedure) for procedure in program.procedures]
        rows.variables_set_by_calls = self.arguments
        rows.body(body)
        if isinstance(last, ir.Loop) and loop:
            start = last.span.start
            rows.remarks(start)
            rows.line(f"// {rows.instruction_text(start)}: {self.text_of_key('in_loop')}")
        main_lines, rows.lines = rows.lines, []
        rows.body(loop)
        rows.remaining_comments()
        repeated_lines, rows.lines = rows.lines, []
        if is_ping:
            main_lines = []
        elif not loop:
            rows.line(f"{self.use('finish')}();", self.text_of_key("no_more"))
            main_lines += [*repeated_lines, *rows.lines]
            repeated_lines = []
        return self.layout(rows, main_lines, repeated_lines, procedures)

    def statements(self) -> Statements:
        comments = [
            Comment(
                comment.start,
                self.source.position(comment.start)[0],
                comment_text(comment.text[2:].strip()),
            )
            for comment in scan(self.source.text).comments
        ]
        return Statements(self.source, self.robot.kit, self.named, self.write, comments)

    def procedure(self, rows: Statements, procedure: ir.Procedure) -> str:
        rows.depth = 0
        rows.remarks(procedure.span.start)
        rows.depth = 1
        name = self.named.procedures[self.program.procedures.index(procedure)]
        head, rows.lines = rows.lines, []
        rows.variables_set_by_calls = self.arguments - {
            *procedure.values
        }  # those of this DEF it sets itself
        variables_read = ir.referenced_numbers("VARIABLE", ir.walk(procedure.body))
        for k in procedure.values:
            if k not in variables_read:  # or a compiler warns
                rows.line(f"(void){self.named.variables[k]};")
        rows.body(procedure.body)
        body, rows.lines = rows.lines, []
        types = ("bool" if self.yes_no[k] else "$N" for k in procedure.values)
        names = (self.named.variables[k] for k in procedure.values)
        header = f"void {name}({', '.join(map(' '.join, zip(types, names, strict=True)))}) {{"
        commented_header = f"{header:<38}  // {rows.instruction_text(procedure.span.start)}"
        return "\n".join([*head, commented_header, *body, "}"])

    def layout(
        self,
        rows: Statements,
        main_lines: list[str],
        repeated_lines: list[str],
        procedures: list[str],
    ) -> str:
        """Return the sketch; what the program uses is known by now."""
        is_ping, parts = self.program.start == "PING", self.plan
        if not is_ping:
            self.plan.motors()
        own_functions = {
            **{
                self.named.reads[k]: self.plan.reader(k, self.named.sensors[k], self.named.reads[k])
                for k in sorted(rows.read_sensors)
            },
            **{
                self.named.sets[k]: self.translate_code(self.plan.setter(k, self.named.sets[k]))
                for k in sorted(rows.set_actuators)
            },
        }
        self.functions.update(parts.functions)
        self.functions["halt"] = self.halt()
        begin = [] if is_ping else self.begin()
        self.add_needed_helpers(
            [*main_lines, *repeated_lines, *procedures, *own_functions.values(), *begin]
        )
        wiring_functions = [*own_functions.values()]
        kit = self.robot.kit
        introduction = [
            *(
                self.text_of_key("read", name=kit.sensors[k].name)
                for k in sorted(rows.read_sensors)
            ),
            *(
                self.text_of_key("set", name=kit.actuators[k].name)
                for k in sorted(rows.set_actuators)
            ),
        ]
        functions = {
            key: self.translate_code(self.functions[key])
            for key in self.needed
            if key in self.functions
        }
        commented_lines = [
            *(
                self.with_comment(note, code)
                for note, code in zip(introduction, wiring_functions, strict=True)
            ),
            *(self.with_comment(self.note(key), code) for key, code in functions.items()),
        ]
        all_functions = [*procedures, *wiring_functions, *functions.values()]
        pieces = [
            self.opening(),
            "#include <Arduino.h>\n",
            self.constants(),
            self.number() if self.is_exact else "",
            self.variables(rows),
            self.prototypes(all_functions),
            f"void setup() {{\n{_lines(begin, main_lines)}}}\n",
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

    def begin(self) -> list[str]:
        """Return what setup() does first."""
        lines = list(self.plan.begin_lines)
        if self.needs_serial():
            lines.append(f"Serial.begin({self.robot.board.baud});")
        lines.append("pinMode($START_BUTTON_$PIN, INPUT_PULLUP);")
        if self.robot.board.buzzer is not None:
            self.plan.pin("$BUZZER_$PIN", self.robot.board.buzzer)
        self.plan.pin("$START_BUTTON_$PIN", self.robot.board.start_button)
        if self.plan.servo_pins:
            lines.append("$begin_servos();")
        self.needed["due"] = None
        if self.program.start == "SB":
            lines.append("$wait_for_button();")
        else:
            lines.append("$started = $due = millis();")
        return lines

    def needs_serial(self) -> bool:
        self.add_needed_helpers([])
        return "Serial" in self.needed or any(
            "Serial" in self.functions.get(key, "") for key in self.needed
        )

    def halt(self) -> str:
        lines = ["$stop_motors();", "noTone($BUZZER_PIN);", *self.plan.off_lines, "while (true) {"]
        body = "\n".join(f"  {line}" for line in lines)
        code = f"void $halt() {{\n{body}\n  }}\n}}"
        return code if self.robot.board.buzzer is not None else _silent(code)

    def add_needed_helpers(self, texts: Iterable[str]) -> None:
        """Find the helpers that texts and other helpers need."""
        by_name = {
            translated_name(key, self.language): key for key in self.functions if key in IDENTIFIERS
        }
        for text in texts:
            for word in re.findall(r"\w+", text):
                if word in by_name and f"{word}(" in text:
                    self.needed[by_name[word]] = None
            self._names_in(text)
        pending_keys = list(self.needed)
        while pending_keys:
            text = self.functions.get(pending_keys.pop(), "")
            before = set(self.needed)
            self._names_in(text)
            pending_keys += [key for key in self.needed if key not in before]

    def _names_in(self, text: str) -> None:
        for key in re.findall(r"\$([a-z_]+)", text):
            key = key.rstrip("_")
            key = "due" if key == "started" else "move_runs" if key.startswith("move_") and (
                key not in self.functions
            ) else key  # fmt: skip
            self.needed[key] = None
        if "$is_forever" in text:
            self.needed["FOREVER"] = None
            if self.is_exact:
                self.needed["exactly"] = None

    def opening(self) -> str:
        file = comment_text(self.source.name or "-e")
        robot, board = self.label("robot"), BOARD_TITLES[self.robot.board.chip]
        rows = [self.text_of_key("made", file=file, robot=robot, board=board), ""]
        rows.append(self.text_of_key("limits"))
        limits = ["limit_ping"]
        if self.program.start != "PING":
            limits = ["limit_link", "limit_watch", "limit_time"]
            limits += ["limit_si"] if self.program.start == "SI" else []
            limits += [f"limit_{key}" for key in ("random", "fault") if key in self.needed]
            shows = {"Serial", "show_number", "show_yes_no"} & set(self.needed)
            limits += ["limit_show"] if shows else []
        baud = str(self.robot.board.baud)
        lines = ["// " + row if row else "//" for row in rows]
        for key in limits:
            lines += _wrap(self.text_of_key(key, baud=baud), "// - ", "//   ")
        return "\n".join(lines) + "\n"

    def constants(self) -> str:
        if not self.plan.constant_lines:
            return ""
        head = f"// {self.text_of_key('pins', robot=self.label('robot'))}"
        return "\n".join([head, *self.plan.constant_lines]) + "\n"

    def number(self) -> str:
        return self.with_comment(
            self.text_of_key("Number"), self.translate_code(numbers.STRUCT.rstrip())
        )

    def variables(self, rows: Statements) -> str:
        """Return the variables of the program, of the readings, and those that functions share."""
        lines = []
        for k, name in enumerate(self.named.variables):
            if k not in self.arguments:
                lines.append(f"bool {name} = false;" if self.yes_no[k] else f"$N {name} = 0;")
        named_sensors = ir.referenced_numbers(
            "SENSOR", ir.all_statements(self.program)
        )  # read or not
        for k in sorted(rows.read_sensors | named_sensors):
            kind = self.plan.kind(k)
            lines.append(f"{kind} {self.named.sensors[k]} = {'false' if kind == 'bool' else '0'};")
        pieces = ["\n".join([f"// {self.text_of_key('values')}", *lines])] if lines else []
        for key, (note, code) in helpers.SHARED.items():
            if key in self.needed:
                pieces.append((f"// {self.text_of_key(note)}\n" if note else "") + code)
        if self.plan.servo_pins:
            pieces.append(helpers.shared_servo_code(self.plan.servo_pins))
        if self.write.kept:
            shared_names = ", ".join(f"first{k + 1}" for k in range(self.write.kept))
            pieces.append(f"// {self.text_of_key('shared_first')}\n$N {shared_names};")
        return "\n".join(pieces) + "\n" if pieces else ""

    def prototypes(self, codes: Iterable[str]) -> str:
        declarations = [
            f"{line[: line.index('{')].rstrip()};"
            for code in codes
            for line in code.splitlines()
            if re.match(r"(?!ISR|struct)[\w$]+( [\w$]+)* [\w$]+[^\w$ (]*\(.*\) \{", line)
        ]
        if not declarations:
            return ""
        last = helpers.FOREVER[self.is_exact] if "FOREVER" in self.needed else ""
        lines = [f"// {self.text_of_key('prototypes')}", *declarations, *([last] if last else [])]
        return "\n".join(lines) + "\n"

    def note(self, key: str) -> str:
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
    first, *others = parts
    if others:
        first = [f"  {line}" for line in first]
        if first and others[0]:
            first.append("")
    return "".join(f"{line}\n" for line in (*first, *(row for rows in others for row in rows)))


def _silent(code: str) -> str:
    """Return a helper for a robot without a buzzer: a sound takes its time."""
    return "\n".join(line for line in code.split("\n") if "$BUZZER_PIN" not in line)


def _heading(text: str) -> str:
    return f"// {'-' * 4} {text} {'-' * max(4, 90 - len(text))}\n"


def _wrap(text: str, first: str, other: str) -> list[str]:
    return wrap(text, MOST_COLUMNS, initial_indent=first, subsequent_indent=other)
