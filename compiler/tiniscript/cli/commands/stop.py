"""`tsc stop`: stops the robot now, whatever else is wrong."""

from __future__ import annotations

import json
from argparse import Namespace

from tiniscript.cli import inputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import shown
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.member import Member, Result, are_many
from tiniscript.cli.texts import say, text


def run(options: Namespace, language: str) -> int:
    robot = inputs.robot(options, language)
    is_many = are_many(options)
    if not is_many and options.port is None:
        from tiniscript.cli.robot import in_reach

        options.ports = in_reach.to_stop(options.virtual)
        options.virtual = options.virtual and not options.ports
        is_many = are_many(options)
    if is_many:
        from tiniscript.cli.robot.fleet import together

        return together(options, robot, language, _one_of_many)
    while True:
        with Connection(options, robot, language) as connection:
            port = connection.port
            if connection.stop():
                if options.teacher:
                    _hold_back(connection)
                if options.json:
                    print(json.dumps({"port": port, "is_done": True}))
                else:
                    key = "held_back" if options.teacher else "stopped_on"
                    say(key, language, port=shown(port))
                return 0
            if not _may_be_opened(connection):
                raise CommandError(3, "not_confirmed", port=shown(port))
        options.port = port


def _hold_back(connection: Connection) -> None:
    """Have a robot that was stopped wait for the teacher, or its button. Raises CommandError."""
    connection.meet()
    connection.ask_or(
        lambda session: session.hold_back(), "no_teachers_key", "NOT_OWNER", "WRONG_KEY"
    )


def _may_be_opened(connection: Connection) -> bool:
    """Whether the port's server has ended during the stop, so that the port can be opened now."""
    return bool(connection.line.held_by) and connection.line.has_ended


def _one_of_many(connection: Connection, member: Member) -> Result:
    member.tell("crew_stopping")
    if connection.stop():
        if connection.options.teacher:
            _hold_back(connection)
            return Result(True, text("held_back_short", connection.language))
        return Result(True, text("robot_stopped", connection.language))
    if _may_be_opened(connection):
        from tiniscript.cli.robot.fleet import Again

        raise Again
    raise CommandError(3, "not_confirmed", port=shown(connection.port))
