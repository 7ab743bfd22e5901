"""`tsc monitor`: prints what the robot shows, without changing its run."""

from __future__ import annotations

import sys
from argparse import Namespace
from time import monotonic

from tiniscript.cli import streams
from tiniscript.cli.options import whole_number
from tiniscript.cli.paths import ROWS_HEADER
from tiniscript.cli.robot.connect import Connection, connect
from tiniscript.cli.robot.event_printer import EventPrinter
from tiniscript.cli.robot.recorder import Rows
from tiniscript.cli.terminal.plot import PlotScreen
from tiniscript.cli.texts import text


def run(options: Namespace, language: str) -> int:
    seconds = whole_number("--max-time", options.max_time, 0, 1, 10**6, language)

    rows: Rows | None = None
    try:
        with connect(options, language) as connection:
            connection.meet()
            if options.csv is not None:  # if there is no robot, the old file stays
                rows = Rows(options.csv, ROWS_HEADER)
            add_row = rows.add_row if rows is not None else None
            print(connection.text("watching"), file=sys.stderr)
            if options.plot and sys.stderr.isatty():
                with PlotScreen(text("plot_waiting", language)) as plot_screen:
                    printer = EventPrinter(
                        language,
                        options.json,
                        has_times=True,
                        add_row=add_row,
                        print_line=plot_screen.print_line,
                        print_error=plot_screen.print_error,
                    )
                    _watch(connection, printer, seconds, plot_screen)
            else:
                printer = EventPrinter(language, options.json, has_times=True, add_row=add_row)
                _watch(connection, printer, seconds)
    except KeyboardInterrupt:  # the usual way to end it
        streams.drop_unread_output()
        print(file=sys.stderr)
    finally:
        if rows is not None:
            rows.close()
    return 0


def _watch(
    connection: Connection,
    printer: EventPrinter,
    seconds: int,
    plot_screen: PlotScreen | None = None,
) -> None:
    for timed_event in connection.watch(monotonic() + seconds if seconds else None):
        if plot_screen is not None:
            plot_screen.draw_plot(int(monotonic() * 1000))
        if timed_event is not None:
            if plot_screen is not None:
                plot_screen.add_event(*timed_event, printer.name_of)
            printer.print_event(*timed_event)
