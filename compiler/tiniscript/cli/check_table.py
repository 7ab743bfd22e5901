"""`tsc check` for several programs: a line for each, and a table at the end.

Knows rows and how they are printed. A program that cannot be read has a row, too.
"""

from __future__ import annotations

import json
from argparse import Namespace
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from tiniscript.cli import compilations, inputs, outputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.program_files import ProgramFile, programs
from tiniscript.cli.repairing import print_difference, repair
from tiniscript.cli.spreadsheet import as_csv
from tiniscript.cli.texts import text
from tiniscript.diagnostics.rendering import Message, as_json, message
from tiniscript.library.compiling import Compilation
from tiniscript.library.named_robot import robot_of
from tiniscript.robots.profile import Robot

NAME_COLUMNS = 40  # columns for a file's name; a longer one is cut at the start


class Row(NamedTuple):
    """A program: its messages, mistakes first, or why it cannot be read."""

    name: str
    messages: list[Message]
    repair_count: int
    problem: str

    @property
    def mistake_count(self) -> int:
        return sum(message.severity == "mistake" for message in self.messages)

    @property
    def warning_count(self) -> int:
        return len(self.messages) - self.mistake_count


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
    return 1 if any(row.mistake_count for row in rows) else 0


def _row(file: ProgramFile, options: Namespace, robot: Robot, language: str) -> Row:
    if file.problem is not None:
        return Row(file.name, [], 0, file.problem.plain_sentence(language))
    repair_count = 0
    program_input = inputs.Input(file.name, file.data, Path(file.name), options.robot is not None)
    if program_input.has_robot:
        inputs.warn_of_other_robot(program_input, robot, language)
    else:
        robot = robot_of(program_input.data, robot)
    if options.fix or options.diff:
        compilation, repair_count, problem = _repair(program_input, options, robot, language)
        if problem:
            return Row(file.name, [], 0, problem)
    else:
        compilation = compilations.compile_input(program_input, robot, is_strict=False)
    compilation = compilations.for_level(compilation, robot, options.text_level)
    messages = [
        message(diagnostic, compilation.source, language) for diagnostic in compilation.diagnostics
    ]
    messages.sort(key=lambda message: message.severity != "mistake")
    return Row(file.name, messages, repair_count, "")


def _repair(
    program_input: inputs.Input, options: Namespace, robot: Robot, language: str
) -> tuple[Compilation, int, str]:
    """Make or show the certain repairs of a program; return the remaining mistakes, the number of
    repairs, and a problem.
    """
    repaired_program = repair(program_input, robot)
    if repaired_program.repair_count and not options.json:
        print_difference(program_input.data, repaired_program.data, program_input.name)
    if options.diff:
        return (
            compilations.compile_input(program_input, robot, is_strict=False),
            repaired_program.repair_count,
            "",
        )
    if repaired_program.repair_count:
        try:
            outputs.write(Path(program_input.name), repaired_program.data, "unwritable_source")
        except CommandError as error:
            return repaired_program.compilation, 0, error.plain_sentence(language)
    return repaired_program.compilation, repaired_program.repair_count, ""


def _line(row: Row, language: str) -> str:
    name = inputs.printable_name(row.name)
    if row.problem:
        return text("checked_unread", language).format(file=name, why=row.problem)
    if not row.mistake_count:
        return text("checked_right", language).format(file=name)
    first_message = row.messages[0]
    return text("checked_wrong", language).format(
        file=name, line=first_message.line, said=first_message.message, code=first_message.code
    )


def _table(rows: Sequence[Row], language: str) -> list[str]:
    has_repairs = any(row.repair_count for row in rows)
    column_keys = ["program_column", "mistakes_column", "warnings_column", "first_column"]
    heads = [text(key, language) for key in column_keys]
    cells = []
    for row in rows:
        name = inputs.printable_name(row.name)
        name = name if len(name) <= NAME_COLUMNS else "…" + name[1 - NAME_COLUMNS :]
        first_mistake = next(
            (row_cells for row_cells in row.messages if row_cells.severity == "mistake"), None
        )
        position = "" if first_mistake is None else f"{first_mistake.line}: {first_mistake.code}"
        cells.append([name, str(row.mistake_count), str(row.warning_count), position])
        if row.problem:
            cells[-1] = [name, "-", "-", text("unread", language)]
        if has_repairs:
            cells[-1].insert(3, str(row.repair_count))
    if has_repairs:
        heads.insert(3, text("repaired_column", language))
    widths = [max(len(row_cells[k]) for row_cells in (heads, *cells)) for k in range(len(heads))]
    lines = [_format_row(row_cells, widths) for row_cells in (heads, *cells)]
    right_count = sum(not row.mistake_count and not row.problem for row in rows)
    return [*lines, text("all_row", language).format(n=len(rows), right=right_count)]


def _format_row(cells: Sequence[str], widths: Sequence[int]) -> str:
    """Return a row: the first and the last column begin on the left, numbers end on the right."""
    last_column = len(cells) - 1
    row = [
        f"{cell:{width}}" if k in (0, last_column) else f"{cell:>{width}}"
        for k, (cell, width) in enumerate(zip(cells, widths, strict=True))
    ]
    return "   ".join(row).rstrip()


def _as_data(row: Row) -> dict[str, object]:
    return {
        "file": inputs.printable_name(row.name),
        "mistakes": row.mistake_count,
        "warnings": row.warning_count,
        "repaired": row.repair_count,
        "problem": row.problem,
        "messages": as_json(row.messages),
    }


def _as_csv(rows: Sequence[Row], language: str) -> bytes:
    def cells(row: Row) -> tuple[object, ...]:
        counts = (
            inputs.printable_name(row.name),
            row.mistake_count,
            row.warning_count,
            row.repair_count,
        )
        if not row.mistake_count:
            return (*counts, "", "", row.problem)
        first_message = row.messages[0]
        return (*counts, first_message.line, first_message.code, first_message.message)

    return as_csv("check", language, map(cells, rows))
