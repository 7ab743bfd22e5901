"""`tsc firmware --wiring`: a page that shows how a robot is wired."""

from __future__ import annotations

import sys
from argparse import Namespace
from shutil import get_terminal_size
from textwrap import wrap

from rich.cells import cell_len, set_cell_size

from tiniscript.cli import inputs, outputs
from tiniscript.cli.texts import say
from tiniscript.robots.wiring.html import html_of
from tiniscript.robots.wiring.page import rail_rows, wire_rows
from tiniscript.robots.wiring.plan import plan_of

COLUMN_GAP = "  "  # between columns
MIN_COLUMN_WIDTH = 16  # a column on a terminal that is too narrow for the table


def run(options: Namespace, language: str) -> int:
    robot = inputs.wired_robot(options, language)
    plan = plan_of(robot, language)
    if options.output is None:
        _print_rows(wire_rows(plan))
        print()
        _print_rows(_merge_by_tag(rail_rows(plan)))
        print()
        say("wiring_page", language)
        return 0
    if outputs.write_output(options.output, html_of(plan).encode()):
        say(
            "wiring",
            language,
            file=inputs.printable_name(options.output),
            robot=inputs.printable_name(plan.robot),
        )
    return 0


def _merge_by_tag(rows: list[tuple[str, ...]]) -> list[tuple[str, ...]]:
    """Return the rows of power and GND with one row for a tag."""
    ends_by_tag: dict[tuple[str, ...], list[str]] = {}
    for *tag, end in rows:
        ends_by_tag.setdefault(tuple(tag), []).append(end)
    return [(*tag, ", ".join(ends)) for tag, ends in ends_by_tag.items()]


def _print_rows(rows: list[tuple[str, ...]]) -> None:
    """Print a table; on a terminal its last column is broken where the lines end."""
    printable_rows = [[inputs.printable_name(cell) for cell in row] for row in rows]
    widths = [
        max(cell_len(row[k]) for row in printable_rows) for k in range(len(printable_rows[0]))
    ]
    indent = sum(widths[:-1]) + len(COLUMN_GAP) * (len(widths) - 1)
    room = widths[-1]
    if sys.stdout.isatty():
        room = min(room, max(MIN_COLUMN_WIDTH, get_terminal_size().columns - indent - 1))
    for *row, last_cell in printable_rows:
        cells = COLUMN_GAP.join(
            set_cell_size(cell, width) for cell, width in zip(row, widths, strict=False)
        )
        first_line, *other_lines = wrap(last_cell, room) or [""]
        print(f"{cells}{COLUMN_GAP}{first_line}".rstrip())
        for line in other_lines:
            print(" " * indent + line)
