"""A program that a button starts, on the virtual robot of one command.

On a terminal the button is a key. Without a terminal the button is pushed at once.
"""

from __future__ import annotations

import sys

from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import shown
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.event_printer import EventPrinter, cause_name
from tiniscript.cli.robot.run_monitor import DONE, RunMonitor, Saving, ended
from tiniscript.cli.terminal.keys import Keys, is_in_front
from tiniscript.cli.texts.common import text
from tiniscript.link.outcomes import Event

PUSH = "bB "  # the keys that `tsc robot` has, too
QUIT = "qQ\x04"


def has_keys(connection: Connection) -> bool:
    """Whether the robot is drawn on a terminal with keys."""
    simulator = connection.simulator
    return simulator is not None and simulator.is_drawn and sys.stdin.isatty() and is_in_front()


def follow_button(connection: Connection, printer: EventPrinter, saving: Saving) -> int:
    """Stay until a program has ended by itself; return the exit code.

    The button also stops the program and starts it again. Raises CommandError if the link ends.
    """
    simulator = connection.simulator
    assert simulator is not None
    is_person = has_keys(connection)
    simulator.watch(text("button_keys", connection.language) if is_person else "")
    if not is_person:
        simulator.push()
    with Keys() as keys:
        while True:
            for key in keys.pressed() if is_person else "":
                if key in QUIT:
                    return DONE
                if key in PUSH:
                    simulator.push()
            found = connection.event()
            saving.look()
            if connection.is_time_over:
                return RunMonitor(connection, printer).stop_in_time()
            if found is None:
                continue
            _mind(connection, found[1], saving.program)
            if found[1].name != "STARTED":
                printer.tell(*found)
            code = ended(found[1], None)
            if code is not None and not (is_person and _is_push(found[1])):
                return code


def _mind(connection: Connection, event: Event, program: int) -> None:
    """Raise CommandError if the robot is lost or has another program."""
    if event.name == "LOST":
        raise CommandError(3, "link_lost", port=shown(connection.port))
    if event.name == "STARTED" and event.program != program:
        raise CommandError(3, "replaced", port=shown(connection.port))


def _is_push(event: Event) -> bool:
    """Whether the button has stopped the program."""
    return event.name == "STOPPED" and cause_name(event.cause) == "BUTTON"
