"""`tsc monitor`: prints what the robot shows, without changing its run."""

from __future__ import annotations

import sys
from argparse import Namespace
from time import monotonic

from tiniscript.cli.options import whole_number
from tiniscript.cli.paths import ROWS
from tiniscript.cli.robot.connect import Connection, connect
from tiniscript.cli.robot.event_printer import EventPrinter
from tiniscript.cli.robot.recorder import Rows
from tiniscript.cli.terminal.plot import Board
from tiniscript.cli.texts import text


def run(options: Namespace, language: str) -> int:
    seconds = whole_number("--max-time", options.max_time, 0, 1, 10**6, language)

    rows: Rows | None = None
    try:
        with connect(options, language) as connection:
            connection.meet()
            if options.csv is not None:  # without a robot the old file stays
                rows = Rows(options.csv, ROWS)
            add = rows.add if rows is not None else None
            print(connection.text("watching"), file=sys.stderr)
            if options.plot and sys.stderr.isatty():
                with Board(text("plot_waiting", language)) as board:
                    printer = EventPrinter(
                        language,
                        options.json,
                        has_times=True,
                        rows=add,
                        print_line=board.say,
                        print_error=board.warn,
                    )
                    _watch(connection, printer, seconds, board)
            else:
                printer = EventPrinter(language, options.json, has_times=True, rows=add)
                _watch(connection, printer, seconds)
    except KeyboardInterrupt:  # the usual way to end it
        print(file=sys.stderr)
    finally:
        if rows is not None:
            rows.close()
    return 0


def _watch(
    connection: Connection, printer: EventPrinter, seconds: int, board: Board | None = None
) -> None:
    for item in connection.watch(monotonic() + seconds if seconds else None):
        if board is not None:
            board.draw_plot(int(monotonic() * 1000))
        if item is not None:
            if board is not None:
                board.take(*item, printer.name_of)
            printer.tell(*item)
