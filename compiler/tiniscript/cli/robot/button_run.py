"""A program that a button starts, on the virtual robot that is here for one command.

The person at the terminal has the button as a key. Where nobody is at a terminal, the button is
pushed at once.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from tiniscript.cli.errors import Trouble
from tiniscript.cli.inputs import shown
from tiniscript.cli.robot.run_monitor import DONE, Attendant, ended
from tiniscript.cli.terminal.keys import Keys, is_in_front
from tiniscript.cli.texts.common import text

if TYPE_CHECKING:
    from tiniscript.cli.robot.connect import Connection
    from tiniscript.cli.robot.event_printer import Teller
    from tiniscript.cli.robot.run_monitor import Saving
    from tiniscript.link.outcomes import Event

PUSH = "bB "  # the keys that `tsc robot` has, too
QUIT = "qQ\x04"


def has_keys(connection: Connection) -> bool:
    """Whether a person sees the robot and can press keys."""
    company = connection.company
    return company is not None and company.is_drawn and sys.stdin.isatty() and is_in_front()


def attend_button(connection: Connection, teller: Teller, saving: Saving) -> int:
    """Stay until a program has ended by itself; return the exit code.

    The button stops it, too; then it starts it again. Raises Trouble where the link ends.
    """
    company = connection.company
    assert company is not None
    is_person = has_keys(connection)
    company.watch(text("button_keys", connection.language) if is_person else "")
    if not is_person:
        company.push()
    with Keys() as keys:
        while True:
            for key in keys.pressed() if is_person else "":
                if key in QUIT:
                    return DONE
                if key in PUSH:
                    company.push()
            found = connection.event()
            saving.look()
            if connection.is_time_over:
                return Attendant(connection, teller).stop_in_time()
            if found is None:
                continue
            _mind(connection, found[1], saving.program)
            if found[1].name != "STARTED":
                teller.tell(*found)
            code = ended(found[1], None)
            if code is not None and not (is_person and _is_push(found[1])):
                return code


def _mind(connection: Connection, event: Event, program: int) -> None:
    """Raise Trouble where the robot is lost, or has another program now."""
    if event.name == "LOST":
        raise Trouble(3, "link_lost", port=shown(connection.port))
    if event.name == "STARTED" and event.values["program"] != program:
        raise Trouble(3, "replaced", port=shown(connection.port))


def _is_push(event: Event) -> bool:
    """Whether the button has stopped the program."""
    from tiniscript.cli.robot.event_printer import cause_name

    if event.name != "STOPPED":
        return False
    cause = event.values["cause"]
    assert isinstance(cause, int)
    return cause_name(cause) == "BUTTON"
