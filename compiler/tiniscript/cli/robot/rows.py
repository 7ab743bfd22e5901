"""Rows of events in a CSV file: what `tsc monitor` and `tsc class show` write with `--csv`.

And lines of a recording."""

from __future__ import annotations

import csv
from contextlib import suppress
from pathlib import Path
from threading import Lock

from tiniscript import files
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import shown


class Rows:
    """A file that begins with the row `first`; until that is there, the old file stays.

    Threads may add rows at once. All raise CommandError where the file cannot be written, with
    the sentence `failure`.
    """

    def __init__(self, name: str, first: bytes, failure: str = "unwritable_rows") -> None:
        self._name = name
        self._key = failure
        self._lock = Lock()
        try:
            path = Path(name)
            if path.is_file() or not path.exists():
                files.replace(path, first)
                self._file = path.open("a", encoding="utf-8", newline="\n")
                return
            self._file = path.open("w", encoding="utf-8", newline="\n")  # a device or a pipe
            self._file.write(first.decode())
            self._file.flush()
        except (OSError, ValueError) as why:
            raise self._failure(why) from None

    def add(self, *cells: object) -> None:
        try:
            with self._lock:
                csv.writer(self._file, lineterminator="\n").writerow(cells)
                self._file.flush()
        except (OSError, ValueError) as why:
            raise self._failure(why) from None

    def line(self, whole: str) -> None:
        try:
            with self._lock:
                self._file.write(whole + "\n")
                self._file.flush()
        except (OSError, ValueError) as why:
            raise self._failure(why) from None

    def close(self) -> None:
        with suppress(OSError):  # a write failure was told already
            self._file.close()

    def _failure(self, why: Exception) -> CommandError:
        reason = why.strerror if isinstance(why, OSError) and why.strerror else str(why)
        return CommandError(2, self._key, file=shown(self._name), why=reason)
