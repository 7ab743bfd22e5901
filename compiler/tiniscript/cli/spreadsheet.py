"""Rows for a spreadsheet: CSV that Excel and LibreOffice open with its accents.

A cell may come from a pupil: none begins a formula, and none has control characters.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from io import StringIO

from tiniscript.printable import printable

LONGEST = 2000  # characters of a cell


def as_csv(head: Sequence[str], rows: Iterable[Sequence[object]]) -> bytes:
    written = StringIO()
    table = csv.writer(written, lineterminator="\n")
    table.writerow(head)
    table.writerows([_cell(each) for each in row] for row in rows)
    return written.getvalue().encode("utf-8-sig", "backslashreplace")


def _cell(value: object) -> object:
    if not isinstance(value, str):
        return value
    plain = printable(value, LONGEST)
    return f"'{plain}" if plain.startswith(("=", "+", "-", "@")) else plain
