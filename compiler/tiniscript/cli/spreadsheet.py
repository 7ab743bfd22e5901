"""Rows for a spreadsheet: CSV that Excel and LibreOffice open with its accents.

Its headings are in the reader's language, and its separator is the one that Excel expects there: in
Spanish a semicolon. A cell may come from a pupil: no cell begins a formula or contains control
characters.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Sequence
from io import StringIO

from tiniscript.base.languages import languages
from tiniscript.base.source import printable
from tiniscript.cli.texts import text

MAX_CELL_CHARACTERS = 2000  # characters of a cell
TABLES = ("check", "lesson")
# Characters that begin a formula: at the beginning of a cell; in a name also wherever a cell may
# begin, because the person who opens the file chooses the separators. Ours are a comma or a
# semicolon.
_FORMULA_SIGN = "(?=[=+\\-@＝＋－＠])"
_FORMULA_START = re.compile(rf"(^)(\s*){_FORMULA_SIGN}")
_AFTER_END = re.compile(rf"(^|[;|\"])(\s*){_FORMULA_SIGN}")
_AFTER_ANY = re.compile(rf"(^|[,;|\"])(\s*){_FORMULA_SIGN}")


def as_csv(table_name: str, language: str, rows: Iterable[Sequence[object]]) -> bytes:
    """Return a table of TABLES as a file. The first cell of a row is the name of a file."""
    output = StringIO()
    writer = csv.writer(output, delimiter=text("rows_separator", language), lineterminator="\n")
    writer.writerow(text(f"rows_{table_name}", language).split())
    writer.writerows([_name(row[0]), *map(_cell, row[1:])] for row in rows)
    return output.getvalue().encode("utf-8-sig", "backslashreplace")


def file_starts() -> tuple[bytes, ...]:
    """Return the first line of an `as_csv` file for each table and language.

    A spreadsheet that has kept such a file may have given it other line ends.
    """
    empty_tables = [as_csv(table, language, ()) for table in TABLES for language in languages()]
    return (*empty_tables, *(table_file.replace(b"\n", b"\r\n") for table_file in empty_tables))


def escape_formula(text: str) -> str:
    """Return a user's text such that spreadsheets do not run it as a formula, in cells after
    commas.

    It may take ; for their end, which no quotation marks keep in a cell then.
    """
    return _AFTER_END.sub(r"\1\2'", text)


def _name(value: object) -> str:
    return _AFTER_ANY.sub(r"\1\2'", printable(str(value), MAX_CELL_CHARACTERS))


def _cell(value: object) -> object:
    """Return a number, or a sentence that only its first character could make a formula."""
    return (
        _FORMULA_START.sub(r"\1\2'", printable(value, MAX_CELL_CHARACTERS))
        if isinstance(value, str)
        else value
    )
