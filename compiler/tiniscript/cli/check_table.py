"""`tsc check` for several programs: a line for each, and a table at the end.

Knows rows and how they are printed. A program that cannot be read has a row, too.
"""

from __future__ import annotations

import json
from argparse import Namespace
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from tiniscript.cli import compiling, inputs, outputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.program_files import ProgramFile, programs
from tiniscript.cli.repairing import print_difference, repair
from tiniscript.cli.spreadsheet import as_csv
from tiniscript.cli.texts import text
from tiniscript.diagnostics.rendering import Message, as_json, message
from tiniscript.library.compiling import Compiled
from tiniscript.library.named_robot import robot_of
from tiniscript.robots.profile import Robot

NAME_COLUMNS = 40  # of a file's name in the table; of a longer one the end is shown


class Row(NamedTuple):
    """A program: its messages, mistakes first, or why it cannot be read."""

    name: str
    messages: list[Message]
    repair_count: int
    problem: str

    @property
    def mistakes(self) -> int:
        return sum(message.severity == "mistake" for message in self.messages)

    @property
    def warnings(self) -> int:
        return len(self.messages) - self.mistakes


def check(options: Namespace, robot: Robot, language: str) -> int:
    """Check all programs that are named; return the exit code."""
    rows = []
    for program in programs(options.programs):
        rows.append(_row(program, options, robot, language))
        if not options.json:
            print(_line(rows[-1], language), flush=True)
    if options.json:
        print(json.dumps([_as_data(row) for row in rows], indent=2))
    else:
        print("\n" + "\n".join(_table(rows, language)))
    if options.csv is not None:
        outputs.write(Path(options.csv), _as_csv(rows, language), "unwritable_more --csv")
    if any(row.problem for row in rows):
        return 2
    return 1 if any(row.mistakes for row in rows) else 0


def _row(file: ProgramFile, options: Namespace, robot: Robot, language: str) -> Row:
    if file.problem is not None:
        return Row(file.name, [], 0, file.problem.plain(language))
    repair_count = 0
    program_input = inputs.Input(file.name, file.data, Path(file.name), options.robot is not None)
    if program_input.has_robot:
        inputs.tell_other(program_input, robot, language)
    else:
        robot = robot_of(program_input.data, robot)
    if options.fix or options.diff:
        compilation, repair_count, problem = _repair(program_input, options, robot, language)
        if problem:
            return Row(file.name, [], 0, problem)
    else:
        compilation = compiling.compile_input(program_input, robot, is_strict=False)
    compilation = compiling.for_level(compilation, robot, options.text_level)
    messages = [
        message(diagnostic, compilation.source, language) for diagnostic in compilation.diagnostics
    ]
    messages.sort(key=lambda each: each.severity != "mistake")
    return Row(file.name, messages, repair_count, "")


def _repair(
    program_input: inputs.Input, options: Namespace, robot: Robot, language: str
) -> tuple[Compiled, int, str]:
    """Make or show the sure repairs of a program; return what is left, how many, and a problem."""
    result = repair(program_input, robot)
    if result.repair_count and not options.json:
        print_difference(program_input.data, result.data, program_input.name)
    if options.diff:
        return (
            compiling.compile_input(program_input, robot, is_strict=False),
            result.repair_count,
            "",
        )
    if result.repair_count:
        try:
            outputs.write(Path(program_input.name), result.data, "unwritable_source")
        except CommandError as problem:
            return result.compilation, 0, problem.plain(language)
    return result.compilation, result.repair_count, ""


def _line(row: Row, language: str) -> str:
    name = inputs.printable_name(row.name)
    if row.problem:
        return text("checked_unread", language).format(file=name, why=row.problem)
    if not row.mistakes:
        return text("checked_right", language).format(file=name)
    first = row.messages[0]
    return text("checked_wrong", language).format(
        file=name, line=first.line, said=first.message, code=first.code
    )


def _table(rows: Sequence[Row], language: str) -> list[str]:
    has_repairs = any(row.repair_count for row in rows)
    columns = ["program_column", "mistakes_column", "warnings_column", "first_column"]
    heads = [text(key, language) for key in columns]
    cells = []
    for row in rows:
        name = inputs.printable_name(row.name)
        name = name if len(name) <= NAME_COLUMNS else "…" + name[1 - NAME_COLUMNS :]
        first = next((each for each in row.messages if each.severity == "mistake"), None)
        place = "" if first is None else f"{first.line}: {first.code}"
        cells.append([name, str(row.mistakes), str(row.warnings), place])
        if row.problem:
            cells[-1] = [name, "-", "-", text("unread", language)]
        if has_repairs:
            cells[-1].insert(3, str(row.repair_count))
    if has_repairs:
        heads.insert(3, text("repaired_column", language))
    widths = [max(len(each[k]) for each in (heads, *cells)) for k in range(len(heads))]
    lines = [_formatted_row(each, widths) for each in (heads, *cells)]
    right = sum(not row.mistakes and not row.problem for row in rows)
    return [*lines, text("all_row", language).format(n=len(rows), right=right)]


def _formatted_row(cells: Sequence[str], widths: Sequence[int]) -> str:
    """Return a row: the first and the last column begin on the left, numbers end on the right."""
    last = len(cells) - 1
    row = [
        f"{cell:{width}}" if k in (0, last) else f"{cell:>{width}}"
        for k, (cell, width) in enumerate(zip(cells, widths, strict=True))
    ]
    return "   ".join(row).rstrip()


def _as_data(row: Row) -> dict[str, object]:
    return {
        "file": inputs.printable_name(row.name),
        "mistakes": row.mistakes,
        "warnings": row.warnings,
        "repaired": row.repair_count,
        "problem": row.problem,
        "messages": as_json(row.messages),
    }


def _as_csv(rows: Sequence[Row], language: str) -> bytes:
    def cells(row: Row) -> tuple[object, ...]:
        counts = (inputs.printable_name(row.name), row.mistakes, row.warnings, row.repair_count)
        if not row.mistakes:
            return (*counts, "", "", row.problem)
        first = row.messages[0]
        return (*counts, first.line, first.code, first.message)

    return as_csv("check", language, map(cells, rows))
