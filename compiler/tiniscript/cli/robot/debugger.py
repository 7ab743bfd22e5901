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
MOST_LINES = 10**6


class Halting(NamedTuple):
    """A program that may halt: its text is seen from the line `first` on, and there it halts."""

    code: bytes
    map: Map
    first: int = 1

    def has(self, place: MapLocation) -> bool:
        """Whether a place is one of the text that is seen; what comes from nowhere has no width."""
        return place.line >= self.first and place[1:3] != place[3:]

    def place_at(self, statements: Sequence[int], at: int) -> MapLocation | None:
        """Return the last instruction of the text that begins before the next statement does."""
        following = next((start for start in statements if start > at), at + 1)
        place = self.map.at(following - 1)
        return place if place is not None and self.has(place) else None


def lines_of(given: Sequence[str], language: str) -> tuple[int, ...]:
    """Return the lines of `--break`. Raises CommandError."""
    lines = {whole_number("--break", line, 1, 1, MOST_LINES, language) for line in given}
    if len(lines) > MOST_BREAKPOINTS:
        raise CommandError(2, "break_most", most=str(MOST_BREAKPOINTS))
    return tuple(sorted(lines))


def places_of(lines: Sequence[int], halting: Halting) -> tuple[int, ...]:
    """Return the offset of the first statement from each line on. Raises CommandError."""
    statements = statement_starts(halting.code)
    offsets = []
    for line in lines:
        places = [
            statement_of(statements, place.offset)
            for place in halting.map.places
            if place.line >= halting.first + line - 1 and halting.has(place)
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
        self, connection: Connection, printer: EventPrinter, halting: Halting,
        first_places: Sequence[int] | None = None,
    ) -> None:  # fmt: skip
        """What began halted gets its places where it did."""
        self.connection = connection
        self.printer = printer
        self.halting = halting
        self.map = halting.map
        self.statements = statement_starts(halting.code)
        self.first_places = first_places
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
        if self.first_places is not None:
            places, self.first_places = self.first_places, None
            self.connection.request(lambda session: session.break_at(places))
            if event.at not in places:
                self._resume(RESUME_GO)
                return True
        place = self.halting.place_at(self.statements, event.at)
        is_inside = place is None or statement_of(self.statements, place.offset) != event.at
        if self.is_stepping and is_inside:  # of one instruction of the text, or not of what is seen
            self._resume(RESUME_STEP)
            return True
        self._print_halt(event.at, event.task, place)
        self.is_halted = True
        if not self.has_keys:
            self._resume(RESUME_GO)
        return True

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
        line = 0 if place is None else place.line - self.halting.first + 1
        what = "" if place is None else self.map.line(place.line)[place.column - 1 :].split(";")[0]
        texts = [text("halted", language).format(line=line, what=what.strip())]
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
                result.append((state, place.line - self.halting.first + 1))
        return result
