"""Prints a robot's events during a run: SHOW values, faults with their lines, the end.

The formats are sentences, lines of JSON, and rows of a CSV file.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Mapping

from tiniscript.base.fixed_point import value_of, value_text
from tiniscript.cli.faults import fault_text
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.spreadsheet import escape_formula
from tiniscript.cli.texts import has_text, text
from tiniscript.library import source_map
from tiniscript.library.shows import Show, ShowFinder
from tiniscript.library.source_map import SourceMap
from tiniscript.link.names import cause_name, fault_name
from tiniscript.link.outcomes import Event, ShownEvent
from tiniscript.link.payloads import ReadingEvent


def fault_sentence(
    fault_number: int, offset: int, checksum: int, program_map: SourceMap | None, language: str
) -> str:
    """Return the meaning of a fault, and its line in the program if the text is known."""
    is_recalled = program_map is None
    program_map = source_map.recall(checksum) if program_map is None else program_map
    name = fault_name(fault_number)
    if not has_text(f"fault_{name}"):
        return text("fault_unknown", language).format(number=fault_number)
    return fault_text(name, offset, program_map, is_recalled, language)


def _print_line(line: str) -> None:
    print(line, flush=True)


def _print_error(line: str) -> None:
    sys.stdout.flush()
    print(line, file=sys.stderr, flush=True)


class EventPrinter:
    """Prints events. `has_times`: each with the milliseconds since `began_ms`, else the first.

    `program_map` is the map of the program that is followed, `program` its checksum, and
    `whole_map` its map including code that a person has not typed, if there is any. `add_row` gets
    the cells of each event, for a CSV file. `print_line` and `print_error` replace `print` while a
    picture is on the terminal. JSON lines also get the `robot_fields`.
    """

    def __init__(
        self,
        language: str,
        is_json: bool = False,
        has_times: bool = False,
        program_map: SourceMap | None = None,
        add_row: Callable[[int, str, str, str], None] | None = None,
        print_line: Callable[[str], None] | None = None,
        print_error: Callable[[str], None] | None = None,
        robot_fields: Mapping[str, object] | None = None,
        began_ms: int | None = None,
        checksum: int | None = None,
        whole_map: SourceMap | None = None,
    ) -> None:
        self.language = language
        self.is_json = is_json
        self.has_times = has_times
        self.program_map = program_map
        shown_map = whole_map or program_map
        self.shows = ShowFinder(
            {} if shown_map is None or checksum is None else {checksum: shown_map}
        )
        self.has_lines = whole_map is None  # whether a person knows the line numbers
        self.add_row = add_row
        # Printed only on request.
        self.readings: Callable[[ReadingEvent], None] | None = None
        self.print_line = print_line or _print_line
        self.print_error = print_error or _print_error
        self.robot_fields = robot_fields or {}
        self.began_ms = began_ms

    def print_event(self, time_ms: int, event: Event) -> None:
        if self.began_ms is None:
            self.began_ms = time_ms
        since_ms = time_ms - self.began_ms
        if event.name == "READING":
            if self.readings is not None:
                self.readings(event)
        elif event.name == "SHOW":
            self._print_value(since_ms, event)
        elif event.name == "DONE":
            self.print_values(since_ms, "DONE", "", text("robot_done", self.language))
        elif event.name == "FAULT":
            self._print_fault(since_ms, event.fault, event.offset, event.program)
        elif event.name == "STOPPED":
            cause = cause_name(event.cause)
            sentence = text(f"stopped_{cause}", self.language)
            self.print_values(since_ms, "STOPPED", cause, sentence, cause=cause)
        elif event.name == "RESTARTED":
            self.print_values(since_ms, "RESTARTED", "", text("robot_restarted", self.language))
        elif event.name == "MISSED":
            sentence = text("missed", self.language).format(n=event.count)
            self.print_values(since_ms, "MISSED", str(event.count), sentence, count=event.count)
        elif event.name == "TEXT":
            robot_text = printable_name(event.text.decode("utf-8", "replace"))
            sentence = text("robot_text", self.language).format(said=robot_text)
            self.print_values(
                since_ms, "TEXT", escape_formula(robot_text), sentence, text=robot_text
            )

    def name_of(self, event: ShownEvent) -> str:
        """Return the name of a value, which distinguishes it from those of all other SHOWs."""
        show = self.shows.show_of(event)
        if show is None:
            return ""
        line_text = f"{show.line}:{show.column}" if show.shares_line else str(show.line)
        return self._name_with_line(show, line_text)

    def _name_with_line(self, show: Show, line_text: str) -> str:
        if not (show.shares_text and self.has_lines):
            return show.text
        return text("shown_line", self.language).format(what=show.text, line=line_text)

    def _print_value(self, since_ms: int, event: ShownEvent) -> None:
        value = event.value, bool(event.is_yes_no)
        shown_value, show = value_text(*value), self.shows.show_of(event)
        if show is None:
            self.print_values(since_ms, "SHOW", shown_value, value=value_of(*value))
            return
        text = f"{self._name_with_line(show, str(show.line))} {shown_value}"
        self.print_values(since_ms, "SHOW", shown_value, text, self.name_of(event),
                          value=value_of(*value), name=show.text, line=show.line,
                          column=show.column)  # fmt: skip

    def _print_fault(self, since_ms: int, fault_number: int, offset: int, checksum: int) -> None:
        fault = fault_name(fault_number)
        sentence = fault_sentence(fault_number, offset, checksum, self.program_map, self.language)
        program_map = self.program_map or source_map.recall(checksum)
        location = program_map.location_at(offset) if program_map is not None else None
        line_fields = {} if location is None else {"line": location.line}
        self.print_values(since_ms, "FAULT", fault, sentence, is_bad=True, fault=fault, at=offset,
                 program=f"{checksum:08x}", **line_fields)  # fmt: skip

    def print_values(
        self, since_ms: int, name: str, shown_value: str, sentence: str = "", cell: str = "", /,
        is_bad: bool = False, **fields: object,
    ) -> None:  # fmt: skip
        """Print an event: `sentence`, or its name and its values. JSON gets the fields, a row the
        `cell` that says which SHOW it was."""
        if self.add_row is not None:
            self.add_row(since_ms, name, shown_value, escape_formula(cell))
        if self.is_json:
            times = {"ms": since_ms} if self.has_times else {}
            self.print_line(json.dumps({**times, "event": name, **self.robot_fields, **fields}))
        elif is_bad or name in ("MISSED", "TEXT"):
            self.print_error(sentence)
        else:
            time_text = f"{since_ms} " if self.has_times else ""
            self.print_line(time_text + (sentence or f"{name} {shown_value}"))


def printer_of(
    connection: Connection,
    is_json: bool = False,
    program_map: SourceMap | None = None,
    checksum: int | None = None,
    whole_map: SourceMap | None = None,
) -> EventPrinter:
    """Return the printer of a connection's events, above the picture of its virtual robot."""
    simulator = connection.simulator
    print_line, print_error = (
        (None, None) if simulator is None else (simulator.print_line, simulator.print_error)
    )
    return EventPrinter(
        connection.language,
        is_json,
        program_map=program_map,
        print_line=print_line,
        print_error=print_error,
        checksum=checksum,
        whole_map=whole_map,
    )
