"""The tables of `docs/en/figures.md`: a benchmark fills in those of its section, and no others.

The page is the template: a benchmark prints its headings and rows, with the results. A row that the
page does not show is refused; one that was measured once is left out.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

from tools import ROOT

PAGE = ROOT / "docs" / "en" / "figures.md"
# A paragraph about the measurement of the figures below it, or a heading.
_SECTION_START = re.compile(r"^(?:`python -m ([\w.]+)[^`]*` measures |#)")


class Table(NamedTuple):
    """A table of the page, as written: its head, its rule, and its rows."""

    head: str
    rule: str
    rows: tuple[str, ...]

    def row_of(self, keys: Sequence[str]) -> int:
        """Return the place of the row with these first cells. Raises LookupError without one."""
        for index, row in enumerate(self.rows):
            if cells(row)[: len(keys)] == [*keys]:
                return index
        raise LookupError(f"{PAGE.name} has no row {' | '.join(keys)}")


def cells(row: str) -> list[str]:
    """Return the cells of a row, in which a bar of the text is `|` again."""
    return [part.strip().replace("\\|", "|") for part in re.split(r"(?<!\\)\|", row)[1:-1]]


def format_row(row: Sequence[str]) -> str:
    return "".join(f"| {cell.replace('|', chr(92) + '|')} " for cell in row) + "|"


def tables(name: str) -> list[Table]:
    """Return the tables in the section of a benchmark, `link`."""
    table_lines: list[list[str]] = []
    is_inside = is_table = False
    for line in PAGE.read_text(encoding="utf-8").splitlines():
        if match := _SECTION_START.match(line):
            is_inside = match[1] == f"tools.bench.{name}"
        if line.startswith("|") and is_inside:
            if not is_table:
                table_lines.append([])
            table_lines[-1].append(line)
        is_table = line.startswith("|")
    return [Table(head, rule, tuple(rows)) for head, rule, *rows in table_lines]


def show(
    name: str, rows: Sequence[Sequence[str]], position: int = 0, key_cell_count: int = 1
) -> None:
    """Print a table of the page with these rows, each known by its first `key_cell_count` cells.

    Raises LookupError for a row that the page lacks, ValueError for one with more cells or fewer.
    """
    table = tables(name)[position]
    sorted_rows = sorted((table.row_of(row[:key_cell_count]), format_row(row)) for row in rows)
    for index, row in sorted_rows:
        if len(cells(row)) != len(cells(table.rows[index])):
            raise ValueError(f"{PAGE.name} has other columns than {row}")
    print(table.head, table.rule, *(row for _, row in sorted_rows), "", sep="\n", flush=True)
