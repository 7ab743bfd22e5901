"""Stops one robot of a fleet, and asks for the other information that a stop may need."""

from __future__ import annotations

from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.member import Member, Result
from tiniscript.cli.texts import text


def stop_one(connection: Connection, member: Member) -> Result:
    """Stop one of many robots. Raises CommandError if it does not confirm."""
    member.set_state("crew_stopping")
    if connection.stop():
        if connection.options.teacher:
            hold_back(connection)
            return Result(True, text("held_back_short", connection.language))
        return Result(True, text("robot_stopped", connection.language))
    if may_be_opened(connection):
        from tiniscript.cli.robot.fleet import Reconnect

        raise Reconnect
    raise CommandError(3, "not_confirmed", port=printable_name(connection.port))


def hold_back(connection: Connection) -> None:
    """Make a stopped robot wait for the teacher, or for its button. Raises CommandError."""
    connection.meet()
    connection.request_or_raise(
        lambda session: session.hold_back(), "no_teachers_key", "NOT_OWNER", "WRONG_KEY"
    )


def may_be_opened(connection: Connection) -> bool:
    """Return whether the port's server ended during the stop, so that the port can be opened
    now.
    """
    return bool(connection.connection.holder_verb) and connection.connection.has_ended
