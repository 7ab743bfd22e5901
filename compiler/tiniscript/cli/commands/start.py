"""`tsc start`: starts the program that the robot holds."""

from __future__ import annotations

from argparse import Namespace

from tiniscript.cli.robot.connect import Connection, connect
from tiniscript.cli.robot.event_printer import EventPrinter
from tiniscript.cli.robot.run_monitor import RunMonitor, stop_and_say


def run(options: Namespace, language: str) -> int:
    with connect(options, language) as connection:
        connection.meet()
        try:
            return _start(connection, options.detach, options.json)
        except KeyboardInterrupt:
            return stop_and_say(connection)


def _start(connection: Connection, is_detached: bool, is_json: bool) -> int:
    reply = connection.request(lambda session: session.start(is_detached))
    checksum, run = reply.values.program, reply.values.run
    key = "started_detached" if is_detached else "started"
    sentence = connection.text(key, checksum=f"{checksum:08x}")
    printer = EventPrinter(connection.language, is_json)
    printer.print_values(0, "STARTED", "", sentence, program=f"{checksum:08x}")
    return 0 if is_detached else RunMonitor(connection, printer).follow(run)
