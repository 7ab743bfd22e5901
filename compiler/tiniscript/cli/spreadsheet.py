"""Rows for a spreadsheet: CSV that Excel and LibreOffice open with its accents.

In Spanish its cells end with a semicolon, as Excel in Spanish takes them, and its heads are
Spanish. A cell may come from a pupil: none begins a formula, and none has control characters.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Sequence
from io import StringIO

from tiniscript.printable import printable

LONGEST = 2000  # characters of a cell
SEPARATORS = {"en": ",", "es": ";"}
HEADS: dict[str, dict[str, tuple[str, ...]]] = {
    "check": {
        "en": ("file", "mistakes", "warnings", "repaired", "line", "code", "message"),
        "es": ("archivo", "errores", "avisos", "corregidos", "línea", "código", "mensaje"),
    },
    "lesson": {
        "en": ("file", "verdict", "seed", "sentence"),
        "es": ("archivo", "resultado", "mundo", "frase"),
    },
}
# Behind a comma a number may have a sign: M(50, -50).
_SIGN = re.compile(
    r"(^|[;|\"])(\s*)(?=[=+\-@＝＋－＠])|(,)(\s*)(?=[=@＝＠]|[+\-＋－](?![\d.]+\s*[,);]))"
)


def as_csv(table: str, language: str, rows: Iterable[Sequence[object]]) -> bytes:
    """Return a table of HEADS as a file."""
    written = StringIO()
    writer = csv.writer(written, delimiter=SEPARATORS[language], lineterminator="\n")
    writer.writerow(HEADS[table][language])
    writer.writerows([_cell(each) for each in row] for row in rows)
    return written.getvalue().encode("utf-8-sig", "backslashreplace")


def beginnings() -> tuple[bytes, ...]:
    """Return how a file of `as_csv` begins, for each table and language."""
    empty = (as_csv(table, each, ()) for table, heads in HEADS.items() for each in heads)
    return tuple(each.rstrip(b"\n") for each in empty)


def no_formula(text: str) -> str:
    """Return a text that a spreadsheet takes for text, whether its cells end with , or with ;."""
    return _SIGN.sub(r"\1\2\3\4'", text)


def _cell(value: object) -> object:
    return no_formula(printable(value, LONGEST)) if isinstance(value, str) else value
