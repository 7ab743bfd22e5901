"""Halts a program at lines of its text, says where it is, and lets a person step it at the keys."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from functools import partial
from struct import iter_unpack
from typing import NamedTuple

from tiniscript.base.fixed_point import value_of, value_text
from tiniscript.bytecode.statements import statement_of, statement_starts
from tiniscript.cli.errors import CommandError
from tiniscript.cli.options import whole_number
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.event_printer import EventPrinter
from tiniscript.cli.terminal.keys import Keys, is_in_front, letters_of
from tiniscript.cli.texts import text
from tiniscript.library.source_map import MapLocation, SourceMap
from tiniscript.link.connection import Requester
from tiniscript.link.messages import (
    BREAKPOINTS,
    MAX_BREAKPOINTS,
    RESUME_GO,
    RESUME_STEP,
    STATUSES,
    TASK_STATES,
)
from tiniscript.link.outcomes import Event
from tiniscript.link.requests import Reply

STEP_KEYS, GO_KEYS = "sS \n\r", "gG"  # keys
MAX_LINES = 10**6


class HaltableProgram(NamedTuple):
    """A program that may halt: its text is seen from the line `first_line` on, and there it
    halts."""

    code: bytes
    map: SourceMap
    first_line: int = 1

    def has_location(self, location: MapLocation) -> bool:
        """Return whether a location is in the visible text; generated code has no width."""
        return location.line >= self.first_line and location[1:3] != location[3:]

    def location_at(self, statement_offsets: Sequence[int], offset: int) -> MapLocation | None:
        """Return the last instruction of the text that begins before the next statement does."""
        next_offset = next((start for start in statement_offsets if start > offset), offset + 1)
        location = self.map.location_at(next_offset - 1)
        return location if location is not None and self.has_location(location) else None


def parse_lines(typed_lines: Sequence[str], language: str) -> tuple[int, ...]:
    """Return the lines of `--break`. Raises CommandError."""
    lines = {whole_number("--break", line, 1, 1, MAX_LINES, language) for line in typed_lines}
    if len(lines) > MAX_BREAKPOINTS:
        raise CommandError(2, "break_most", most=str(MAX_BREAKPOINTS))
    return tuple(sorted(lines))


def breakpoint_offsets(lines: Sequence[int], program: HaltableProgram) -> tuple[int, ...]:
    """Return the offset of the first statement from each line on. Raises CommandError."""
    statement_offsets = statement_starts(program.code)
    offsets = []
    for line in lines:
        line_offsets = [
            statement_of(statement_offsets, location.offset)
            for location in program.map.locations
            if location.line >= program.first_line + line - 1 and program.has_location(location)
        ]
        if not line_offsets:
            raise CommandError(1, "break_nowhere", line=str(line))
        offsets.append(min(line_offsets))
    return tuple(sorted(set(offsets)))


def require_breakpoints(connection: Connection) -> None:
    """Raise CommandError if the robot cannot halt programs."""
    if not connection.device_info.values.features & BREAKPOINTS:
        raise connection.error_for_reply(Reply(STATUSES["NO_BREAKPOINTS"]))


class Debugger:
    """Tells where a program halts. At a terminal, a key steps or resumes it; elsewhere it resumes
    by itself."""

    def __init__(
        self, connection: Connection, printer: EventPrinter, program: HaltableProgram,
        first_breakpoints: Sequence[int] | None = None,
    ) -> None:  # fmt: skip
        """Start the debugger; a program that began halted gets its breakpoints at its start."""
        self.connection = connection
        self.printer = printer
        self.program = program
        self.map = program.map
        self.statement_offsets = statement_starts(program.code)
        self.first_breakpoints = first_breakpoints
        self.keys = Keys()
        self.has_keys = sys.stdin.isatty() and is_in_front() and not printer.is_json
        self.is_halted = False
        self.is_stepping = False

    def __enter__(self) -> Debugger:
        if self.has_keys:
            self.keys.__enter__()
        return self

    def __exit__(self, *signal_arguments: object) -> None:
        if self.has_keys:
            self.keys.__exit__(*signal_arguments)

    def hold_event(self, event: Event) -> bool:
        """Process an event; return whether to print it."""
        if event.name != "HALTED":
            return False
        if self.first_breakpoints is not None:
            breakpoints, self.first_breakpoints = self.first_breakpoints, None
            self.connection.request(lambda session: session.break_at(breakpoints))
            if event.offset not in breakpoints:
                self._resume(RESUME_GO)
                return True
        location = self.program.location_at(self.statement_offsets, event.offset)
        is_inside = (
            location is None
            or statement_of(self.statement_offsets, location.offset) != event.offset
        )
        # The step covers one instruction of the text, or one that is not shown.
        if self.is_stepping and is_inside:
            self._resume(RESUME_STEP)
            return True
        self._print_halt(event.offset, event.task, location)
        self.is_halted = True
        if not self.has_keys:
            self._resume(RESUME_GO)
        return True

    def poll_keys(self) -> None:
        """Obey the first key pressed at this halt; while the program runs, keys have no effect."""
        letters = letters_of(self.keys.read_keys()) if self.has_keys else ""
        key = next((key for key in letters if key in STEP_KEYS + GO_KEYS), "")
        if key and self.is_halted:
            self._resume(RESUME_STEP if key in STEP_KEYS else RESUME_GO)

    def _resume(self, resume_kind: int) -> None:
        self.is_halted, self.is_stepping = False, resume_kind == RESUME_STEP
        self.connection.request(lambda session: session.resume(resume_kind))

    def _print_halt(self, offset: int, task: int, location: MapLocation | None) -> None:
        language = self.printer.language
        variables = self._variables()
        tasks = self._tasks(task)
        line = 0 if location is None else location.line - self.program.first_line + 1
        instruction_text = (
            ""
            if location is None
            else self.map.line(location.line)[location.column - 1 :].split(";")[0]
        )
        sentences = [text("halted", language).format(line=line, what=instruction_text.strip())]
        values = ", ".join(
            f"{name} = {value_text(value, is_yes_no)}" for name, value, is_yes_no in variables
        )
        sentences += [f"  {values}"] * bool(values)
        for state, task_line in tasks:
            key = f"halted_task_{TASK_STATES[state][0]}"
            sentences.append("  " + text(key, language).format(line=task_line))
        if self.has_keys:
            sentences.append(text("halted_keys", language))
        self.printer.print_values(
            0,
            "HALTED",
            str(line),
            "\n".join(sentences),
            line=line,
            at=offset,
            variables={name: value_of(value, is_yes_no) for name, value, is_yes_no in variables},
            tasks=[
                {"state": TASK_STATES[state][0], "line": task_line} for state, task_line in tasks
            ],
        )

    def _variables(self) -> list[tuple[str, int, bool]]:
        """Return name, value in thousandths and whether it is a yes/no of the variables that have
        names."""
        names, values = self.map.variables, list[int]()
        while len(values) < len(names):
            reply = self.connection.request(partial(Requester.read_variables, first=len(values)))
            chunk = [value for (value,) in iter_unpack("<i", reply.values.values)]
            if not chunk:
                break
            values += chunk
        yes_no_flags = self.map.yes_no_flags or [False] * len(
            names
        )  # the map may be of an earlier version
        return list(zip(names, values, yes_no_flags, strict=False))

    def _tasks(self, halted_task: int) -> list[tuple[int, int]]:
        """Return state and line of each task that has not ended, except the halted one."""
        reply = self.connection.request(lambda session: session.read_tasks())
        task_rows = []
        for number, (state, offset, _) in enumerate(iter_unpack("<BHI", reply.values.tasks)):
            location = self.map.location_at(offset)
            if number != halted_task and state and location is not None:
                task_rows.append((state, location.line - self.program.first_line + 1))
        return task_rows
