"""`tsc monitor`: prints what the robot shows, without changing its run."""

from __future__ import annotations

import sys
from argparse import Namespace
from contextlib import suppress
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, TextIO

from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import shown
from tiniscript.cli.options import whole_number
from tiniscript.cli.robot.connect import Connection, connected
from tiniscript.cli.texts.common import text

if TYPE_CHECKING:
    from tiniscript.cli.robot.event_printer import EventPrinter
    from tiniscript.cli.terminal.plot import Board


def run(options: Namespace, language: str) -> int:
    seconds = whole_number("--max-time", options.max_time, 0, 1, 10**6, language)
    rows: TextIO | None = None
    from tiniscript.cli.robot.event_printer import EventPrinter

    try:
        with connected(options, language) as connection:
            connection.meet()
            if options.csv is not None:  # without a robot the old file stays
                rows = _rows(options.csv)
            said = {"robot": connection.name, "port": shown(connection.port)}
            print(text("watching", language).format(**said), file=sys.stderr)
            if options.plot and sys.stderr.isatty():
                from tiniscript.cli.terminal.plot import Board

                with Board() as board:
                    printer = EventPrinter(language, options.json, has_times=True, rows=rows,
                                    out=board.say, err=board.warn)  # fmt: skip
                    _watch(connection, printer, seconds, board)
            else:
                printer = EventPrinter(language, options.json, has_times=True, rows=rows)
                _watch(connection, printer, seconds)
    except KeyboardInterrupt:  # the usual way to end it
        print(file=sys.stderr)
    finally:
        if rows is not None:
            _close(rows)
    return 0


def _watch(
    connection: Connection, printer: EventPrinter, seconds: int, board: Board | None = None
) -> None:
    from tiniscript.cli.robot.event_printer import Bookkeeping
    from tiniscript.link.outcomes import Gone

    bookkeeping = Bookkeeping()
    end_s = monotonic() + seconds if seconds else None
    try:
        while end_s is None or monotonic() < end_s:
            if board is not None:
                board.draw(int(monotonic() * 1000))
            found = connection.line.event()
            if found is None or bookkeeping.hides(found[1]):
                continue
            if board is not None:
                board.take(*found)
            if found[1].name == "LOST":
                raise CommandError(3, "link_lost", port=shown(connection.port))
            printer.tell(*found)
    except Gone as gone:
        raise connection.gone(gone) from None


def _rows(name: str) -> TextIO:
    """Return a file with its first row; until that is there, the old file stays."""
    from tiniscript import files
    from tiniscript.cli.made import ROWS

    try:
        path = Path(name)
        if path.is_file() or not path.exists():
            files.replace(path, ROWS)
            return path.open("a", encoding="utf-8", newline="\n")
        rows = path.open("w", encoding="utf-8", newline="\n")  # a device or a pipe
        rows.write(ROWS.decode())
        rows.flush()
    except (OSError, ValueError) as why:
        reason = why.strerror if isinstance(why, OSError) and why.strerror else str(why)
        raise CommandError(2, "unwritable_rows", file=shown(name), why=reason) from None
    return rows


def _close(rows: TextIO) -> None:
    with suppress(OSError):  # a write failure was printed already
        rows.close()
