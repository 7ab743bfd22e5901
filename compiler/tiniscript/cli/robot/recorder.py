"""Writes a robot's reports on a run into a file: `tsc upload --record`, and rows of CSV.

The file of a run has the form of `studio/recordings.py`, which reads it. Each line is flushed
before the next one comes.
"""

from __future__ import annotations

import csv
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from threading import Lock
from time import monotonic

from tiniscript.base import files
from tiniscript.base.kit import Kit
from tiniscript.cli.errors import CommandError, unwritable_error
from tiniscript.cli.inputs import printable_name
from tiniscript.link.payloads import ReadingEvent
from tiniscript.studio import recordings
from tiniscript.studio.recordings import END, MAX_MS, Row


class Rows:
    """A file that begins with `header_row`; until that is there, the old file stays.

    Threads may add rows at once. All raise CommandError where the file cannot be written, with
    the sentence `failure_key`.
    """

    def __init__(
        self, name: str, header_row: bytes, failure_key: str = "unwritable_more --csv"
    ) -> None:
        self._name = name
        self._failure_key = failure_key
        self._lock = Lock()
        try:
            path = Path(name)
            if path.is_file() or not path.exists():
                files.replace(path, header_row)
                self._file = path.open("a", encoding="utf-8", newline="\n")
                return
            self._file = path.open("w", encoding="utf-8", newline="\n")  # a device or a pipe
            self._file.write(header_row.decode())
            self._file.flush()
        except (OSError, ValueError) as error:
            raise self._failure(error) from None

    def add_row(self, *cells: object) -> None:
        try:
            with self._lock:
                csv.writer(self._file, lineterminator="\n").writerow(cells)
                self._file.flush()
        except (OSError, ValueError) as error:
            raise self._failure(error) from None

    def add_line(self, row: str) -> None:
        try:
            with self._lock:
                self._file.write(row + "\n")
                self._file.flush()
        except (OSError, ValueError) as error:
            raise self._failure(error) from None

    def close(self) -> None:
        with suppress(OSError):  # a write failure was printed already
            self._file.close()

    def _failure(self, error: Exception) -> CommandError:
        return unwritable_error(self._failure_key, printable_name(self._name), error)


ENDING_EVENTS = ("DONE", "FAULT", "STOPPED", "MISSED")


class Recorder:
    """The file of a run that began at `began_s` (monotonic); None: at its first event.

    `head` is the first line. A virtual robot has a clock of its own: `robot_ms` says when it did an
    event, since the run began. The old file stays until there is an event. Raises CommandError if
    it cannot be written.
    """

    def __init__(
        self,
        name: str,
        head: str,
        began_s: float | None,
        robot_ms: Callable[[str], int] | None = None,
        kit: Kit | None = None,
    ) -> None:
        self._began_s = began_s
        self._robot_ms = robot_ms
        self._kept_rows = recordings.Rows()
        self._readings = recordings.ReadingRows(kit or Kit((), ()))
        self._is_over = False
        self._rows = Rows(name, head.encode(), "unwritable_more --record")

    def add_event(self, _: int, name: str, text: str, __: str = "") -> None:
        """Add an event as `EventPrinter` prints it, with its time of arrival."""
        if self._is_over or name not in ("SHOW", *ENDING_EVENTS):
            return
        event = f"{name} {text}" if name in ("SHOW", "FAULT") else name
        if self._began_s is None:
            self._began_s = monotonic()
        row = Row(self._event_ms(event), event)
        is_row_kept = self._kept_rows.add(row)
        if is_row_kept:
            self._rows.add_line(recordings.encode_row(row))
        if not is_row_kept or name in ENDING_EVENTS:
            self._add_end_row(row.ms)

    def add_reading(self, event: ReadingEvent) -> None:
        """Add a reading of the program, at the time that the robot reports."""
        if self._is_over:
            return
        since_s = 0.0 if self._began_s is None else monotonic() - self._began_s
        for row in self._readings.rows(event, round(since_s * 1000)):
            if self._kept_rows.add(row):
                self._rows.add_line(recordings.encode_row(row))
            elif self._kept_rows.is_full:
                return self._add_end_row(row.ms)

    @property
    def unreadable_sensors(self) -> list[str]:
        """The sensors whose readings the robot could not send completely."""
        return self._readings.incomplete_names

    def end_recording(self, event: str) -> None:
        """The recording is over now, if it was not: `event` is the last one."""
        if not self._is_over:
            row = Row(self._event_ms(event), event)
            if self._kept_rows.add(row):
                self._rows.add_line(recordings.encode_row(row))
            self._add_end_row(row.ms)

    def close(self) -> None:
        """Close the file; a run without a reported end was stopped by this computer."""
        try:
            self.end_recording("STOPPED")
        finally:
            self._rows.close()

    def _event_ms(self, event: str) -> int:
        if self._robot_ms is not None:
            return self._robot_ms(event)
        return 0 if self._began_s is None else round((monotonic() - self._began_s) * 1000)

    def _add_end_row(self, ms: int) -> None:
        self._is_over = True
        self._rows.add_line(recordings.encode_row(Row(min(ms, MAX_MS), END)))
