"""Halts a program at lines of its text, says where it is, and lets a person step it at the keys."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from functools import partial
from struct import iter_unpack

from tiniscript.base.fixed_point import value_of, value_text
from tiniscript.bytecode.statements import statement_of, statement_starts
from tiniscript.cli.errors import CommandError
from tiniscript.cli.images import ReadyProgram
from tiniscript.cli.options import whole_number
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.event_printer import EventPrinter
from tiniscript.cli.terminal.keys import Keys, is_in_front, letters_of
from tiniscript.cli.texts import text
from tiniscript.library.source_map import Map, MapLocation
from tiniscript.link.connection import Requester
from tiniscript.link.messages import (
    BREAKPOINTS,
    MOST_BREAKPOINTS,
    RESUME_GO,
    RESUME_STEP,
    STATUSES,
    TASK_STATES,
)
from tiniscript.link.outcomes import Event
from tiniscript.link.requests import Reply

STEP, GO = "sS \n\r", "gG"  # keys


def places_of(
    line_texts: Sequence[str], ready_program: ReadyProgram, language: str
) -> tuple[int, ...]:
    """Return the offset of the first statement from each line on. Raises CommandError."""
    lines = [whole_number("--break", line, 1, 1, 10**6, language) for line in line_texts]
    if ready_program.places is None:
        raise CommandError(2, "break_image")
    if len(set(lines)) > MOST_BREAKPOINTS:
        raise CommandError(2, "break_most", most=str(MOST_BREAKPOINTS))
    statements = statement_starts(ready_program.image.code)
    offsets = []
    for line in lines:
        places = [
            statement_of(statements, place.offset)
            for place in ready_program.places.places
            if place.line >= line
        ]
        if not places:
            raise CommandError(1, "break_nowhere", line=str(line))
        offsets.append(min(places))
    return tuple(sorted(set(offsets)))


def require_breakpoints(connection: Connection) -> None:
    """Raise CommandError where the robot halts nothing."""
    if not connection.device_info.values.features & BREAKPOINTS:
        raise connection.failure(Reply(STATUSES["NO_BREAKPOINTS"]))


class Debugger:
    """Tells where a program halts. At a terminal a key steps it or lets it go on; elsewhere it goes
    on by itself."""

    def __init__(
        self, connection: Connection, printer: EventPrinter, ready_program: ReadyProgram
    ) -> None:
        assert ready_program.places is not None
        self.connection = connection
        self.printer = printer
        self.map: Map = ready_program.places
        self.statements = statement_starts(ready_program.image.code)
        self.keys = Keys()
        self.has_keys = sys.stdin.isatty() and is_in_front() and not printer.is_json
        self.is_halted = False
        self.is_stepping = False

    def __enter__(self) -> Debugger:
        if self.has_keys:
            self.keys.__enter__()
        return self

    def __exit__(self, *raised: object) -> None:
        if self.has_keys:
            self.keys.__exit__(*raised)

    def hold(self, event: Event) -> bool:
        """Take an event; return whether it is told."""
        if event.name != "HALTED":
            return False
        place = self._place(event.at)
        is_inside_statement = (
            place is not None and statement_of(self.statements, place.offset) != event.at
        )
        if self.is_stepping and is_inside_statement:  # of one instruction of the text
            self._resume(RESUME_STEP)
            return True
        self._print_halt(event.at, event.task, place)
        self.is_halted = True
        if not self.has_keys:
            self._resume(RESUME_GO)
        return True

    def _place(self, at: int) -> MapLocation | None:
        """Return the last instruction of the text that begins before the next statement does."""
        following = next((start for start in self.statements if start > at), at + 1)
        return self.map.at(following - 1)

    def look(self) -> None:
        """Do what the first key says that was pressed at this halt; while the program runs, none
        does anything."""
        letters = letters_of(self.keys.read_pressed()) if self.has_keys else ""
        key = next((key for key in letters if key in STEP + GO), "")
        if key and self.is_halted:
            self._resume(RESUME_STEP if key in STEP else RESUME_GO)

    def _resume(self, resume_kind: int) -> None:
        self.is_halted, self.is_stepping = False, resume_kind == RESUME_STEP
        self.connection.request(lambda session: session.resume(resume_kind))

    def _print_halt(self, at: int, task: int, place: MapLocation | None) -> None:
        language = self.printer.language
        variables = self._variables()
        tasks = self._tasks(task)
        line = 0 if place is None else place.line
        instruction = "" if place is None else self.map.line(line)[place.column - 1 :].split(";")[0]
        texts = [text("halted", language).format(line=line, what=instruction.strip())]
        values = ", ".join(
            f"{name} = {value_text(value, is_yes_no)}" for name, value, is_yes_no in variables
        )
        texts += [f"  {values}"] * bool(values)
        for state, where in tasks:
            key = f"halted_task_{TASK_STATES[state][0]}"
            texts.append("  " + text(key, language).format(line=where))
        if self.has_keys:
            texts.append(text("halted_keys", language))
        self.printer.say(
            0, "HALTED", str(line), "\n".join(texts), line=line, at=at,
            variables={name: value_of(value, is_yes_no) for name, value, is_yes_no in variables},
            tasks=[{"state": TASK_STATES[state][0], "line": where} for state, where in tasks],
        )  # fmt: skip

    def _variables(self) -> list[tuple[str, int, bool]]:
        """Return name, value in thousandths and whether it is a yes/no of the variables that have
        names."""
        names, values = self.map.variables, list[int]()
        while len(values) < len(names):
            reply = self.connection.request(partial(Requester.read_variables, first=len(values)))
            values_part = [value for (value,) in iter_unpack("<i", reply.values.values)]
            if not values_part:
                break
            values += values_part
        yes_no = self.map.yes_no or [False] * len(names)  # of a map of an earlier version
        return list(zip(names, values, yes_no, strict=False))

    def _tasks(self, halted_task: int) -> list[tuple[int, int]]:
        """Return state and line of each task beside the one that is halted, and has not ended."""
        reply = self.connection.request(lambda session: session.read_tasks())
        result = []
        for number, (state, at, _) in enumerate(iter_unpack("<BHI", reply.values.tasks)):
            place = self.map.at(at)
            if number != halted_task and state and place is not None:
                result.append((state, place.line))
        return result
