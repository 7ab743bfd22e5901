"""`tsc monitor --hold`: holds a port, so that other commands share it, and prints its events."""

from __future__ import annotations

import sys
from argparse import Namespace

from tiniscript.cli import streams
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.robot.bookkeeping import Bookkeeping
from tiniscript.cli.robot.connect import Connection, connect
from tiniscript.cli.robot.event_printer import EventPrinter
from tiniscript.cli.texts import text
from tiniscript.link.connection import PendingRequest
from tiniscript.link.outcomes import Event
from tiniscript.link.payloads import HelloReply
from tiniscript.link.requests import OK


def run(options: Namespace, language: str) -> int:
    try:
        with connect(options, language) as connection:
            if connection.connection.holder_verb:
                values = {
                    "port": printable_name(connection.port),
                    "verb": connection.connection.holder_verb,
                }
                raise CommandError(3, "held_already", **values)
            if connection.server is None:
                raise CommandError(3, "cannot_share", port=printable_name(connection.port))
            connection.meet()
            _Log(connection, options.json).print_events()
    except KeyboardInterrupt:  # the usual way to end it
        streams.drop_unread_output()
        print(file=sys.stderr)
    return 0


class _Log:
    """Prints the events of a port, one line each."""

    def __init__(self, connection: Connection, is_json: bool) -> None:
        self.connection = connection
        self.language = connection.language
        self.printer = EventPrinter(connection.language, is_json)
        self.bookkeeping = Bookkeeping()
        # The search for a robot whose link was lost.
        self.search: PendingRequest[HelloReply] | None = None

    def print_events(self) -> None:
        """Print events until the port is lost."""
        self._print_text(
            "LINKED",
            "linked",
            robot=self.connection.name,
            port=printable_name(self.connection.port),
        )
        while True:
            timed_event = self.connection.event()
            if timed_event is not None:
                self._print_event(*timed_event)
            if self.search is not None and self.search.outcome is not None:
                self._look_again()

    def _print_event(self, time_ms: int, event: Event) -> None:
        if event.name == "JOINED" or event.name == "LEFT":
            self._print_text(event.name, event.name.lower(), verb=event.verb.decode())
        elif event.name == "STARTED":
            self._print_text(event.name, "link_started", program=f"{event.program:08x}")
        elif event.name == "LOST":
            self._print_text(
                event.name, "link_searching", port=printable_name(self.connection.port)
            )
            self.search = self.connection.search()
        elif not self.bookkeeping.filter_event(event):
            self.printer.print_event(time_ms, event)

    def _look_again(self) -> None:
        assert self.search is not None and self.search.outcome is not None
        if self.search.outcome.status == OK:
            self.search = None
            self._print_text("FOUND", "link_found", robot=self.connection.name)
        else:
            self.search = self.connection.search()

    def _print_text(self, name: str, key: str, **values: str) -> None:
        sentence = text(key, self.language).format(**values)
        fields: dict[str, object] = {**values}
        self.printer.print_values(0, name, "", sentence, is_bad=False, **fields)
